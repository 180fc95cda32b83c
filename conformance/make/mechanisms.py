"""Pendulums, linkages, rotors and hanging chains, each a function that says what motion.py solves."""

from __future__ import annotations

import math
from typing import Any, Dict, List, Sequence, Tuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.special import ellipj, ellipk

from solve import bonds_of

G = 9.81  # nm/ps²
DOWN = {"kind": "gravity", "acceleration_nm_per_ps2": [0, -G, 0]}
Motion = Dict[str, Any]


def system(masses: Sequence[float], pairs: List[Tuple[int, int]], x: np.ndarray, *forces: Dict[str, Any]) -> Dict[str, Any]:
    return {"masses_u": list(masses), "bonds": bonds_of(pairs, x), "forces": list(forces)}


def row(*bonds: int) -> List[Tuple[int, int]]:
    return [(i, i + 1) for i in range(*bonds)]


def swing(time: float) -> Tuple[np.ndarray, np.ndarray]:
    """A pendulum of 1 nm let go from the horizontal: sin(θ/2) = k cd(ω₀t, k²), k = sin 45° (DLMF 22.19.5)."""
    m, rate = 0.5, math.sqrt(G)
    sn, cn, dn, _ = ellipj(rate * time, m)
    half = math.sqrt(m) * cn / dn
    theta = 2 * math.asin(half)
    omega = -2 * math.sqrt(m) * rate * (1 - m) * sn / dn**2 / math.sqrt(1 - half**2)
    return (np.array([[0, 0, 0], [math.sin(theta), -math.cos(theta),
                                  0]]), np.array([[0, 0, 0], [omega * math.cos(theta), omega * math.sin(theta), 0]]))


def let_go(time: float, steps: int, words: str) -> Motion:
    x = np.array([[0, 0, 0], [1.0, 0, 0]])
    return {
        "words": words, "system": system([0, 1], [(0, 1)], x, DOWN), "x": x, "v": 0 * x, "step": time / steps,
        "steps": steps, "exact": swing(time), "ground": "sin(θ/2) = k cd(√(g/l) t, k²), k = sin 45° (DLMF 22.19.5)"
    }


def pendulum() -> Motion:
    return {
        **let_go(0.5, 250, "A point mass on a rigid bond to a fixed atom, let go from the horizontal."),
        "tensions": True
    }


def pendulum_period() -> Motion:
    return let_go(4 * float(ellipk(0.5)) / math.sqrt(G), 1000,
                  "A pendulum let go from the horizontal is back there after 4 K √(l/g) = 2.3678 ps, at rest.")


def conical_pendulum() -> Motion:
    tilt, length, time = math.radians(40), 0.5, 0.6
    omega, radius = math.sqrt(G / length / math.cos(tilt)), length * math.sin(tilt)

    def at(t: float) -> Tuple[np.ndarray, np.ndarray]:
        c, s = math.cos(omega * t), math.sin(omega * t)
        return (np.array([[0, 0, 0], [radius * c, -length * math.cos(tilt),
                                      radius * s]]), np.array([[0, 0, 0], [-radius * omega * s, 0,
                                                                           radius * omega * c]]))

    x, v = at(0)
    return {
        "words": "A pendulum goes round in a circle at a constant angle of 40°.", "x": x, "v": v,
        "system": system([0, 2], [(0, 1)], x, DOWN), "step": 0.002, "steps": 300, "exact": at(time), "tensions": True,
        "ground": "ω² = g/(l cos 40°)"
    }


def double_pendulum() -> Motion:
    x = np.array([[0, 0, 0], [0.6, 0, 0], [0.6, 0.5, 0]])
    return {
        "words": "Two unequal masses hang one below the other and are let go from the side, the lower one upright.",
        "system": system([0, 2, 1], row(2), x, DOWN), "x": x, "v": 0 * x, "step": 0.001, "steps": 500, "tensions": True
    }


def rotor(x: Any, v: Any, masses: List[float], step: float, steps: int, words: str, box: Any = None) -> Motion:
    x, v, m = np.array(x, dtype=float), np.array(v, dtype=float), np.array(masses)
    centre, flow = m @ x / m.sum(), m @ v / m.sum()
    r, u = x - centre, v - flow
    omega, t = np.linalg.norm(u[1] - u[0]) / np.linalg.norm(x[1] - x[0]), step * steps
    c, s = math.cos(omega * t), math.sin(omega * t)
    exact = (centre + flow * t + r * c + u / omega * s, flow - r * omega * s + u * c)
    made = system(masses, [(0, 1)], x)
    if box is not None:
        made["box_nm"] = box
    return {
        "words": words, "system": made, "x": x, "v": v, "step": step, "steps": steps, "exact": exact,
        "ground": "x = X + V t + r cos ωt + (u/ω) sin ωt, ω = |v₁ − v₀|/d", "tensions": True
    }


