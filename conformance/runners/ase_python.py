"""ASE: FixBondLengths under VelocityVerlet.

Forces come from a calculator of the runner's. ASE's units are converted by its own constants: its time is Å √(u/eV), so
that steps, masses and energies keep Newton's law; a length of 1 nm is 10 Å. Atoms that never move are of FixAtoms,
which is applied beside FixBondLengths as the list of constraints says.
"""

from __future__ import annotations

from typing import Any, Dict, List

import ase
import numpy as np
from ase import Atoms, units
from ase.calculators.calculator import Calculator, all_changes
from ase.constraints import FixAtoms, FixBondLengths
from ase.md.langevin import Langevin
from ase.md.verlet import VelocityVerlet

from forces import force_function
from shared import (
    Case, EngineStopped, moving, nearest_images, not_offered, row_steps, start_velocities, wants_refusal)

VARIANTS: Dict[str, Dict[str, Any]] = {"fix_bond_lengths": {}}
EV = 96.48533212331  # kJ/mol in an eV
PS = 1000 * units.fs
SPEED = units.Ang * 10 / PS


def describe(variant: str) -> Dict[str, str]:
    return {"engine": "ASE", "version": ase.__version__,
            "settings": "FixBondLengths, tolerance 1e-13, the default; VelocityVerlet (Langevin with a thermostat), double precision"}


class Formulas(Calculator):
    """The case's forces."""

    implemented_properties = ["energy", "forces"]

    def __init__(self, case: Case) -> None:
        super().__init__()
        self._evaluate = force_function(case)

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes) -> None:
        super().calculate(atoms, properties, system_changes)
        energy, forces = self._evaluate(atoms.get_positions() / 10)
        self.results = {"energy": energy / EV, "forces": forces / EV / 10}


def make_constraints(case: Case) -> List[Any]:
    pairs = [bond["atoms"] for bond in case["system"]["bonds"]]
    made: List[Any] = []
    frozen = [int(i) for i in np.nonzero(~moving(case))[0]]
    if frozen:
        made.append(FixAtoms(frozen))
    if pairs:
        made.append(FixBondLengths(pairs, bondlengths=[10 * bond["length_nm"] for bond in case["system"]["bonds"]]))
    return made


def run(case: Case, variant: str) -> Case:
    system, at_rest = case["system"], ~moving(case)
    if "virtual_sites" in system:
        return not_offered("no virtual sites")
    if not nearest_images(case):
        return not_offered("a bond goes to the nearest image, and this one does not")
    if any(at_rest[i] for bond in system["bonds"] for i in bond["atoms"]) and not wants_refusal(case):
        return not_offered("FixBondLengths does not know of atoms that FixAtoms holds: the one moves what the other fixes")
    masses = np.where(at_rest, 1.0, system["masses_u"])
    try:
        atoms = Atoms("H" * len(masses), positions=10 * np.array(case["start"]["positions_nm"], dtype=float),
                      masses=system["masses_u"] if wants_refusal(case) else masses, constraint=make_constraints(case),
                      cell=10 * np.array(system["box_nm"]) if "box_nm" in system else None, pbc="box_nm" in system)
    except ValueError as why:
        return {"refused": str(why)} if wants_refusal(case) else not_offered(str(why))
    atoms.calc = Formulas(case)
    try:
        return move(case, atoms)
    except (RuntimeError, ZeroDivisionError) as stopped:
        if wants_refusal(case):
            return {"refused": str(stopped)}
        raise EngineStopped(str(stopped)) from None


def move(case: Case, atoms: Atoms) -> Case:
    atoms.set_velocities(start_velocities(case) * SPEED)
    step = case["run"]["step_ps"] * PS
    bath = case["run"].get("langevin")
    if bath:
        dynamics = Langevin(atoms, step, temperature_K=bath["temperature_k"], friction=bath["friction_per_ps"] / PS,
                            fixcm=False, rng=np.random.default_rng(case["run"].get("seed", 1)))
    else:
        dynamics = VelocityVerlet(atoms, step)
    rows: Dict[str, List[Any]] = {key: [] for key in ("step", "positions_nm", "velocities_nm_per_ps",
                                                      "potential_kj_per_mol", "kinetic_kj_per_mol")}
    done = 0
    for row in row_steps(case):
        if row > done:
            dynamics.run(row - done)
        done = row
        for key, value in zip(rows, (row, atoms.get_positions() / 10, atoms.get_velocities() / SPEED,
                                     atoms.get_potential_energy() * EV, atoms.get_kinetic_energy() * EV)):
            rows[key].append(value)
    return {"rows": rows, "degrees_of_freedom": atoms.get_number_of_degrees_of_freedom()}
