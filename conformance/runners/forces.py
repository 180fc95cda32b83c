"""Energy and forces of a case by their formulas, for engines that ask their user for them."""

from __future__ import annotations

from typing import Any, Callable, Dict, List, Tuple

import numpy as np

Case = Dict[str, Any]
Array = np.ndarray
COULOMB = 138.935456  # kJ/mol nm/e²


def force_function(case: Case) -> Callable[[np.ndarray], Tuple[float, np.ndarray]]:
    """All but the bonds, as a function of positions. Each part adds to the forces, and returns its energy."""
    import sympy

    masses = np.array(case["system"]["masses_u"], dtype=float)
    parts: List[Tuple[str, Case, List[Any]]] = []
    for force in case["system"]["forces"]:
        if force["kind"] == "external":
            symbols = sympy.symbols("x y z")
            energy = sympy.sympify(force["energy_kj_per_mol"].replace("^", "**"))
            made = [sympy.lambdify(symbols, f) for f in (energy, *[-energy.diff(s) for s in symbols])]
            parts.append((force["kind"], force, made))
        else:
            parts.append((force["kind"], force, []))

    def evaluate(x: np.ndarray) -> Tuple[float, np.ndarray]:
        total, f = 0.0, np.zeros_like(x)
        for kind, force, made in parts:
            total += FORCES[kind](case, force, masses, x, f, made)
        return total, f

    return evaluate


def _gravity(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
    f += masses[:, None] * np.array(force["acceleration_nm_per_ps2"])
    return -float(masses @ x @ np.array(force["acceleration_nm_per_ps2"]))


def _constant(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
    f[force["atom"]] += force["force_kj_per_mol_nm"]
    return -float(x[force["atom"]] @ np.array(force["force_kj_per_mol_nm"]))


def _tether(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
    away = x[force["atom"]] - np.array(force["centre_nm"])
    f[force["atom"]] -= force["k_kj_per_mol_nm2"] * away
    return 0.5 * float(force["k_kj_per_mol_nm2"]) * float(away @ away)


def _bond(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
    i, j = force["atoms"]
    r = x[j] - x[i]
    d = np.linalg.norm(r)
    pull = force["k_kj_per_mol_nm2"] * (d - force["length_nm"]) * r / d
    f[i] += pull
    f[j] -= pull
    return 0.5 * float(force["k_kj_per_mol_nm2"]) * float(d - force["length_nm"]) ** 2


def _angle(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
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
    return float(0.5 * force["k_kj_per_mol_rad2"] * (theta - force["angle_rad"]) ** 2)


def _torsion(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
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
    return float(force["k_kj_per_mol"] * (1 + np.cos(n * phi - force["phase_rad"])))


def _external(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
    total = 0.0
    for atom in force["atoms"]:
        total += float(made[0](*x[atom]))
        f[atom] += [float(part(*x[atom])) for part in made[1:]]
    return total


def _nonbonded(case: Case, force: Case, masses: Array, x: Array, f: Array, made: List[Any]) -> float:
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