def free_rotor() -> Motion:
    return rotor([[-0.15, 0, 0], [0.05, 0, 0]], [[0.5, -1.5, 0], [0.5, 0.5, 0]], [1, 3], 0.002, 100,
                 "Two atoms of 1 and 3 u on a bond turn about their centre of mass, which moves.")


def fast_rotor() -> Motion:
    return rotor([[-0.05, 0, 0], [0.05, 0, 0]], [[0, -2.5, 1], [0, 2.5, -1]], [1, 1], 0.004, 50,
                 "A light rotor turns by 12 degrees in a step: a bond is long way from where the step's start has it.")


def rotor_of_unequal_masses() -> Motion:
    return rotor([[0, 0, 0], [0.1, 0, 0]], [[0, 0, 0], [0, 2, 0]], [1e4, 0.01], 0.002, 200,
                 "An atom of 0.01 u turns about one of 10 000 u, a million times heavier.")


def rotor_far_away() -> Motion:
    far = np.array([1000.0, -1000, 500])
    return rotor(
        np.array([[-0.05, 0, 0], [0.05, 0, 0]]) + far, [[0.3, -1, 0], [0.3, 1, 0]], [12, 12], 0.002, 100,
        "A rotor 1000 nm from the origin, as an atom that has diffused for long: bonds want double precision.")


def bond_over_half_a_box() -> Motion:
    return rotor(
        [[0.2, 0.5, 0.5], [0.8, 0.5, 0.5]], [[0, -1, 0.5], [0, 1, -0.5]], [2, 2], 0.002, 200,
        "A bond of 0.6 nm in a box of 1 nm, between the atoms as they stand: nearest images would be 0.4 nm apart.",
        box=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])


def bond_through_the_box() -> Motion:
    """The second atom's image one box on is the one that is bound; positions are as the file has them."""
    made = rotor([[0.9, 0.5, 0.5], [1.1, 0.5, 0.5]], [[0.1, -1, 0], [0.1, 1, 0]], [2, 2], 0.002, 200,
                 "A bond to the next image of an atom that stands at the box's other side, in a triclinic box.",
                 box=[[1, 0, 0], [0.3, 1, 0], [-0.2, 0.4, 1]])
    made["system"]["bonds"][0]["image"] = [1, 0, 0]
    for vectors in (made["x"], made["exact"][0]):
        vectors[1] -= [1, 0, 0]
    return made


def crank_angle(time: float) -> Tuple[float, float]:
    """θ'' = −g cos θ from (π/2, −1/ps)."""
    solved = solve_ivp(lambda _, y: [y[1], -G * math.cos(y[0])], (0, time), [math.pi / 2, -1], "DOP853", rtol=1e-13,
                       atol=1e-14)
    return float(solved.y[0, -1]), float(solved.y[1, -1])


def on_cranks(feet: np.ndarray, plate: List[Tuple[int, int]], masses: List[float], time: float, words: str) -> Motion:
    """A plate on parallel cranks of 1 nm: all turn as one pendulum."""
    n = len(feet)

    def at(theta: float, omega: float) -> Tuple[np.ndarray, np.ndarray]:
        crank = np.array([math.cos(theta), math.sin(theta), 0])
        turn = omega * np.array([-math.sin(theta), math.cos(theta), 0])
        return np.vstack([feet, feet + crank]), np.vstack([0 * feet, 0 * feet + turn])

    x, v = at(math.pi / 2, -1)
    pairs = [(i, i + n) for i in range(n)] + [(i + n, j + n) for i, j in plate]
    return {
        "words": words, "system": system([0] * n + masses, pairs, x, DOWN), "x": x, "v": v, "step": 0.001,
        "steps": round(time / 0.001), "exact": at(*crank_angle(time)),
        "ground": "θ'' = −g cos θ of the common angle of the cranks, by DOP853 to 1e-13"
    }


def linkage_before_its_dead_point() -> Motion:
    return on_cranks(np.array([[0, 0, 0], [1.0, 0, 0]]), [(0, 1)], [1, 1], 0.5,
                     "A bar on two parallel cranks falls over, up to shortly before all bars lie in a line.")


def linkage_through_its_dead_point() -> Motion:
    return on_cranks(
        np.array([[0, 0, 0], [1.0, 0, 0]]), [(0, 1)], [1, 1], 1.0,
        "A bar on two parallel cranks falls through the point where all bars lie in a line: there one bond "
        "follows from the others to first order. The cranks go on in parallel, carried by the inertia.")


def plate_on_three_cranks() -> Motion:
    return on_cranks(
        np.array([[0, 0, 0], [1, 0, 0], [0.4, 0.5, 0.0]]), [(0, 1), (1, 2), (0, 2)], [1, 2, 3], 0.5,
        "A triangular plate on three parallel cranks in its plane: six bonds, one of which follows from the "
        "others.")


