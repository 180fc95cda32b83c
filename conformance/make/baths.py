#!/usr/bin/env python3
"""Writes cases/statistics: molecules without interactions in Langevin's bath, whose means are integrals."""

from __future__ import annotations

import math
from typing import Any, Dict, List, Tuple

import numpy as np
from scipy.integrate import quad

from mechanisms import row
from molecules import WATER, WATER_MASSES, all_pairs
from solve import BAR, BOLTZMANN, write

KELVIN = 300.0
KT = BOLTZMANN * KELVIN
EDGE = 4.0  # nm


def turned(rng: np.random.Generator, x: np.ndarray) -> np.ndarray:
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return x @ (q * np.sign(np.linalg.det(q))).T


def gas(shapes: List[np.ndarray], masses: List[float], pairs: List[Tuple[int, int]],
        boxed: bool) -> Tuple[Dict[str, Any], np.ndarray]:
    """Molecules in random directions on a lattice; one shape for each."""
    rng, size, side = np.random.default_rng(7), len(masses), math.ceil(len(shapes)**(1 / 3))
    places = EDGE / side * (0.5 + np.array([[n // side**2, n // side % side, n % side] for n in range(len(shapes))]))
    x = np.vstack([place + turned(rng, shape - shape.mean(0)) for place, shape in zip(places, shapes)])
    bonds = [{
        "atoms": [size * n + i, size * n + j], "length_nm": round(float(np.linalg.norm(shapes[0][j] - shapes[0][i])),
                                                                  12)
    } for n in range(len(shapes)) for i, j in pairs]
    made: Dict[str, Any] = {
        "masses_u": masses * len(shapes), "bonds": bonds, "forces": [],
        "molecules": [list(range(size * n, size * (n + 1))) for n in range(len(shapes))]
    }
    if boxed:
        made["box_nm"] = (EDGE * np.eye(3)).tolist()
    return made, x


def ask(what: str, right: float, tolerance: float, ground: str, seeds: int = 4, **more: Any) -> Dict[str, Any]:
    return {
        "what": what, "kind": "statistical", "right": right, "tolerance": float(f"{tolerance:.2g}"), "seeds": seeds,
        "ground": ground, "made_by": "make/baths.py", **more
    }


def case(name: str, words: str, made: Dict[str, Any], x: np.ndarray, asks: List[Dict[str, Any]], step: float = 0.004,
         steps: int = 5000, friction: float = 5) -> None:
    write(
        "statistics", {
            "name": name, "words": words, "system": made, "start": {"positions_nm": x, "temperature_k": KELVIN},
            "run": {
                "step_ps": step, "steps": steps, "rows_every": 25,
                "langevin": {"temperature_k": KELVIN, "friction_per_ps": friction}
            }, "asks": asks
        })
    print(f"{name:32} {[(one['what'], round(one['right'], 5)) for one in asks]}")


def temperatures(*kinds: str) -> List[Dict[str, Any]]:
    return [ask(f"temperature_{kind}_k", KELVIN, 5, "equipartition: kT/2 for each degree of freedom") for kind in kinds]


def ideal(molecules: int) -> Dict[str, Any]:
    right = molecules * KT / EDGE**3 * BAR
    return ask("pressure_bar", right, 0.02 * right, "P V = N kT of N molecules, not of atoms: the virial of the bonds")


def bend_mean(ends: Tuple[float, float], middle: float) -> float:
    """⟨cos²θ⟩ of a trimer with rigid bonds: p(cos θ) ∝ √det A, A = J M⁻¹ Jᵀ (doi:10.1073/pnas.71.8.3050)."""
    a, b = 1 / ends[0] + 1 / middle, 1 / ends[1] + 1 / middle

    def weight(c: float) -> float:
        return math.sqrt(a * b - (c / middle)**2)

    return quad(lambda c: c * c * weight(c), -1, 1)[0] / quad(weight, -1, 1)[0]


def trimers(count: int, rng: np.random.Generator) -> List[np.ndarray]:
    angles = np.arccos(rng.uniform(-0.99, 0.99, count))
    return [np.array([[0.2, 0, 0], [0, 0, 0], [0.2 * math.cos(a), 0.2 * math.sin(a), 0]]) for a in angles]


def anchored(count: int, offset: Any, mass: float) -> Tuple[Dict[str, Any], np.ndarray]:
    """Pairs of a frozen atom and one bound to it, the frozen ones at z = 0."""
    x = np.vstack([np.array([[0.5 * (n % 6), 0.5 * (n // 6), 0]] * 2) + [[0, 0, 0], offset] for n in range(count)])
    length = float(np.linalg.norm(offset))
    return {
        "masses_u": [0, mass] * count, "forces": [],
        "bonds": [{"atoms": [2 * n, 2 * n + 1], "length_nm": length} for n in range(count)]
    }, x


def log_weight_of_loops(length: float, bond: float) -> float:
    """ln Z of a loop of three equal atoms around a box of this length, Z = ∫ √det A over the bonds' directions.

    The first bond leaves the vector s to the other two, whose common circle has the density 1/|s|."""
    nodes, weights = np.polynomial.legendre.leggauss(100)
    lowest = max(-1.0, (length**2 - 3 * bond**2) / (2 * length * bond))  # |s| ≤ two bonds
    cosine = lowest + 0.5 * (1 - lowest) * (nodes + 1)
    angle = 2 * math.pi * (np.arange(100) + 0.5) / 100
    first = np.stack([cosine, np.sqrt(1 - cosine**2), 0 * cosine], axis=1)
    s = [length / bond, 0, 0] - first
    reach = np.linalg.norm(s, axis=1)
    along, up = s / reach[:, None], np.array([0.0, 0.0, 1.0])
    around = (np.cos(angle)[:, None] * np.cross(up, along)[:, None, :] + np.sin(angle)[:, None] * up)
    second = 0.5 * s[:, None, :] + np.sqrt(1 - reach**2 / 4)[:, None, None] * around
    third = s[:, None, :] - second
    a, b, c = ((one * other).sum(-1) for one, other in ((first[:, None, :], second), (second, third),
                                                        (third, first[:, None, :])))
    mean = np.sqrt(8 - 2 * (a * a + b * b + c * c) - 2 * a * b * c).mean(1)
    return math.log((1 - lowest) * float((weights * mean / reach).sum()))


def loops_around_the_box(count: int) -> Tuple[Dict[str, Any], np.ndarray]:
    rng, bond = np.random.default_rng(8), 0.4
    aside = (1 - bond) / 2  # the last bond lies along the box's edge
    loop = np.array([[0, 0, 0], [aside, math.sqrt(bond**2 - aside**2), 0], [1 - bond, 0, 0]])
    bonds = [{
        "atoms": [3 * n + i, 3 * n + (i + 1) % 3], "length_nm": bond, **({"image": [1, 0, 0]} if i == 2 else {})
    } for n in range(count) for i in range(3)]
    x = np.vstack([loop + rng.uniform(0, 1, 3) for _ in range(count)])
    return {"masses_u": [10] * 3 * count, "bonds": bonds, "box_nm": np.eye(3).tolist(), "forces": []}, x


def main() -> None:
    rng = np.random.default_rng(3)
    rod = np.array([[0, 0, 0], [0.2, 0, 0]])
    made, x = gas([rod] * 64, [10, 10], [(0, 1)], boxed=True)
    case("gas_of_dumbbells", "64 dumbbells without interactions in a bath of 300 K.", made, x,
         temperatures("translation", "rotation") + [ideal(64)])
    made, x = gas([rod] * 64, [1, 100], [(0, 1)], boxed=True)
    case("gas_of_unequal_dumbbells", "64 dumbbells of 1 and 100 u without interactions in a bath of 300 K.", made, x,
         temperatures("translation", "rotation") + [ideal(64)], step=0.002, steps=8000)
    made, x = gas([WATER] * 32, WATER_MASSES, list(all_pairs(3)), boxed=True)
    case("gas_of_waters", "32 rigid waters without interactions in a bath of 300 K.", made, x,
         temperatures("translation", "rotation") + [ideal(32)], step=0.002, steps=8000)
    cosine = ["square", ["cos_angle", 0, 1, 2]]
    made, x = gas(trimers(48, rng), [10] * 3, row(2), boxed=True)
    case(
        "gas_of_trimers", "48 trimers with two rigid bonds and a free angle in a bath of 300 K.", made, x,
        temperatures("translation", "rotation", "internal") + [ideal(48)] + [
            ask("mean", bend_mean(
                (10, 10), 10), 0.004, "p(cos θ) ∝ √(1 − cos²θ/4) of rigid bonds, by quadrature; springs have ⅓ "
                "(Fixman 1974)", seeds=8, of=cosine, each=3)
        ])
    made, x = gas(trimers(48, rng), [20, 2, 20], row(2), boxed=True)
    case(
        "gas_of_trimers_with_a_light_middle",
        "48 trimers whose middle atom is ten times lighter: rigid bonds shun the straight angle.", made, x,
        temperatures("translation", "rotation", "internal") + [
            ask("mean", bend_mean((20, 20), 2), 0.004,
                "p(cos θ) ∝ √det(J M⁻¹ Jᵀ), by quadrature; springs have ⅓ (Fixman 1974)", seeds=8, of=cosine, each=3)
        ], step=0.002, steps=10000)
    shapes = [np.array([[0.2 * i, 0.08 * (i % 2), 0] for i in range(5)])] * 27
    made, x = gas(shapes, [12] * 5, row(4), boxed=True)
    case("gas_of_chains", "27 chains of five without interactions in a bath of 300 K.", made, x,
         temperatures("translation", "rotation", "internal") + [ideal(27)])
    made, x = anchored(36, [0.2, 0, 0], 25)
    made["forces"] = [{"kind": "gravity", "acceleration_nm_per_ps2": [0, 0, -1]}]
    y = 25 * 1 * 0.2 / KT
    case("pendulums_in_a_bath", "36 pendulums in a bath of 300 K hang down by their weight.", made, x, [
        ask("mean", -0.2 * (1 / math.tanh(y) - 1 / y), 0.003, "−l (coth y − 1/y), y = m g l/kT (Langevin's function)",
            seeds=8, of=["z", 1], each=2)
    ])
    made, x = anchored(36, [0.2, 0, 0], 25)
    made["forces"] = [{"kind": "external", "atoms": list(range(1, 72, 2)), "energy_kj_per_mol": "200*z^2"}]

    def weight(z: float) -> float:
        return math.exp(-200 * z * z / KT)

    right = quad(lambda z: z * z * weight(z), -0.2, 0.2)[0] / quad(weight, -0.2, 0.2)[0]
    case("rods_in_a_field", "36 rods on frozen atoms, whose ends a field 200 z² keeps near the plane.", made, x, [
        ask("mean", right, 0.0002, "∫ z² exp(−U/kT) dz/∫ exp(−U/kT) dz over the sphere, by quadrature", seeds=8,
            of=["square", ["z", 1]], each=2)
    ])
    made, x = gas([rod] * 36, [10, 30], [(0, 1)], boxed=False)
    made["forces"] = [{
        "kind": "harmonic_position", "atom": 2 * n, "centre_nm": x[2 * n].round(6).tolist(), "k_kj_per_mol_nm2": 300
    } for n in range(36)]
    case("tethered_dumbbells", "36 dumbbells, each tethered by one atom with a spring, in a bath of 300 K.", made, x,
         temperatures("translation", "rotation"))
    made, x = gas([rod] * 64, [5, 9], [(0, 1)], boxed=False)
    case("mean_tension", "The mean tension of dumbbells in a bath of 300 K.", made, x,
         [ask("mean_tension_kj_per_mol_nm", 2 * KT / 0.2, 0.02 * 2 * KT / 0.2, "⟨μ v²⟩/d = 2kT/d of two rotations")])
    made["forces"] = [{
        "kind": "harmonic_bond", "atoms": [2 * n, 2 * n + 1], "length_nm": 0.25, "k_kj_per_mol_nm2": 1000
    } for n in range(64)]
    case("mean_tension_against_a_spring",
         "The mean tension of dumbbells whose atoms a spring pushes apart with F = 50.", made, x, [
             ask("mean_tension_kj_per_mol_nm", 2 * KT / 0.2 + 50, 0.02 * 2 * KT / 0.2,
                 "2kT/d of two rotations, and F of the spring")
         ])
    made, x = loops_around_the_box(64)
    slope = (log_weight_of_loops(1.0001, 0.4) - log_weight_of_loops(0.9999, 0.4)) / 0.0002
    right = 64 * KT / 3 * (3 + slope) * BAR
    case("loops_around_the_box", "64 loops of three atoms on bonds that close through the box, without other forces.",
         made, x, [ask("pressure_bar", right, 0.05 * abs(right),
                       "P V = kT (1 + ⅓ L d ln Z/dL) of a loop, Z = ∫ √det A over what its bonds allow, by quadrature")])


if __name__ == "__main__":
    main()
