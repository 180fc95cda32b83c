"""What runners of several engines share: rows, images, and the clusters that bonds make of atoms."""

from __future__ import annotations

from collections import defaultdict
from typing import Any, Dict, List

import numpy as np

from quantities import BOLTZMANN, Case, bond_vectors, gradients, masses_of

BAR = 16.6053906717  # bar in a kJ/mol/nm³


class EngineStopped(Exception):
    """The engine broke off a run that it ought to make."""


def digits(*values: float) -> str:
    """Numbers with all their digits, as files of several engines have them."""
    return " ".join(f"{value:.17g}" for value in values)


def not_offered(why: str) -> Case:
    return {"offered": False, "why": why}


def wants_refusal(case: Case) -> bool:
    return any(ask["kind"] == "refused" for ask in case["asks"])


def row_steps(case: Case) -> List[int]:
    """The steps after which a row is asked for: the start, every rows_every, the end."""
    steps = case["run"]["steps"]
    return sorted({*range(0, steps + 1, case["run"].get("rows_every", steps) or 1), steps})


def wants_tensions_alone(case: Case) -> bool:
    """Such a case need not run where the engine does not tell tensions."""
    return all("tension" in ask["what"] for ask in case["asks"])


def moving(case: Case) -> np.ndarray:
    return masses_of(case) > 0


def inverse_masses(case: Case) -> np.ndarray:
    """0 for atoms that do not move."""
    return np.divide(1, masses_of(case), where=moving(case), out=np.zeros(len(moving(case))))


def images(case: Case) -> List[Dict[int, np.ndarray]]:
    """The clusters that bonds join: for each atom how many box vectors its image is from that of the cluster's first."""
    neighbours: Dict[int, List[Any]] = defaultdict(list)
    for bond in case["system"]["bonds"]:
        (i, j), image = bond["atoms"], np.array(bond.get("image", [0, 0, 0]))
        neighbours[i].append((j, image))
        neighbours[j].append((i, -image))
    found: List[Dict[int, np.ndarray]] = []
    for first in sorted(neighbours):
        if any(first in reached for reached in found):
            continue
        reached, open_ends = {first: np.zeros(3)}, [first]
        while open_ends:
            at = open_ends.pop()
            for other, image in neighbours[at]:
                if other not in reached:
                    reached[other] = reached[at] + image
                    open_ends.append(other)
        found.append(reached)
    return found


def clusters(case: Case) -> List[List[int]]:
    """The atoms that bonds join, each cluster sorted; atoms without bonds are none."""
    return [sorted(reached) for reached in images(case)]


def whole(case: Case) -> np.ndarray:
    """The box vectors to add to each atom so that bonds go to no image; ValueError if a cluster spans the box."""
    shift = np.zeros((len(case["system"]["masses_u"]), 3))
    for reached in images(case):
        shift[list(reached)] = list(reached.values())
    for bond in case["system"]["bonds"]:
        i, j = bond["atoms"]
        if not np.array_equal(shift[j], shift[i] + bond.get("image", [0, 0, 0])):
            raise ValueError("a molecule that goes through the box to its own image")
    return shift @ np.array(case["system"].get("box_nm", np.zeros((3, 3))), dtype=float)


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
    x, inverse = np.array(case["start"]["positions_nm"], dtype=float), np.repeat(inverse_masses(case), 3)
    draws = np.random.default_rng(case["run"].get("seed", 1)).normal(size=x.size)
    v = draws * np.sqrt(BOLTZMANN * case["start"]["temperature_k"] * inverse)
    jacobian = gradients(case, x)
    v -= inverse * (jacobian.T @ np.linalg.lstsq(jacobian * inverse @ jacobian.T, jacobian @ v, rcond=None)[0])
    return v.reshape(x.shape)


def nearest_images(case: Case) -> bool:
    """Whether every bond goes to that image of its second atom which is nearest to the first."""
    around = (np.array(list(np.ndindex(3, 3, 3))) - 1) @ np.array(case["system"].get("box_nm", np.zeros((3, 3))))
    along = bond_vectors(case, np.array(case["start"]["positions_nm"], dtype=float))
    return all(np.linalg.norm(r + around, axis=1).min() > 0.999 * np.linalg.norm(r) for r in along)


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
