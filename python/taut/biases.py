"""Biases of collective variables: taut.Distance, taut.Angle, taut.Torsion and taut.Gyration."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar, Dict, Iterable, List, Optional, Sequence, Union

import numpy as np

from .errors import InputError

__all__ = ["Angle", "Bias", "Distance", "Gyration", "Torsion"]

#: A group of atoms: an index, indices, a mask over all atoms, an AtomGroup of MDAnalysis's, a span "10-29", or the
#: name of atoms.
Group = Any


def _words(group: Group) -> List[Union[int, str]]:
    """Returns a group as a scene's file has it."""
    if isinstance(group, (str, int)) and not isinstance(group, bool):
        return [group]
    atoms = getattr(group, "indices", group)
    if isinstance(atoms, (list, tuple, range)) and any(isinstance(one, str) for one in atoms):
        return [one if isinstance(one, str) else int(one) for one in atoms]
    numbers = np.atleast_1d(np.asarray(atoms))
    if numbers.dtype == bool:
        numbers = np.flatnonzero(numbers)
    if numbers.ndim != 1 or not len(numbers) or numbers.dtype.kind not in "iu":
        raise InputError(f"a bias's group: expected indices from 0, a mask, a span \"10-29\" or a name, got {group!r}")
    return [int(a) for a in numbers]


class Bias:
    """Base of the biases, potentials of a collective variable that C++ computes in each step.

    They are what a section [[bias]] of a scene is: ``taut.Simulation("chain", biases=[taut.Distance(...)])``. Their
    arguments have the names of its keys. One of these laws acts:

    - with a ``k`` and ``at``: a harmonic restraint; without ``at``: where the start has the variable
    - with a ``k`` and ``at_least``, ``at_most`` or both: walls
    - with a ``force`` (of an angle, ``torque``): a constant pull towards larger values

    With ``rate`` the restraint, or the walls, move. ``sim.log`` has columns of the variable and of the force along it,
    which begin with ``bias_NAME``.
    """

    variable: ClassVar[str]

    def groups(self) -> Sequence[Group]:
        """Returns the groups of atoms, in the order of the file."""
        fields = dataclasses.fields(self)  # type: ignore[arg-type]
        return [getattr(self, field.name) for field in fields if field.name.startswith("group")]

    def settings(self) -> Dict[str, Any]:
        """Returns the keys of a section [[bias]]."""
        own = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)  # type: ignore[arg-type]
               if not field.name.startswith("group")}
        along = own.pop("along", None)
        said = {key: value for key, value in own.items() if value is not None}
        if along is not None:
            said["along"] = [float(one) for one in along]
        return {"variable": self.variable, "groups": [_words(group) for group in self.groups()], **said}


@dataclasses.dataclass
class Distance(Bias):
    """A bias of the distance between the centres of mass of two groups of atoms.

    ``along``: a direction; the variable is then the component of the separation from the first to the second.
    """

    variable: ClassVar[str] = "distance"
    group1: Group
    group2: Group
    along: Optional[Sequence[float]] = None
    at_nm: Optional[float] = None
    at_least_nm: Optional[float] = None
    at_most_nm: Optional[float] = None
    rate_nm_ps: Optional[float] = None
    k_kj_mol_nm2: Optional[float] = None
    force_kj_mol_nm: Optional[float] = None
    name: Optional[str] = None


@dataclasses.dataclass
class Angle(Bias):
    """A bias of the angle at the second of three centres of mass."""

    variable: ClassVar[str] = "angle"
    group1: Group
    group2: Group
    group3: Group
    at_deg: Optional[float] = None
    at_least_deg: Optional[float] = None
    at_most_deg: Optional[float] = None
    rate_deg_ps: Optional[float] = None
    k_kj_mol_rad2: Optional[float] = None
    torque_kj_mol_rad: Optional[float] = None
    name: Optional[str] = None


@dataclasses.dataclass
class Torsion(Bias):
    """A bias of the torsion of four centres of mass, 0 where they are cis.

    The log has the turn of it that is within 180° of ``at``, or of the middle between the walls.
    """

    variable: ClassVar[str] = "torsion"
    group1: Group
    group2: Group
    group3: Group
    group4: Group
    at_deg: Optional[float] = None
    at_least_deg: Optional[float] = None
    at_most_deg: Optional[float] = None
    rate_deg_ps: Optional[float] = None
    k_kj_mol_rad2: Optional[float] = None
    name: Optional[str] = None


@dataclasses.dataclass
class Gyration(Bias):
    """A bias of the radius of gyration of a group of atoms, weighted by their masses."""

    variable: ClassVar[str] = "gyration"
    group: Group
    at_nm: Optional[float] = None
    at_least_nm: Optional[float] = None
    at_most_nm: Optional[float] = None
    rate_nm_ps: Optional[float] = None
    k_kj_mol_nm2: Optional[float] = None
    force_kj_mol_nm: Optional[float] = None
    name: Optional[str] = None


def settings_of(biases: Iterable[Any]) -> List[Dict[str, Any]]:
    """Returns biases as the list of a scene's sections. Raises InputError for what is none."""
    listed = list(biases)
    for bias in listed:
        if not isinstance(bias, Bias):
            raise InputError(f"biases: expected taut.Distance(...), Angle, Torsion or Gyration, got {bias!r}")
    return [bias.settings() for bias in listed]
