"""Topologies and coordinates of GROMACS and Amber, by way of OpenMM's readers."""

import os
import warnings
from pathlib import Path
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from . import _core
from .errors import InputError
from .openmm_objects import bare, number
from .simulation import Simulation

PathLike = Union[str, Path]
_TOPOLOGIES = {".top": "GROMACS", ".prmtop": "Amber", ".parm7": "Amber"}
_COORDINATES = {"GROMACS": (".gro",), "Amber": (".inpcrd", ".rst7", ".restrt", ".ncrst")}


def _whole(system: Any, positions: Any, box: Any) -> Any:
    """Returns positions moved by the box's vectors so that molecules are whole: files are often wrapped atom by atom."""
    from openmm import HarmonicBondForce

    pairs = [system.getConstraintParameters(k)[:2] for k in range(system.getNumConstraints())]
    for force in system.getForces():
        if isinstance(force, HarmonicBondForce):
            pairs += [force.getBondParameters(k)[:2] for k in range(force.getNumBonds())]
    pairs += [(system.getVirtualSite(a).getParticle(0), a) for a in range(system.getNumParticles())
              if system.isVirtualSite(a)]
    x, edges = (np.array([list(bare(row, "nm")) for row in rows]) for rows in (positions, box))
    return _core.make_whole(x, edges, pairs)


def read(topology: PathLike, coordinates: PathLike, *, cutoff_nm: float = 1.0, coulomb: str = "pme",
         constraints: Optional[str] = "h-bonds", rigid_water: bool = True, hydrogen_mass: Optional[float] = None,
         include: Optional[PathLike] = None, **simulation: Any) -> Simulation:
    """Reads GROMACS's .top and .gro, or Amber's .prmtop and .inpcrd or .rst7, by way of OpenMM (pip install openmm).

        >>> sim = taut.read("x.top", "x.gro", set={"run.thermostat": "langevin", "run.temperature_k": 300})

    - ``cutoff_nm``: of pair forces; ``coulomb``: "pme", "reaction-field" or "none", all pairs without a box
    - ``constraints``: rigid bonds: "h-bonds", "all-bonds", "h-angles" (bonds and H–X–H angles) or None
    - ``rigid_water``: whether waters are rigid
    - ``hydrogen_mass``: of hydrogens [u], whose heavy atoms lose what they gain: 3 for steps of 4 fs; None: the file's
    - ``include``: GROMACS's folder of force fields; None: GMXDATA's, if it is set

    All other arguments are those of ``taut.Simulation.from_openmm``. Raises InputError for what it cannot read.
    """
    kind = _TOPOLOGIES.get(Path(topology).suffix.lower())
    if kind is None:
        raise InputError(f"{topology}: expected a topology, one of {', '.join(_TOPOLOGIES)}")
    if Path(coordinates).suffix.lower() not in _COORDINATES[kind]:
        raise InputError(f"{coordinates}: expected {kind}'s coordinates, {' or '.join(_COORDINATES[kind])}")
    for file in (topology, coordinates):
        if not Path(file).is_file():
            raise InputError(f"{file}: no such file")
    try:
        import openmm.app as app
        import openmm.unit as unit
    except ImportError as missing:
        raise InputError(f"{topology}: its reader is OpenMM's: pip install openmm") from missing
    if hydrogen_mass is not None and not 0 < (hydrogen_mass := number(hydrogen_mass, "u", "hydrogen_mass")):
        raise InputError(f"hydrogen_mass: expected more than 0, got {hydrogen_mass!r}")
    bonds = {None: None, "h-bonds": app.HBonds, "all-bonds": app.AllBonds, "h-angles": app.HAngles}
    pairs = {"pme": app.PME, "reaction-field": app.CutoffPeriodic, "none": app.NoCutoff}
    if constraints not in bonds:
        raise InputError(f'constraints: expected "h-bonds", "all-bonds", "h-angles" or None, got {constraints!r}')
    if coulomb not in pairs:
        raise InputError(f'coulomb: expected "pme", "reaction-field" or "none", got {coulomb!r}')
    positions, velocities, box = _placed(kind, coordinates)
    if coulomb == "none":
        box = None
    elif box is None:
        raise InputError(f'{coordinates}: has no box, which coulomb={coulomb!r} needs; take coulomb="none"')
    said: Dict[str, Any] = {} if box is None else {"periodicBoxVectors": box * unit.nanometer}
    masses = {} if hydrogen_mass is None else {"hydrogenMass": hydrogen_mass * unit.dalton}
    try:
        if kind == "GROMACS":
            data = os.environ.get("GMXDATA")
            if folder := include or (os.path.join(data, "top") if data else None):
                said["includeDir"] = str(folder)
            read_top = app.GromacsTopFile(str(topology), **said)
        else:
            read_top = app.AmberPrmtopFile(str(topology), **said)
        system = read_top.createSystem(nonbondedMethod=pairs[coulomb], nonbondedCutoff=cutoff_nm * unit.nanometer,
                                       constraints=bonds[constraints], rigidWater=rigid_water, **masses)
    except (ValueError, OSError, KeyError, IndexError, TypeError) as failure:
        raise InputError(f"{topology}, {coordinates}: OpenMM cannot read them: {failure}") from failure
    if box is not None:
        system.setDefaultPeriodicBoxVectors(*box)
    if box is not None:
        positions = _whole(system, positions, box)
    return Simulation.from_openmm(system, positions, velocities=velocities, box=box, topology=read_top.topology,
                                  **simulation)


def _placed(kind: str, coordinates: PathLike) -> Tuple[Any, Any, Any]:
    """Returns positions, velocities and box vectors of a file [nm, ps]; None for what it has not.

    Of .gro files OpenMM's reader leaves the velocities out, and it takes none without a box.
    """
    if kind == "GROMACS":
        positions, velocities, box, note = _core.read_coordinates(str(coordinates))
        if note:
            warnings.warn(note, stacklevel=3)
        return positions, velocities, box
    from openmm.app import AmberInpcrdFile
    from openmm.unit import nanometer

    try:
        placed = AmberInpcrdFile(str(coordinates))
    except (ValueError, OSError, KeyError, IndexError, TypeError) as failure:
        raise InputError(f"{coordinates}: OpenMM cannot read it: {failure}") from failure
    box = placed.boxVectors
    return placed.positions, placed.velocities, None if box is None else np.array(box.value_in_unit(nanometer))