def meet(a: np.ndarray, ra: float, b: np.ndarray, rb: float, left: bool) -> np.ndarray:
    """Where circles about a and b meet, to the left or right of the way from a to b."""
    d = np.linalg.norm(b - a)
    along = (ra**2 - rb**2 + d**2) / (2 * d)
    across = math.sqrt(ra**2 - along**2) * (1 if left else -1)
    e = (b - a) / d
    return a + along * e + across * np.array([-e[1], e[0], 0])


def jansen_linkage() -> Motion:
    unit = 0.01
    o, b = np.zeros(3), np.array([-38, -7.8, 0]) * unit
    p = 15 * unit * np.array([math.cos(1.0), math.sin(1.0), 0])
    c = meet(b, 41.5 * unit, p, 50 * unit, left=True)
    d = meet(b, 40.1 * unit, c, 55.8 * unit, left=True)
    e = meet(b, 39.3 * unit, p, 61.9 * unit, left=False)
    f = meet(d, 39.4 * unit, e, 36.7 * unit, left=False)
    g = meet(e, 49.0 * unit, f, 65.7 * unit, left=False)
    x = np.array([o, b, p, c, d, e, f, g])
    pairs = [(0, 2), (2, 3), (1, 3), (1, 4), (3, 4), (2, 5), (1, 5), (4, 6), (5, 6), (5, 7), (6, 7)]
    v = np.zeros_like(x)
    v[2] = 6 * np.array([-math.sin(1.0), math.cos(1.0), 0])
    return {
        "words": "The leg of Theo Jansen's Strandbeest, eleven bars of his lengths on a crank and a fixed pivot, "
        "coasts under gravity: one degree of freedom in its plane.", "x": x, "v": v,
        "system": system([0, 0, 5, 2, 2, 2, 2, 1], pairs, x, DOWN), "step": 0.001, "steps": 300
    }


def hung_chain_of_20() -> Motion:
    x = np.array([[0.1 * i, 0.01 * math.sin(2 * i), 0.02 * math.cos(3 * i)] for i in range(21)])
    return {
        "words": "A chain of 20 atoms, held at one end, is let go from nearly horizontal.",
        "system": system([0] + [10] * 20, row(20), x, DOWN), "x": x, "v": 0 * x, "step": 0.001, "steps": 200
    }


def chain_between_frozen_ends() -> Motion:
    n = 9
    x = np.array([[0.1 * i, -0.06 * (i % 2), 0.03 * math.sin(math.pi * i / (n - 1))] for i in range(n)])
    v = np.random.default_rng(4).normal(size=x.shape)
    return {
        "words": "A slack zigzag of nine atoms between two frozen ends moves under gravity.",
        "system": system([0] + [5] * (n - 2) + [0], row(n - 1), x, DOWN), "x": x, "v": v, "step": 0.001, "steps": 200
    }


def chain_of_1_to_1000_masses() -> Motion:
    x = np.array([[0.1 * i, 0.04 * (i % 2), 0.03 * (i % 3)] for i in range(10)])
    v = np.random.default_rng(5).normal(size=x.shape) * np.array([[1], [0.03]] * 5)
    return {
        "words": "A free chain of ten atoms, by turns of 1 and of 1000 u.", "system": system([1, 1000] * 5, row(9), x),
        "x": x, "v": v, "step": 0.001, "steps": 200
    }


def folding_rhombus() -> Motion:
    """Half diagonals of cos φ and sin φ; the kinetic energy is m φ'², so φ = 45° − 2t, through 0 and on."""
    def at(t: float) -> Tuple[np.ndarray, np.ndarray]:
        phi = math.pi / 4 - 2 * t
        one, other = np.array([1, 1, 0]) / math.sqrt(2), np.array([1, -1, 0]) / math.sqrt(2)
        middle, c, s = np.array([0.5, 0.5, 0]), math.cos(phi), math.sin(phi)
        return (middle + np.array([-c * one, s * other, c * one, -s * other]),
                -2 * np.array([s * one, c * other, -s * one, -c * other]))

    x, v = at(0)
    return {
        "words": "A free rhombus of four bonds folds flat, with all its atoms in a line, and on through itself.",
        "system": system([1] * 4, [(0, 1), (1, 2), (2, 3), (0, 3)], x), "x": x, "v": v, "step": 0.002, "steps": 300,
        "exact": at(0.6), "ground": "half diagonals cos φ and sin φ, φ = 45° − 2t, since the kinetic energy is m φ'²"
    }


MECHANISMS = [
    pendulum, pendulum_period, conical_pendulum, double_pendulum, free_rotor, fast_rotor, rotor_of_unequal_masses,
    rotor_far_away, bond_over_half_a_box, bond_through_the_box, linkage_before_its_dead_point,
    linkage_through_its_dead_point, plate_on_three_cranks, jansen_linkage, hung_chain_of_20, chain_between_frozen_ends,
    chain_of_1_to_1000_masses, folding_rhombus
]
