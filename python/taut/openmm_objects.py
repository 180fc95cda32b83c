"""Turns OpenMM's objects into XML and back. OpenMM is imported only where its objects are given or asked for."""

from __future__ import annotations

import bz2
import gzip
import numbers
from pathlib import Path
from typing import Any, List, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _core, mdanalysis
from .errors import InputError


def xml_of(thing: Any, what: str) -> str:
    """Returns the XML of a System or State that is given as an object, as XML or as a file."""
    if isinstance(thing, Path) or (isinstance(thing, str) and not thing.lstrip().startswith("<")):
        opened: Any = {".gz": gzip.open, ".bz2": bz2.open}.get(Path(thing).suffix, open)
        try:
            with opened(thing, "rt") as file:
                return str(file.read())
        except (OSError, EOFError) as error:
            raise InputError(f"{thing}: cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if isinstance(thing, str):
        return thing
    if type(thing).__module__.split(".")[0] not in ("openmm", "simtk"):
        raise InputError(f"{what}: expected an object of OpenMM's, its XML or a file of it, got {thing!r}")
    from openmm import XmlSerializer

    try:
        return str(XmlSerializer.serialize(thing))
    except Exception as error:  # a force that is Python code
        raise InputError(f"{what}: OpenMM cannot write it as XML, which is what taut reads: {error}") from None


def bare(given: Any, unit: str) -> Any:
    """Returns the numbers of an OpenMM Quantity in a unit of OpenMM's, and anything else as it is."""
    if not hasattr(given, "value_in_unit"):
        return given
    from openmm import unit as units

    return given.value_in_unit({"nm": units.nanometer, "nm/ps": units.nanometer / units.picosecond,
                                "kJ/mol/nm": units.kilojoule_per_mole / units.nanometer,
                                "K": units.kelvin, "fs": units.femtosecond, "u": units.dalton}[unit])


def number(given: Any, unit: str, what: str) -> Any:
    """Returns a number, or an OpenMM Quantity in the unit. Raises InputError that names the argument for others."""
    try:
        found = bare(given, unit)
    except TypeError:  # another kind of unit
        found = None
    if isinstance(found, bool) or not isinstance(found, numbers.Real):
        raise InputError(f"{what}: expected a number [{unit}], got {given!r}")
    return found  # 1 stays 1: settings are compared as texts


def vectors(given: Any, unit: str, what: str, rows: Optional[int] = None) -> npt.NDArray[Any]:
    """Returns the numbers of an array or of an OpenMM Quantity, (n, 3) in nm or nm/ps.

    Raises InputError that names the argument for another shape or type, and for numbers that are not finite.
    """
    if mdanalysis.is_group(given):
        given = mdanalysis.numbers_of(given, what)
        if given is None:
            raise InputError(f"{what}: the universe's frame has none")

    kind = getattr(getattr(bare(given, unit), "dtype", None), "kind", "f")
    if kind not in "fiuO":
        raise InputError(f"{what}: expected {rows or 'n'} rows of three numbers [{unit}], "
                         f"got dtype {bare(given, unit).dtype}")
    try:
        if isinstance(given, np.ndarray) and kind != "O":
            array = np.array(given, float)
        else:
            array = np.array([[float(c) for c in bare(row, unit)] for row in bare(given, unit)])
    except (TypeError, ValueError):
        raise InputError(f"{what}: expected {rows or 'n'} rows of three numbers [{unit}], got {given!r}") from None
    if array.ndim != 2 or array.shape[1] != 3 or (rows is not None and len(array) != rows):
        raise InputError(f"{what}: expected {rows or 'n'} rows of three numbers [{unit}], got shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{what}: expected finite numbers [{unit}], row {np.argwhere(~np.isfinite(array))[0][0]} "
                         "has others")
    return array


def _rows(tag: str, array: npt.NDArray[Any]) -> str:
    return "".join(f'<{tag} x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in array.tolist())


def box_vectors(given: Any) -> npt.NDArray[Any]:
    """Returns the vectors of a box in rows, (3, 3) [nm], from three vectors or from three edges."""
    if mdanalysis.is_group(given):
        return vectors(given, "nm", "box", 3)
    listed = bare(given, "nm")
    if not hasattr(listed, "__iter__"):
        raise InputError(f"box: expected three vectors or three edges [nm], got {given!r}")
    edges = [bare(edge, "nm") for edge in listed]
    if len(edges) == 3 and all(isinstance(edge, numbers.Real) for edge in edges):
        return vectors(np.diag(np.array(edges, float)), "nm", "box", 3)
    return vectors(given, "nm", "box", 3)


def state_xml(positions: Any, velocities: Any, box: Any) -> str:
    """Returns the XML of a State: of the one that is given, or of positions, velocities and box."""
    as_state = isinstance(positions, (str, Path)) or type(positions).__name__ == "State"
    if as_state:
        if velocities is not None or box is not None:
            raise InputError("velocities, box: no effect, the State has them")
        return xml_of(positions, "positions")
    x = vectors(positions, "nm", "positions")
    if mdanalysis.is_group(positions):
        velocities = mdanalysis.numbers_of(positions, "velocities") if velocities is None else velocities
        box = mdanalysis.numbers_of(positions, "box") if box is None else box
    text = '<?xml version="1.0" ?>\n<State openmmVersion="8.0" time="0" type="State" version="1">'
    if box is not None:
        edges = box_vectors(box)
        text += "<PeriodicBoxVectors>"
        text += "".join(_rows(name, edges[n:n + 1]) for n, name in enumerate("ABC")) + "</PeriodicBoxVectors>"
    text += "<Positions>" + _rows("Position", x) + "</Positions>"
    if velocities is not None:
        text += "<Velocities>" + _rows("Velocity", vectors(velocities, "nm/ps", "velocities", len(x))) + "</Velocities>"
    return text + "</State>\n"


def read(system: Any, state: str, said: List[str], topology: Any, threads: Optional[int]) -> "_core.Input":
    """Reads a System and the XML of a State, with names of atoms and residues from a Topology."""
    lines = mdanalysis.names_of(topology) if mdanalysis.is_group(topology) else []
    for atom in [] if lines or topology is None else getattr(topology, "topology", topology).atoms():
        element = atom.element.symbol if atom.element else ""
        lines.append(f"{atom.name}\t{atom.residue.name}\t{element}\t{atom.residue.index}\n")
    names = "".join(lines) if topology is None or lines else "\n"  # a topology without atoms is not none
    return _core.Input.of_openmm(xml_of(system, "system"), state, names, said, threads)


def objects_of(system: str, state: str) -> Tuple[Any, Any]:
    """Returns OpenMM's System and State from their XML."""
    from openmm import XmlSerializer

    return XmlSerializer.deserialize(system), XmlSerializer.deserialize(state)
