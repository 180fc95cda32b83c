#!/usr/bin/env python3
"""Writes cases/forces and cases/pressure: tensions and pressures at rest, or in steady motion, by formulas."""

from __future__ import annotations

import math
from typing import Any, Dict, List, Optional

import numpy as np

from mechanisms import DOWN, G, row, system
from molecules import WATER, WATER_MASSES, all_pairs, kicks
from solve import BAR, System, constraint_virial, write

MADE_BY = "make/forces.py"


def case(name: str, words: str, made: Dict[str, Any], x: Any, v: Any, ask: Dict[str, Any], step: float = 0.001,
         steps: int = 20) -> Dict[str, Any]:
    start = {"positions_nm": np.array(x, dtype=float), "velocities_nm_per_ps": np.array(v, dtype=float)}
    return {
        "name": name, "words": words, "system": made, "start": start, "run": {"step_ps": step, "steps": steps},
        "asks": [{**ask, "made_by": MADE_BY}]
    }


def tension(name: str, words: str, made: Dict[str, Any], x: Any, v: Any, right: List[float], ground: str,
            step: float = 0.001, steps: int = 20, tolerance: Optional[float] = None) -> None:
    """Checks the formula against the solver at the start, and writes the case."""
    solved = System(made).tensions(np.array(x, dtype=float), np.array(v, dtype=float))
    assert np.abs(solved - right).max() < 1e-9 * max(1, np.abs(right).max()), f"{name}: {solved} is not {right}"
    size = max(float(np.abs(right).max()), 1.0)
    write(
        "forces",
        case(
            name, words, made, x, v, {
                "what": "tensions_kj_per_mol_nm", "kind": "exact", "right": right, "tolerance": tolerance
                or float(f"{2e-4 * size:.1g}"), "ground": ground
            }, step, steps))
    print(f"forces/{name:32} {np.round(right, 4)[:4]}")


