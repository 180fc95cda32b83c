"""What runners of several engines share: rows, forces by formula, and the clusters that bonds make of atoms."""

from __future__ import annotations

from collections import defaultdict
from typing import Any, Callable, Dict, List, Tuple

import numpy as np

Case = Dict[str, Any]
BOLTZMANN = 0.00831446261815324  # kJ/mol/K
BAR = 16.6053906717  # bar in a kJ/mol/nm³
COULOMB = 138.935456  # kJ/mol nm/e²


class EngineStopped(Exception):
    """The engine broke off a run that it ought to make."""


def not_offered(why: str) -> Case:
    return {"offered": False, "why": why}


def wants_refusal(case: Case) -> bool:
    return any(ask["kind"] == "refused" for ask in case["asks"])


def row_steps(case: Case) -> List[int]:
    """The steps after which a row is asked for: the start, every rows_every, the end."""
    steps = case["run"]["steps"]
    return sorted({*range(0, steps + 1, case["run"].get("rows_every", steps) or 1), steps})


def moving(case: Case) -> np.ndarray:
    return np.array(case["system"]["masses_u"], dtype=float) > 0


def fill_sites(case: Case, velocities: np.ndarray) -> np.ndarray:
    """Gives virtual sites the velocity of the mean that they are, for engines that have none for them."""
    for site in case["system"].get("virtual_sites", []):
        velocities[site["atom"]] = np.array(site["weights"]) @ velocities[site["of"]]
    return velocities


def whole(case: Case) -> np.ndarray:
    """The box vectors to add to each atom so that bonds go to no image; ValueError if a cluster spans the box."""
    count = len(case["system"]["masses_u"])
    shift, seen = np.zeros((count, 3)), set()
    box = np.array(case["system"].get("box_nm", np.zeros((3, 3))), dtype=float)
    bonds = [(*bond["atoms"], np.array(bond.get("image", [0, 0, 0]), dtype=float)) for bond in case["system"]["bonds"]]
    for first in range(count):
        open_ends = [first] if first not in seen else []
        while open_ends:
            at = open_ends.pop()
            seen.add(at)
            for i, j, image in bonds:
                for a, b, step in ((i, j, image), (j, i, -image)):
                    if a == at and b not in seen:
                        shift[b] = shift[a] + step
                        seen.add(b)
                        open_ends.append(b)
    if any(not np.array_equal(shift[j], shift[i] + image) for i, j, image in bonds):
        raise ValueError("a molecule that goes through the box to its own image")
    return shift @ box


def clusters(case: Case) -> List[List[int]]:
    """The atoms that bonds join, each cluster sorted; atoms without bonds are none."""
    neighbours: Dict[int, set] = defaultdict(set)
    for bond in case["system"]["bonds"]:
        i, j = bond["atoms"]
        neighbours[i].add(j)
        neighbours[j].add(i)
    found, seen = [], set()
    for atom in sorted(neighbours):
        if atom in seen:
            continue
        reached, open_ends = {atom}, [atom]
        while open_ends:
            new = neighbours[open_ends.pop()] - reached
            reached |= new
            open_ends += new
        seen |= reached
        found.append(sorted(reached))
    return found


def gradients(case: Case, x: np.ndarray) -> np.ndarray:
    """The unit vectors along bonds as a matrix, bonds by 3·atoms: the gradient of each length."""
    made = np.zeros((len(case["system"]["bonds"]), len(x), 3))
    box = np.array(case["system"].get("box_nm", np.zeros((3, 3))), dtype=float)
    for row, bond in zip(made, case["system"]["bonds"]):
        i, j = bond["atoms"]
        r = x[j] - x[i] + np.array(bond.get("image", [0, 0, 0])) @ box
        row[j] = r / np.linalg.norm(r)
        row[i] = -row[j]
    return made.reshape(len(made), -1)


def is_rigid(case: Case, atoms: List[int]) -> bool:
    """Whether the bonds leave a cluster only the freedoms of a rigid body."""
    x = np.array(case["start"]["positions_nm"], dtype=float)
    held = [k for k, bond in enumerate(case["system"]["bonds"]) if set(bond["atoms"]) <= set(atoms)]
    free = 3 * len(atoms) - np.linalg.matrix_rank(gradients(case, x)[held], tol=1e-9)
    return bool(free == (5 if len(atoms) == 2 else 6))


