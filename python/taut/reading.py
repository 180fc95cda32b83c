"""Topologies and coordinates of GROMACS and Amber, by way of OpenMM's readers."""

import os
from pathlib import Path
from typing import Any, Optional, Union

from .errors import InputError
from .simulation import Simulation

PathLike = Union[str, Path]
_TOPOLOGIES = {".top": "GROMACS", ".prmtop": "Amber", ".parm7": "Amber"}
_COORDINATES = {"GROMACS": (".gro",), "Amber": (".inpcrd", ".rst7", ".restrt", ".ncrst")}


def read(topology: PathLike, coordinates: PathLike, *, cutoff_nm: float = 1.0, coulomb: str = "pme",
         constraints: Optional[str] = "h-bonds", rigid_water: bool = True, include: Optional[PathLike] = None,
         **simulation: Any) -> Simulation:
    """Reads GROMACS's .top and .gro, or Amber's .prmtop and .inpcrd or .rst7, by way of OpenMM (pip install openmm).

        >>> sim = taut.read("x.top", "x.gro", set={"run.thermostat": "langevin", "run.temperature_k": 300})

    - ``cutoff_nm``: of pair forces; ``coulomb``: "pme", "reaction-field" or "none", all pairs without a box
    - ``constraints``: rigid bonds: "h-bonds", "all-bonds", "h-angles" (bonds and H–X–H angles) or None
    - ``rigid_water``: whether waters are rigid
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
    bonds = {None: None, "h-bonds": app.HBonds, "all-bonds": app.AllBonds, "h-angles": app.HAngles}
    pairs = {"pme": app.PME, "reaction-field": app.CutoffPeriodic, "none": app.NoCutoff}
    if constraints not in bonds:
        raise InputError(f'constraints: expected "h-bonds", "all-bonds", "h-angles" or None, got {constraints!r}')
    if coulomb not in pairs:
        raise InputError(f'coulomb: expected "pme", "reaction-field" or "none", got {coulomb!r}')
    try:
        if kind == "GROMACS":
            placed = app.GromacsGroFile(str(coordinates))
            box = placed.getPeriodicBoxVectors()
            data = os.environ.get("GMXDATA")
            folder = include or (os.path.join(data, "top") if data else None)
            read_top = app.GromacsTopFile(str(topology), periodicBoxVectors=box,
                                          **({"includeDir": str(folder)} if folder else {}))
        else:
            placed = app.AmberInpcrdFile(str(coordinates))
            box = placed.boxVectors
            read_top = app.AmberPrmtopFile(str(topology), **({} if box is None else {"periodicBoxVectors": box}))
        system = read_top.createSystem(nonbondedMethod=pairs[coulomb], nonbondedCutoff=cutoff_nm * unit.nanometer,
                                       constraints=bonds[constraints], rigidWater=rigid_water)
    except (ValueError, OSError, KeyError, IndexError, TypeError) as failure:
        raise InputError(f"{topology}, {coordinates}: OpenMM cannot read them: {failure}") from failure
    if box is not None and coulomb != "none":
        system.setDefaultPeriodicBoxVectors(*box)
    velocities = getattr(placed, "velocities", None)
    return Simulation.from_openmm(system, placed.positions, velocities=velocities,
                                  box=box if coulomb != "none" else None, topology=read_top.topology, **simulation)