def write_forces() -> None:
    rest = np.zeros
    pull = {"kind": "constant_force", "atom": 1, "force_kj_per_mol_nm": [10, 0, 0]}
    x = np.array([[0, 0, 0], [1.0, 0, 0]])
    turn = math.sqrt(2) / 2
    tension("pulled_turning_pair",
            "The pulled pair turns as well, at a relative 1.414 nm/ps: the bond also carries ½·v²/d = 1.",
            system([1, 1], [(0, 1)], x, pull), x, [[0, -turn, 0], [0, turn, 0]], [6],
            "5 of the pull, and μ|v₁ − v₀|²/d with μ = ½ u", step=1e-4, steps=1)
    n, m = 10, 72
    x = np.array([[0, -0.3 * i, 0] for i in range(n + 1)])
    tension("hanging_chain", "A chain of ten atoms of 72 u hangs at rest from a frozen one.",
            system([0] + [m] * n, row(n), x, DOWN), x, rest(x.shape), [m * G * (n - i) for i in range(n)],
            "each bond bears the weight below it")
    masses = [1, 50, 3, 200, 0.5]
    x = np.array([[0, -0.2 * i, 0] for i in range(6)])
    tension("hanging_unequal_masses", "Five atoms from 0.5 to 200 u hang below each other at rest.",
            system([0] + masses, row(5), x, DOWN), x, rest(x.shape), [G * sum(masses[i:]) for i in range(5)],
            "each bond bears the weight below it")
    for name, sign, words in (("bridge", -1,
                               "A mass hangs between two frozen atoms on two bonds, at 30 degrees to the level."),
                              ("arch", 1, "A mass stands on two bars with frozen feet: the bars are pressed.")):
        x = np.array([[-math.cos(math.pi / 6), 0, 0], [0, 0.5 * sign, 0], [math.cos(math.pi / 6), 0, 0]])
        tension(name, words, system([0, 7, 0], row(2), x, DOWN), x, rest(x.shape), [-sign * 7 * G] * 2,
                "2 T sin 30° = m g")
    n, radius, omega = 8, 0.4, 5.0
    a = 2 * math.pi * np.arange(n) / n
    x = radius * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
    v = omega * radius * np.stack([-np.sin(a), np.cos(a), 0 * a], axis=1)
    tension("spinning_ring", "A ring of eight atoms turns about its axis.",
            system([10] * n, [(i, (i + 1) % n) for i in range(n)], x), x, v,
            [10 * omega**2 * radius / (2 * math.sin(math.pi / n))] * n, "2 T sin(π/n) = m ω² R")
    a = 2 * math.pi * np.arange(3) / 3
    x = 0.2 / math.sqrt(3) * np.stack([np.cos(a), np.sin(a), 0 * a], axis=1)
    v = omega * np.cross([0, 0, 1], x)
    tension("spinning_triangle", "A rigid triangle of equal atoms turns in its plane.",
            system([12] * 3, all_pairs(3), x), x, v, [12 * omega**2 * 0.2 / 3] * 3, "2 T cos 30° = m ω² d/√3")
    x = np.array([[-0.15, 0, 0], [0, 0, 0], [0.15, 0, 0]])
    tension("spinning_rod", "Three atoms in a line turn about the middle one.", system([4, 9, 4], row(2), x), x,
            omega * np.cross([0, 0, 1], x), [4 * omega**2 * 0.15] * 2, "T = m ω² d")
    x = np.array([[0, 0, 0], [0, -0.5, 0]])
    tension("pendulum_at_its_lowest", "A pendulum that fell from the horizontal passes its lowest point.",
            system([0, 2], [(0, 1)], x, DOWN), x, [[0, 0, 0], [math.sqrt(G), 0, 0]], [3 * 2 * G],
            "m g + m v²/l with v² = 2 g l: three times the weight", step=1e-4, steps=1)
    x = np.array([[0.1 * i, 0.05 * (i % 2), 0] for i in range(8)])
    tension("falling_chain", "A zigzag chain falls freely: no bond pulls.", system([14] * 8, row(7), x, DOWN), x,
            rest(x.shape), [0.0] * 7, "all atoms fall alike, with the acceleration of gravity")
    masses = [3, 10, 1, 30, 6]
    x = np.array([[0.2 * i, 0, 0] for i in range(5)])
    pull = {"kind": "constant_force", "atom": 4, "force_kj_per_mol_nm": [100, 0, 0]}
    tension("towed_chain", "A straight chain of unequal masses is towed at its end with 100 kJ/mol/nm.",
            system(masses, row(4), x, pull), x, rest(x.shape), [100 * sum(masses[:i + 1]) / 50 for i in range(4)],
            "each bond moves the masses behind it with the acceleration of the whole")
    push = {"kind": "harmonic_bond", "atoms": [0, 1], "length_nm": 0.3, "k_kj_per_mol_nm2": 1000}
    x = np.array([[0, 0, 0], [0.2, 0, 0]])
    tension("spring_along_a_bond", "A spring between the two atoms of a bond pushes them apart with 100.",
            system([5, 9], [(0, 1)], x, push), x, rest(x.shape), [100],
            "T = F: the bond keeps the spring from moving them")


def pressure(name: str, words: str, made: Dict[str, Any], x: Any, v: Any, right: float, ground: str, step: float = 1e-4,
             steps: int = 1) -> None:
    """Checks against 2K + Σ x·F + Σ r·C of the solver, and writes the case."""
    solver, at, rate = System(made), np.array(x, dtype=float), np.array(v, dtype=float)
    volume = float(np.linalg.det(solver.box))
    atoms = np.einsum("a,ai,ai->", solver.mass, rate, rate) + constraint_virial(solver, at, rate) + pair_virial(
        made, at)
    assert abs(atoms * BAR / 3 / volume -
               right) < 1e-5 * max(abs(right), 1), f"{name}: {atoms * BAR / 3 / volume} is not {right}"
    write(
        "pressure",
        case(
            name, words, made, at, rate, {
                "what": "pressure_bar", "kind": "exact", "right": right,
                "tolerance": float(f"{max(1e-3 * abs(right), 0.05):.1g}"), "ground": ground
            }, step, steps))
    print(f"pressure/{name:32} {right:.4f} bar")