def tensions_from(case: Case, x: np.ndarray, constraint_forces: np.ndarray) -> np.ndarray:
    """The tensions whose sum over the bonds is the force of constraint on each atom (least squares)."""
    return -np.linalg.lstsq(gradients(case, x).T, constraint_forces.ravel(), rcond=None)[0]


def start_velocities(case: Case) -> np.ndarray:
    """Those of the case; or drawn by its seed from Maxwell's distribution, and brought along no bond by M⁻¹Jᵀ."""
    if "velocities_nm_per_ps" in case["start"]:
        return np.array(case["start"]["velocities_nm_per_ps"], dtype=float)
    x, masses = (np.array(values, dtype=float) for values in
                 (case["start"]["positions_nm"], case["system"]["masses_u"]))
    inverse = np.repeat(np.where(masses > 0, 1 / np.where(masses > 0, masses, 1), 0), 3)
    draws = np.random.default_rng(case["run"].get("seed", 1)).normal(size=x.size)
    v = draws * np.sqrt(BOLTZMANN * case["start"]["temperature_k"] * inverse)
    jacobian = gradients(case, x)
    v -= inverse * (jacobian.T @ np.linalg.lstsq(jacobian * inverse @ jacobian.T, jacobian @ v, rcond=None)[0])
    return v.reshape(x.shape)


def force_function(case: Case) -> Callable[[np.ndarray], Tuple[float, np.ndarray]]:
    """Energy and forces of all but the bonds, for engines that ask their user for them."""
    import sympy

    masses = np.array(case["system"]["masses_u"], dtype=float)
    parts = []
    for force in case["system"]["forces"]:
        if force["kind"] == "external":
            symbols = sympy.symbols("x y z")
            energy = sympy.sympify(force["energy_kj_per_mol"].replace("^", "**"))
            made = [sympy.lambdify(symbols, f) for f in (energy, *[-energy.diff(s) for s in symbols])]
            parts.append((force["kind"], force, made))
        else:
            parts.append((force["kind"], force, None))

    def evaluate(x: np.ndarray) -> Tuple[float, np.ndarray]:
        total, f = 0.0, np.zeros_like(x)
        for kind, force, made in parts:
            total += FORCES[kind](case, force, masses, x, f, made)
        return total, f

    return evaluate


def _gravity(case, force, masses, x, f, made):
    f += masses[:, None] * np.array(force["acceleration_nm_per_ps2"])
    return -float(masses @ x @ np.array(force["acceleration_nm_per_ps2"]))


def _constant(case, force, masses, x, f, made):
    f[force["atom"]] += force["force_kj_per_mol_nm"]
    return -float(x[force["atom"]] @ np.array(force["force_kj_per_mol_nm"]))


def _tether(case, force, masses, x, f, made):
    away = x[force["atom"]] - np.array(force["centre_nm"])
    f[force["atom"]] -= force["k_kj_per_mol_nm2"] * away
    return 0.5 * force["k_kj_per_mol_nm2"] * float(away @ away)


def _bond(case, force, masses, x, f, made):
    i, j = force["atoms"]
    r = x[j] - x[i]
    d = np.linalg.norm(r)
    pull = force["k_kj_per_mol_nm2"] * (d - force["length_nm"]) * r / d
    f[i] += pull
    f[j] -= pull
    return 0.5 * force["k_kj_per_mol_nm2"] * float(d - force["length_nm"]) ** 2


def _angle(case, force, masses, x, f, made):
    i, j, k = force["atoms"]
    a, b = x[i] - x[j], x[k] - x[j]
    la, lb = np.linalg.norm(a), np.linalg.norm(b)
    cosine = float(np.clip(a @ b / la / lb, -1, 1))
    theta = np.arccos(cosine)
    slope = force["k_kj_per_mol_rad2"] * (theta - force["angle_rad"]) / max(np.sqrt(1 - cosine**2), 1e-12)
    fi, fk = slope * (b / lb - cosine * a / la) / la, slope * (a / la - cosine * b / lb) / lb
    f[i] += fi
    f[k] += fk
    f[j] -= fi + fk
    return 0.5 * force["k_kj_per_mol_rad2"] * (theta - force["angle_rad"]) ** 2


