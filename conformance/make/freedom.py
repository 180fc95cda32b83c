#!/usr/bin/env python3
"""Writes cases/freedom: degrees of freedom, checked against the rank; and cases/refusal: what cannot be held."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

from mechanisms import row, system
from molecules import WATER, WATER_MASSES, all_pairs, net_through_the_box, ring, ring_through_the_box
from solve import CASES, write

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from quantities import count_degrees_of_freedom  # noqa: E402  (its folder is no package)

RUN = {"step_ps": 0.0005, "steps": 10}


def freedom(name: str, words: str, made: Dict[str, Any], x: Any, right: int, ground: str) -> None:
    x = np.array(x, dtype=float)
    case = {
        "name": name, "words": words, "system": made, "start": {"positions_nm": x, "velocities_nm_per_ps": 0 * x},
        "run": RUN, "asks": [{
            "what": "degrees_of_freedom", "kind": "exact", "right": right, "tolerance": 0.5, "ground": ground,
            "made_by": "make/freedom.py"
        }]
    }
    found = count_degrees_of_freedom(case, x)
    assert found == right, f"{name}: {found}, not {right}"
    write("freedom", case)


def write_freedoms() -> None:
    x = np.array([[1.0 * n, 0.1 * k, 0] for n in range(3) for k in range(2)])
    freedom("freedom_of_dumbbells", "Three dumbbells that fly apart.", system([1, 2] * 3, [(0, 1), (2, 3), (4, 5)], x),
            x, 15, "3·6 − 3, all bonds independent")
    x = np.vstack([WATER, WATER + 1])
    pairs = [(a + i, a + j) for a in (0, 3) for i, j in all_pairs(3)]
    freedom("freedom_of_waters", "Two rigid waters, free to move.", system(WATER_MASSES * 2, pairs, x), x, 12,
            "two rigid bodies")
    made = ring()
    freedom("freedom_of_a_ring", "A hinged ring of six.", made["system"], made["x"], 12,
            "3·6 − 6, all bonds independent")
    x = 0.0629 * np.array([[0, 0, 0], [1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    freedom("freedom_of_methane",
            "Methane with all ten distances held: a rigid body, one bond follows from the others.",
            system([12, 1, 1, 1, 1], list(all_pairs(5)), x), x, 6, "a rigid body; 3·5 − 10 would be 5")
    x = 0.2 * np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)])
    held = [(i, j) for i, j in all_pairs(8) if np.linalg.norm(x[j] - x[i]) < 0.29 or i == 0]
    freedom(
        "freedom_of_a_braced_cube",
        "A cube with its edges, both diagonals of each face and one of the body: 25 bonds, of which 18 are "
        "independent.", system([10] * 8, held, x), x, 6, "a rigid body; 3·8 − 25 would be −1")
    x = np.array([[0.1 * i, 0.02 * (i % 2), 0] for i in range(5)])
    freedom("freedom_between_frozen_ends", "Three atoms on four bonds between two frozen ones.",
            system([0, 1, 1, 1, 0], row(4), x), x, 5, "3·3 − 4: frozen atoms have none")
    x = np.array([[0, 0, 0], [0.1, 0, 0], [0.3, 0, 0]])
    freedom("freedom_of_a_bond_between_frozen_atoms",
            "A bond between two frozen atoms takes nothing from a third atom's freedom.",
            system([0, 0, 4], [(0, 1)], x), x, 3, "3·1: the bond's gradient is zero for atoms that move")
    x = np.array([[0, 0, 0], [1, 0, 0], [0.4, 0.5, 0], [0.6, 0.8, 0], [1.6, 0.8, 0], [1, 1.3, 0]])
    freedom("freedom_of_a_plate_on_cranks",
            "A triangular plate on three parallel cranks in its plane: one of six bonds follows from the "
            "others.", system([0, 0, 0, 1, 2, 3], [(0, 3), (1, 4), (2, 5), (3, 4), (4, 5), (3, 5)], x), x, 4,
            "3·3 less a rank of 5: it swings in its plane, and each corner is free to leave it")
    made = ring_through_the_box()
    freedom("freedom_of_a_loop_through_the_box", "Three atoms on three bonds that close through the box.",
            made["system"], made["x"], 6, "3·3 − 3, all bonds independent")
    made = net_through_the_box()
    freedom("freedom_of_a_net_through_the_box",
            "Four atoms on eight bonds that close through the box in two directions.", made["system"], made["x"], 4,
            "3·4 − 8: puckered, no bond follows from the others")
    x = np.array([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0]])
    made = system([5, 6, 7], [(0, 1), (1, 2), (1, 0)], x)
    freedom("freedom_with_a_bond_twice", "A bond is listed twice, the second time from its other end.", made, x, 7,
            "3·3 − 2: the second adds nothing")


def refusal(name: str, words: str, masses: List[float], x: Any, bonds: List[Any], why: str, **more: Any) -> None:
    x = np.array(x, dtype=float)
    made = {"masses_u": masses, "bonds": [{"atoms": [i, j], "length_nm": d} for i, j, d in bonds], "forces": [], **more}
    write(
        "refusal", {
            "name": name, "words": words, "system": made, "start": {"positions_nm": x, "velocities_nm_per_ps": 0 * x
                                                                    }, "run": {"step_ps": 0.001, "steps": 20},
            "asks": [{"what": "refusal", "kind": "refused", "right": True, "ground": why}]
        })


def write_refusals() -> None:
    line = [[0, 0, 0], [0.1, 0, 0], [0.2, 0, 0]]
    refusal("triangle_that_cannot_be", "Three bonds of 0.1, 0.1 and 0.3 nm in a triangle.", [1, 1, 1],
            [[0, 0, 0], [0.1, 0, 0], [0.15, 0.1, 0]], [(0, 1, 0.1), (1, 2, 0.1),
                                                       (0, 2, 0.3)], "0.3 > 0.1 + 0.1: no triangle has these sides")
    refusal("chain_too_short_for_its_ends", "Two bonds of 0.1 nm between frozen atoms that are 0.25 nm apart.",
            [0, 5, 0], [[0, 0, 0], [0.12, 0, 0], [0.25, 0, 0]], [(0, 1, 0.1), (1, 2, 0.1)],
            "0.25 > 0.1 + 0.1: no place fulfils both")
    refusal("one_bond_of_two_lengths", "Two bonds of 0.1 and 0.12 nm between the same two atoms.", [1, 1, 1], line,
            [(0, 1, 0.1), (0, 1, 0.12)], "a distance has one value")
    refusal("bond_of_no_length", "A bond of length zero between two atoms 0.1 nm apart.", [1, 1, 1], line, [(0, 1, 0)],
            "½|r|² = 0 has no gradient where it is fulfilled: nothing holds it (constraint forces act along r)")
    refusal("bond_of_negative_length", "A bond of a length below zero, −0.1 nm.", [1, 1, 1], line, [(0, 1, -0.1)],
            "a distance is not negative")
    refusal("atom_bound_to_itself", "A bond from an atom to itself.", [1, 1, 1], line, [(1, 1, 0.1)],
            "its length is zero")
    refusal("negative_mass", "An atom of −1 u on a bond.", [1, -1, 1], line, [(0, 1, 0.1)],
            "no equation of motion has such a mass")


if __name__ == "__main__":
    write_freedoms()
    write_refusals()
    print(*(path.stem for path in sorted(CASES.glob("[fr][re]*/*.json")) if path.parent.name in ("freedom", "refusal")),
          sep="\n")