def pair_virial(made: Dict[str, Any], x: np.ndarray) -> float:
    """Σ r·F of the pairs as −dU/ds of all atoms and the box scaled by 1 + s, by a central difference."""
    if not made["forces"]:
        return 0.0

    def energy(s: float) -> float:
        scaled = System({**made, "box_nm": (np.array(made["box_nm"]) * (1 + s)).tolist()})
        return scaled.forces(scaled.place_sites(x) * (1 + s))[0]

    return -(energy(1e-5) - energy(-1e-5)) / 2e-5


def write_pressures() -> None:
    cube = (3 * np.eye(3)).tolist()
    tilted = [[3, 0, 0], [1, 2.5, 0], [-0.8, 0.9, 2]]
    x = np.array([[1, 1, 1], [1.2, 1, 1]])
    flow = np.array([0.5, -0.3, 0.8])
    v = flow + np.array([[0, -3, 0], [0, 1, 0]])  # of 2 and 6 u
    for name, box, volume in (("dumbbell", cube, 27), ("dumbbell_in_a_triclinic_box", tilted, 15)):
        pressure(
            f"turning_{name}",
            "A dumbbell turns and flies: its turning adds nothing to the pressure, since the bond's virial "
            "is minus twice its kinetic energy.", {**system([2, 6], [(0, 1)], x), "box_nm": box}, x, v,
            BAR * 8 * float(flow @ flow) / 3 / volume, "P = M V²/(3 volume), of the centre's velocity V", 0.001, 20)
    x = np.array([[0.2, 1, 1], [2.0, 1, 1]])
    pressure("turning_dumbbell_over_half_a_box",
             "A dumbbell of 1.8 nm in a box of 3 nm, as its positions have it, turns and flies.",
             {**system([2, 6], [(0, 1)], x), "box_nm": cube}, x, v, BAR * 8 * float(flow @ flow) / 3 / 27,
             "P = M V²/(3 volume), of the centre's velocity V", 0.001, 20)
    x = WATER + 1
    made = {**system(WATER_MASSES, list(all_pairs(3)), x), "box_nm": cube}
    spin = np.cross([4, -7, 9], x - np.array(WATER_MASSES) @ x / sum(WATER_MASSES)) + flow
    pressure("turning_water", "A rigid water turns about a skew axis and flies.", made, x, spin,
             BAR * sum(WATER_MASSES) * float(flow @ flow) / 3 / 27, "P = M V²/(3 volume), of the centre's velocity V")
    x = np.array([[0.15 * i, 0.06 * (i % 2), 0.05 * (i > 2)] for i in range(5)]) + 1
    made = {**system([3, 10, 5, 7, 2], row(4), x), "box_nm": cube}
    solver = System(made)
    x, v = solver.project(x, kicks(31, x))
    kinetic = np.einsum("a,ai,ai->", solver.mass, v, v)
    pressure("kicked_chain", "A chain of five that bends and turns.", made, x, v,
             BAR * (kinetic - float(solver.tensions(x, v) @ solver.length)) / 81,
             "(2 E_kin − Σ T d)/(3V), T of (J M⁻¹ Jᵀ) λ = −|ṙ|² and T = −λ d")
    x = np.array([[0, 0, 0], [0.33, 0.2, 0], [0.67, -0.05, 0.1]])
    made = {**system([10, 11, 12], row(2), x), "box_nm": np.eye(3).tolist()}
    made["bonds"].append(
        {"atoms": [2, 0], "length_nm": float(np.linalg.norm(x[0] + [1, 0, 0] - x[2])), "image": [1, 0, 0]})
    solver = System(made)
    x, v = solver.project(x, kicks(32, x, 2))
    kinetic = np.einsum("a,ai,ai->", solver.mass, v, v)
    pressure(
        "loop_through_the_box",
        "Three atoms on bonds that close through the box, moving: every bond counts with the image that it "
        "goes to.", made, x, v,
        BAR * (kinetic - float(solver.tensions(x, v) @ solver.length)) / 3,
        "(2 E_kin − Σ T d)/(3V), T of (J M⁻¹ Jᵀ) λ = −|ṙ|² and T = −λ d")
    write_pressures_of_pairs()


