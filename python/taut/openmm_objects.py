"""OpenMM's objects, its XML, and back. OpenMM itself is imported where objects are given or asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any, List, Optional, Tuple

import numpy as np

from . import _core
from .errors import InputError


def xml_of(thing: Any, what: str) -> str:
    """The text of a System or State: of an object, of XML, or of a file of it."""
    if isinstance(thing, Path) or (isinstance(thing, str) and not thing.lstrip().startswith("<")):
        try:
            return Path(thing).read_text()
        except OSError as error:
            raise InputError(f"{thing}: cannot be read: {error.strerror}") from None
    if isinstance(thing, str):
        return thing
    if type(thing).__module__.split(".")[0] not in ("openmm", "simtk"):
        raise InputError(f"{what}: expected an object of OpenMM's, its XML or a file of it, got {thing!r}")
    from openmm import XmlSerializer

    try:
        return str(XmlSerializer.serialize(thing))
    except Exception as error:  # a force that is code
        raise InputError(f"{what}: OpenMM cannot write it as XML, which is what taut reads: {error}") from None


def vectors(given: Any, unit: str, what: str, rows: Optional[int] = None) -> np.ndarray:
    """(n, 3) numbers of an array or of a Quantity, in nm or nm/ps."""
    def bare(quantity: Any) -> Any:
        if not hasattr(quantity, "value_in_unit"):
            return quantity
        from openmm import unit as units

        return quantity.value_in_unit(units.nanometer if unit == "nm" else units.nanometer / units.picosecond)

    kind = getattr(getattr(bare(given), "dtype", None), "kind", "f")
    if kind not in "fiuO":
        raise InputError(f"{what}: expected {rows or 'n'} rows of three numbers [{unit}], got dtype {bare(given).dtype}")
    try:
        array = np.array([[float(c) for c in bare(row)] for row in bare(given)])
    except (TypeError, ValueError):
        raise InputError(f"{what}: expected {rows or 'n'} rows of three numbers [{unit}], got {given!r}") from None
    if array.ndim != 2 or array.shape[1] != 3 or (rows is not None and len(array) != rows):
        raise InputError(f"{what}: expected {rows or 'n'} rows of three numbers [{unit}], got shape {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{what}: expected finite numbers [{unit}], row {np.argwhere(~np.isfinite(array))[0][0]} "
                         "has others")
    return array


def _rows(tag: str, array: np.ndarray) -> str:
    return "".join(f'<{tag} x="{x!r}" y="{y!r}" z="{z!r}"/>' for x, y, z in array.tolist())


def _box(given: Any) -> np.ndarray:
    given = list(given)
    if len(given) == 3 and all(isinstance(edge, (int, float)) for edge in given):
        given = np.diag(given).tolist()
    return vectors(given, "nm", "box", 3)


def state_xml(positions: Any, velocities: Any, box: Any) -> str:
    """A State as OpenMM writes it: what is given, if it is one, or else from positions, velocities and box."""
    as_state = isinstance(positions, (str, Path)) or type(positions).__name__ == "State"
    if as_state:
        if velocities is not None or box is not None:
            raise InputError("velocities, box: no effect, the State has them")
        return xml_of(positions, "positions")
    x = vectors(positions, "nm", "positions")
    text = '<?xml version="1.0" ?>\n<State openmmVersion="8.0" time="0" type="State" version="1">'
    if box is not None:
        edges = _box(box)
        text += "<PeriodicBoxVectors>"
        text += "".join(_rows(name, edges[n:n + 1]) for n, name in enumerate("ABC")) + "</PeriodicBoxVectors>"
    text += "<Positions>" + _rows("Position", x) + "</Positions>"
    if velocities is not None:
        text += "<Velocities>" + _rows("Velocity", vectors(velocities, "nm/ps", "velocities", len(x))) + "</Velocities>"
    return text + "</State>\n"


def read(system: Any, state: str, said: List[str], topology: Any, threads: Optional[int]) -> "_core.Input":
    """What OpenMM's two texts hold, with names from a Topology."""
    lines = []
    for atom in [] if topology is None else getattr(topology, "topology", topology).atoms():
        element = atom.element.symbol if atom.element else ""
        lines.append(f"{atom.name}\t{atom.residue.name}\t{element}\t{atom.residue.index}\n")
    names = "".join(lines) if topology is None or lines else "\n"  # a topology without atoms is not none
    return _core.Input.of_openmm(xml_of(system, "system"), state, names, said, threads)


def objects_of(system: str, state: str) -> Tuple[Any, Any]:
    """OpenMM's System and State of their XML."""
    from openmm import XmlSerializer

    return XmlSerializer.deserialize(system), XmlSerializer.deserialize(state)
