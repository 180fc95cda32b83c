"""taut's force field for ASE, and a simulation's atoms as ASE's. ASE is imported only where it is asked for."""

from __future__ import annotations

from typing import Any, Dict, Optional, Sequence, Tuple

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InputError

Reals = npt.NDArray[np.float64]


def _ase() -> Any:
    try:
        import ase.calculators.calculator
        import ase.constraints
        import ase.units
    except ImportError:
        raise ImportError("taut.Calculator and to_ase need ASE: pip install ase") from None
    return ase


def atoms_of(simulation: Any) -> Any:
    """Returns ase.Atoms of a simulation, with its rigid bonds as FixBondLengths and its anchors as FixAtoms."""
    ase, names, masses = _ase(), simulation.names, simulation.masses
    known = ase.data.atomic_numbers
    atoms = ase.Atoms([symbol if symbol in known else "X" for symbol in names["element"].tolist()],
                      positions=10 * simulation.positions)
    atoms.set_masses([mass if mass > 0 else None for mass in masses])
    atoms.set_array("names", names["atom"])
    atoms.set_array("residuenames", names["residue"])
    atoms.set_array("residuenumbers", names["residue_index"] + 1)
    if simulation.box is not None:
        atoms.set_cell(10 * simulation.box)
        atoms.pbc = True
    atoms.set_velocities(simulation.velocities * (10 / (1000 * ase.units.fs)))
    constraints = []
    if not np.all(masses > 0):
        constraints.append(ase.constraints.FixAtoms(np.flatnonzero(masses == 0)))
    if len(simulation.bonds):
        constraints.append(ase.constraints.FixBondLengths(simulation.bonds, bondlengths=10 * simulation.lengths))
    atoms.set_constraint(constraints)
    return atoms


def _standard_cell(cell: Reals) -> Tuple[Reals, Reals]:
    """Returns a cell's lattice in reduced form, and the rotation Q that turns x into x @ Q there."""
    turn = np.eye(3)
    if np.any(np.triu(cell, 1)) or np.any(np.diag(cell) < 0):
        turn, upper = np.linalg.qr(cell.T)
        turn = turn * np.sign(np.diag(upper))
        cell = np.tril(cell @ turn)
    if not np.linalg.det(turn) > 0 or not np.all(np.diag(cell) > 0):
        raise InputError("cell: its vectors are left-handed or lie in a plane; swap two of them")
    a, b, c = cell
    c = c - np.round(c[1] / b[1]) * b
    return np.array([a, b - np.round(b[0] / a[0]) * a, c - np.round(c[0] / a[0]) * a]), turn


_JOINED: Dict[type, type] = {}


def _joined(kind: type) -> type:
    """Returns a class that is both taut's calculator and ASE's."""
    if kind in _JOINED:
        return _JOINED[kind]
    made = type(kind.__name__, (kind, _ase().calculators.calculator.Calculator), {"__doc__": kind.__doc__})
    made.__module__ = kind.__module__
    _JOINED[kind] = made
    return made