def _torsion(case, force, masses, x, f, made):
    i, j, k, l = force["atoms"]
    b1, b2, b3 = x[j] - x[i], x[k] - x[j], x[l] - x[k]
    n1, n2, length = np.cross(b1, b2), np.cross(b2, b3), np.linalg.norm(b2)
    phi = np.arctan2(length * b1 @ n2, n1 @ n2)
    n = force["periodicity"]
    slope = -n * force["k_kj_per_mol"] * np.sin(n * phi - force["phase_rad"])
    fi, fl = slope * length / (n1 @ n1) * n1, -slope * length / (n2 @ n2) * n2
    s = b1 @ b2 / length**2 * fi - b3 @ b2 / length**2 * fl
    f[i] += fi
    f[l] += fl
    f[j] += -fi - s
    f[k] += -fl + s
    return force["k_kj_per_mol"] * (1 + np.cos(n * phi - force["phase_rad"]))


def _external(case, force, masses, x, f, made):
    total = 0.0
    for atom in force["atoms"]:
        total += float(made[0](*x[atom]))
        f[atom] += [float(part(*x[atom])) for part in made[1:]]
    return total


def _nonbonded(case, force, masses, x, f, made):
    sigma, epsilon, charge = (np.array(force[key]) for key in ("sigma_nm", "epsilon_kj_per_mol", "charges_e"))
    i, j = np.triu_indices(len(x), 1)
    if force["excluded"]:
        out = {tuple(sorted(pair)) for pair in force["excluded"]}
        kept = np.array([(a, b) not in out for a, b in zip(i, j)])
        i, j = i[kept], j[kept]
    r = x[j] - x[i]
    for row in reversed(case["system"].get("box_nm", [])) if "cutoff_nm" in force else []:
        row, axis = np.array(row), int(np.nonzero(row)[0][-1])
        r -= np.round(r[:, axis] / row[axis])[:, None] * row
    d2, krf, crf = (r**2).sum(1), 0.0, 0.0
    if "cutoff_nm" in force:
        cut, eps = force["cutoff_nm"], force.get("solvent_dielectric", 78.3)
        krf, crf = (eps - 1) / (2 * eps + 1) / cut**3, 3 * eps / (2 * eps + 1) / cut
        near = d2 < cut**2
        i, j, r, d2 = i[near], j[near], r[near], d2[near]
    s6 = ((0.5 * (sigma[i] + sigma[j])) ** 2 / d2) ** 3
    e, q, d = np.sqrt(epsilon[i] * epsilon[j]), COULOMB * charge[i] * charge[j], np.sqrt(d2)
    pull = -(24 * e * (2 * s6**2 - s6) / d2 + q * (1 / d / d2 - 2 * krf))
    np.add.at(f, i, pull[:, None] * r)
    np.add.at(f, j, -pull[:, None] * r)
    return float((4 * e * (s6**2 - s6) + q * (1 / d + krf * d2 - crf)).sum())


FORCES = {"gravity": _gravity, "constant_force": _constant, "harmonic_position": _tether, "harmonic_bond": _bond,
          "harmonic_angle": _angle, "periodic_torsion": _torsion, "external": _external, "nonbonded": _nonbonded}


def nearest_images(case: Case) -> bool:
    """Whether every bond goes to that image of its second atom which is nearest to the first."""
    if "box_nm" not in case["system"]:
        return True
    box, x = np.array(case["system"]["box_nm"]), np.array(case["start"]["positions_nm"], dtype=float)
    around = np.array(list(np.ndindex(3, 3, 3))) - 1
    for bond in case["system"]["bonds"]:
        i, j = bond["atoms"]
        r = x[j] - x[i] + np.array(bond.get("image", [0, 0, 0])) @ box
        if np.linalg.norm(r + around @ box, axis=1).min() < 0.999 * np.linalg.norm(r):
            return False
    return True


def unwrap(case: Case, frames: List[np.ndarray]) -> np.ndarray:
    """Frames without jumps by box vectors, from the case's start on."""
    made = np.array(frames)
    if "box_nm" in case["system"]:
        box, before = np.array(case["system"]["box_nm"], dtype=float), np.array(case["start"]["positions_nm"], float)
        for x in made:
            for axis in (2, 1, 0):
                x -= np.round((x - before)[:, axis] / box[axis, axis])[:, None] * box[axis]
            before = x
    return made
