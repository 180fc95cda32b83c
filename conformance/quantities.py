"""What a case asks for, computed from the rows of a run in the same way for every engine.

A row is a moment of the run. The rows are a dict of arrays whose first index is the row; README.md lists its keys.
A quantity that the rows do not suffice for is NotTold with the missing key: the engine does not offer it.
"""

from __future__ import annotations

from typing import Any, Callable, Dict, List

import numpy as np

Case = Dict[str, Any]


class NotTold(Exception):
    """The engine does not tell a key that a quantity needs."""


class Rows(Dict[str, np.ndarray]):
    def __missing__(self, key: str) -> np.ndarray:
        raise NotTold(key)


BOLTZMANN = 0.00831446261815324  # kJ/mol/K


def masses_of(case: Case) -> np.ndarray:
    return np.array(case["system"]["masses_u"], dtype=float)


def bond_vectors(case: Case, positions: np.ndarray) -> np.ndarray:
    """From the first atom of each bond to the image of the second that the bond names."""
    bonds = case["system"]["bonds"]
    box = np.array(case["system"].get("box_nm", np.zeros((3, 3))), dtype=float)
    along = np.empty((len(bonds), 3))
    for bond, r in zip(bonds, along):
        i, j = bond["atoms"]
        r[:] = positions[j] - positions[i] + np.array(bond.get("image", [0, 0, 0])) @ box
    return along


def gradients(case: Case, positions: np.ndarray) -> np.ndarray:
    """The unit vectors along bonds as a matrix, bonds by 3·atoms: the gradient of each length."""
    made = np.zeros((len(case["system"]["bonds"]), len(positions), 3))
    for row, bond, r in zip(made, case["system"]["bonds"], bond_vectors(case, positions)):
        i, j = bond["atoms"]
        row[i], row[j] = -r / np.linalg.norm(r), r / np.linalg.norm(r)
    return made.reshape(len(made), -1)


def count_degrees_of_freedom(case: Case, positions: np.ndarray) -> int:
    """3 for each atom that moves, less the rank of J diag(1/m)^½, J the gradients of the bonds."""
    masses = np.repeat(masses_of(case), 3)
    scaled = gradients(case, positions)[:, masses > 0] / np.sqrt(masses[masses > 0])
    rank = np.linalg.matrix_rank(scaled, tol=1e-9) if len(scaled) else 0
    return int((masses > 0).sum() - rank)


def total_energy(case: Case, rows: Rows) -> np.ndarray:
    kinetic = rows.get("kinetic_kj_per_mol")
    if kinetic is None:
        kinetic = 0.5 * np.einsum("a,rai,rai->r", masses_of(case), *[rows["velocities_nm_per_ps"]] * 2)
    return rows["potential_kj_per_mol"] + kinetic


def bond_error(case: Case, rows: Rows) -> float:
    lengths = np.array([bond["length_nm"] for bond in case["system"]["bonds"]])
    return max(
        float(np.abs(np.linalg.norm(bond_vectors(case, x), axis=1) / lengths - 1).max())
        for x in rows["positions_nm"]
    )


def momentum(case: Case, rows: Rows) -> float:
    p = np.einsum("a,rai->ri", masses_of(case), rows["velocities_nm_per_ps"])
    return float(np.abs(p - p[0]).max())


def angular_momentum(case: Case, rows: Rows) -> float:
    turning = np.cross(rows["positions_nm"], rows["velocities_nm_per_ps"])
    total = np.einsum("a,rai->ri", masses_of(case), turning)
    return float(np.abs(total - total[0]).max())


def drift(case: Case, rows: Rows) -> float:
    time_ns = rows["step"] * case["run"]["step_ps"] / 1000
    slope = np.polyfit(time_ns, total_energy(case, rows), 1)[0]
    freedom = count_degrees_of_freedom(case, rows["positions_nm"][0])
    return float(slope / (BOLTZMANN * case["run"]["reference_k"] * freedom))