class Calculator:
    """taut's forces for ASE, in eV and Å: ``atoms.calc = taut.Calculator(sim)``.

    - ``simulation``: a taut.Simulation, whose force field, number of threads and forces of your own count. Its state
      plays no part and does not change; ``sim.to_ase()`` returns its atoms as ASE's
    - ``bonds``: "fixed" or "free". No force holds rigid bonds, so ASE must: with "fixed" each has to be in a
      FixBondLengths of the atoms with its length, or between two atoms of a FixAtoms, else the calculation raises
      InputError. With "free" nothing holds them, as in a numerical gradient

    Forces and energy are those before constraints. There is a stress in a box where no rigid bonds, anchors or forces
    from outside have a part in it, or with "free" that of the force field alone. Atoms may be wrapped: molecules are
    made whole. The cell may have any orientation. Raises InputError for virtual sites and steered atoms.
    """

    implemented_properties: Sequence[str] = ("energy", "free_energy", "forces", "stress")
    name = "taut"

    def __new__(cls, *arguments: Any, **named: Any) -> "Calculator":
        there = issubclass(cls, _ase().calculators.calculator.Calculator)
        made: Calculator = object.__new__(cls if there else _joined(cls))
        return made

    def __init__(self, simulation: Any, bonds: str = "fixed") -> None:
        if bonds not in ("fixed", "free"):
            raise InputError(f"bonds: {bonds!r}, expected 'fixed' or 'free'")
        if not hasattr(simulation, "_engine"):
            raise InputError(f"Calculator: expected a taut.Simulation, got {simulation!r}")
        super().__init__()
        self._simulation, self._free = simulation, bonds == "free"
        self._evaluation = _core.ForceEvaluation(simulation._engine)

    def __reduce__(self) -> Tuple[Any, ...]:
        return Calculator, (self._simulation, "free" if self._free else "fixed")

    def calculate(self, atoms: Any = None, properties: Sequence[str] = ("energy",),
                  system_changes: Optional[Sequence[str]] = None) -> None:
        """Is called by ASE."""
        ase = _ase()
        ase.calculators.calculator.Calculator.calculate(self, atoms, properties, system_changes or [])
        count, box = len(self._simulation.masses), self._simulation.box
        if len(atoms) != count:
            raise InputError(f"atoms: {len(atoms)}, expected the simulation's {count}")
        if not np.all(atoms.pbc == (box is not None)):
            raise InputError(f"pbc: {atoms.pbc.tolist()}, expected {box is not None} three times, as the simulation is")
        if not self._free:
            self._expect_held_bonds(atoms)
        vectors, turn = _standard_cell(atoms.cell.array / 10) if box is not None else (None, np.eye(3))
        energy, forces, virial = self._evaluation.at(atoms.positions @ turn / 10, vectors)
        ev = ase.units.kJ / ase.units.mol
        self.results: Any = {"energy": energy * ev, "free_energy": energy * ev, "forces": forces @ turn.T * (ev / 10)}
        if virial is not None and (self._free or not len(self._simulation.bonds)):
            tensor = turn @ virial @ turn.T * (-ev / atoms.get_volume())
            self.results["stress"] = tensor[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
        elif "stress" in properties:
            raise ase.calculators.calculator.PropertyNotImplementedError(
                "stress: needs a box without anchors and forces from outside, and no rigid bonds, whose part in it "
                "ASE has not; taut.Calculator(sim, bonds=\"free\") gives that of the force field alone")

    def _expect_held_bonds(self, atoms: Any) -> None:
        """Raises InputError for a rigid bond that none of ASE's constraints holds at its length."""
        bonds, lengths = np.sort(self._simulation.bonds, 1), 10 * self._simulation.lengths
        held, fixed = np.full(len(bonds), np.nan), np.zeros(len(atoms), bool)
        keys = bonds[:, 0] * np.int64(len(atoms)) + bonds[:, 1]
        order = np.argsort(keys)
        for constraint in atoms.constraints:
            if type(constraint).__name__ == "FixAtoms":
                fixed[constraint.get_indices()] = True
            elif type(constraint).__name__ == "FixBondLengths" and len(bonds):
                pairs, lengths_there = np.sort(constraint.pairs, 1), constraint.bondlengths
                if lengths_there is None:  # ASE takes those of the positions
                    lengths_there = constraint.initialize_bond_lengths(atoms)
                keys_there = pairs[:, 0] * np.int64(len(atoms)) + pairs[:, 1]
                place = order[np.searchsorted(keys, keys_there, sorter=order) % len(keys)]
                same = keys[place] == keys_there
                held[place[same]] = np.asarray(lengths_there)[same]
        remedy = ("atoms.set_constraint(FixBondLengths(sim.bonds, bondlengths=10 * sim.lengths)) holds all, and "
                  "taut.Calculator(sim, bonds=\"free\") does without")
        both_fixed = fixed[bonds].all(1)
        for k in np.flatnonzero(np.isnan(held) & ~both_fixed)[:1]:
            raise InputError(f"the bond {bonds[k][0]}-{bonds[k][1]} is rigid, and no FixBondLengths of the atoms holds "
                             f"it; {remedy}")
        for k in np.flatnonzero(abs(held - lengths) > 1e-6 * lengths)[:1]:
            raise InputError(f"FixBondLengths holds the bond {bonds[k][0]}-{bonds[k][1]} at {held[k]:.6g} Å, and its "
                             f"length is {lengths[k]:.6g} Å; {remedy}")