def by_scaling(made: Dict[str, Any], x: np.ndarray, size: int) -> float:
    """−dU/dV in bar, with the box and the centres of molecules of `size` atoms scaled, not their shape."""
    masses = np.array(made["masses_u"], dtype=float).reshape(-1, size)
    groups = x.reshape(-1, size, 3)
    centres = np.einsum("ga,gai->gi", masses, groups) / masses.sum(1)[:, None]

    def energy(s: float) -> float:
        scaled = System({**made, "box_nm": (np.array(made["box_nm"]) * (1 + s)).tolist()})
        return scaled.forces((groups + s * centres[:, None]).reshape(-1, 3))[0]

    volume = float(np.linalg.det(np.array(made["box_nm"])))
    return -BAR * (energy(1e-5) - energy(-1e-5)) / 2e-5 / 3 / volume


def write_pressures_of_pairs() -> None:
    ground = "−dU/dV by a central difference: box and centres of molecules scaled by 1 ± 1e-5, their shapes kept"
    box = [[1.3, 0, 0], [0.3, 1.25, 0], [-0.2, 0.35, 1.2]]
    x = np.array([[0.05, 0.1, 0.5], [0.05, 0.24, 0.5], [1.12, 0.12, 0.55], [1.12, 0.02, 0.65]])
    force = {
        "kind": "nonbonded", "sigma_nm": [0.3] * 4, "epsilon_kj_per_mol": [0.5] * 4,
        "charges_e": [0.3, -0.3, -0.3, 0.3], "excluded": [[0, 1], [2, 3]], "cutoff_nm": 0.55, "solvent_dielectric": 78.3
    }
    made = {**system([10, 3, 10, 3], [(0, 1), (2, 3)], x, force), "box_nm": box}
    pressure("dumbbells_at_rest",
             "Two dumbbells at rest across the face of a triclinic box, with Lennard-Jones and charges.", made, x,
             0 * x, by_scaling(made, x, 2), ground)
    x = np.vstack([WATER, WATER + [0.1, -0.29, 0.05]]) + 0.5
    made = waters_in(1.4, x, {})
    pressure("waters_at_rest", "Two rigid waters at rest, with Lennard-Jones and a reaction field.", made, x, 0 * x,
             by_scaling(made, x, 3), ground)
    w = 0.13194
    four = np.vstack(
        [np.vstack([water, (1 - 2 * w) * water[0] + w * (water[1] + water[2])]) for water in (x[:3], x[3:])])
    made = waters_in(1.4, four, {"weights": [1 - 2 * w, w, w]})
    pressure(
        "waters_with_sites_at_rest",
        "Two four-site waters at rest, whose negative charge is on a virtual site: its force is its "
        "parents', and so is its virial.", made, four, 0 * four, by_scaling(made, four, 4), ground)


def waters_in(edge: float, x: np.ndarray, site: Dict[str, Any]) -> Dict[str, Any]:
    size = 4 if site else 3
    firsts = range(0, len(x), size)
    pairs = [(a + i, a + j) for a in firsts for i, j in all_pairs(3)]
    charges = [0, 0.52, 0.52, -1.04] if site else [-0.834, 0.417, 0.417]
    extra = [0] * (size - 3)
    force = {
        "kind": "nonbonded", "sigma_nm": ([0.315, 0.1, 0.1] + [0.1] * len(extra)) * 2,
        "epsilon_kj_per_mol": ([0.6364, 0, 0] + extra) * 2, "charges_e": charges * 2,
        "excluded": [[a + i, a + j] for a in firsts
                     for i, j in all_pairs(size)], "cutoff_nm": 0.65, "solvent_dielectric": 78.3
    }
    made = {**system((WATER_MASSES + extra) * 2, pairs, x, force), "box_nm": (edge * np.eye(3)).tolist()}
    if site:
        made["virtual_sites"] = [{"atom": a + 3, "of": [a, a + 1, a + 2], **site} for a in firsts]
    return made


if __name__ == "__main__":
    write_forces()
    write_pressures()