def temperatures(case: Case, rows: Rows) -> Dict[str, float]:
    """2K over k times the degrees of freedom: of the molecules' centres, of ½ L·I⁻¹L, and of the rest."""
    masses, settled = masses_of(case), settle_in(rows)
    bonds = [set(bond["atoms"]) for bond in case["system"]["bonds"]]
    energy, freedom = np.zeros(3), np.zeros(3)
    for atoms in case["system"]["molecules"]:
        m, x, v = masses[atoms], settled["positions_nm"][:, atoms], settled["velocities_nm_per_ps"][:, atoms]
        flow = np.einsum("a,rai->ri", m, v) / m.sum()
        r, u = x - np.einsum("a,rai->ri", m, x)[:, None] / m.sum(), v - flow[:, None]
        inertia = np.einsum("a,raj,raj,kl->rkl", m, r, r, np.eye(3)) - np.einsum("a,rak,ral->rkl", m, r, r)
        turning = np.einsum("a,rai->ri", m, np.cross(r, u))
        spin = np.einsum("rkl,rl->rk", np.linalg.pinv(inertia, rcond=1e-9, hermitian=True), turning)
        rotation, axes = 0.5 * (turning * spin).sum(), 0 if len(atoms) == 1 else 2 if len(atoms) == 2 else 3
        energy += [0.5 * m.sum() * (flow**2).sum(), rotation, 0.5 * np.einsum("a,rai,rai->", m, u, u) - rotation]
        held = sum(bond <= set(atoms) for bond in bonds)
        freedom += np.array([3, axes, 3 * len(atoms) - held - 3 - axes]) * len(x)
    names = ("translation", "rotation", "internal")
    return {name: 2 * k / (BOLTZMANN * n) for name, k, n in zip(names, energy, freedom) if n}


def settle_in(rows: Rows) -> Rows:
    """The rows without their first fifth, of which no mean is taken."""
    begin = (len(rows["step"]) + 4) // 5
    return Rows({key: values[begin:] for key, values in rows.items()})


def evaluate(of: List[Any], positions: np.ndarray, shift: int) -> float:
    if of[0] == "square":
        return evaluate(of[1], positions, shift) ** 2
    at = [positions[i + shift] for i in of[1:]]
    if of[0] == "distance":
        return float(np.linalg.norm(at[1] - at[0]))
    if of[0] == "cos_angle":
        a, b = at[0] - at[1], at[2] - at[1]
        return float(a @ b / np.linalg.norm(a) / np.linalg.norm(b))
    return float(at[0]["xyz".index(of[0])])


def velocities_of_masses(case: Case, rows: Rows) -> np.ndarray:
    """Of the last row; those of virtual sites are left out as 0, since few engines keep any."""
    last = rows["velocities_nm_per_ps"][-1].copy()
    last[[site["atom"] for site in case["system"].get("virtual_sites", [])]] = 0
    return last


def mean(case: Case, ask: Dict[str, Any], rows: Rows) -> float:
    atoms = len(case["system"]["masses_u"])
    shifts = range(0, atoms, ask.get("each", atoms))
    frames = settle_in(rows)["positions_nm"]
    return float(np.mean([evaluate(ask["of"], x, shift) for x in frames for shift in shifts]))


OF_ROWS: Dict[str, Callable[[Case, Rows], Any]] = {
    "positions_nm": lambda case, rows: rows["positions_nm"][-1],
    "velocities_nm_per_ps": velocities_of_masses,
    "tensions_kj_per_mol_nm": lambda case, rows: rows["tensions_kj_per_mol_nm"][-1],
    "bond_error": bond_error,
    "momentum_u_nm_per_ps": momentum,
    "angular_momentum_u_nm2_per_ps": angular_momentum,
    "energy_kj_per_mol": lambda case, rows: total_energy(case, rows)[-1],
    "energy_range_kj_per_mol": lambda case, rows: np.ptp(total_energy(case, rows)),
    "drift_kt_per_ns_dof": drift,
}


def measure(case: Case, ask: Dict[str, Any], result: Dict[str, Any]) -> np.ndarray:
    """The value that the run's result has for what is asked."""
    what, rows = ask["what"], result["rows"]
    if what == "degrees_of_freedom":
        if what not in result:
            raise NotTold(what)
        return np.asarray(result[what], dtype=float)
    if what == "pressure_bar":
        statistical = ask["kind"] == "statistical"
        return np.asarray(settle_in(rows)[what].mean() if statistical else rows[what][-1], dtype=float)
    if what == "mean_tension_kj_per_mol_nm":
        return np.asarray(settle_in(rows)["tensions_kj_per_mol_nm"].mean())
    if what == "mean":
        return np.asarray(mean(case, ask, rows))
    if what.startswith("temperature_"):
        return np.asarray(temperatures(case, rows)[what.split("_")[1]])
    return np.asarray(OF_ROWS[what](case, rows), dtype=float)
