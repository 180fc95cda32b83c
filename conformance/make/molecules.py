"""Molecules: shapes on which constraint algorithms differ, with forces, sites and boxes."""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any, Dict, List, Sequence

import numpy as np

from mechanisms import Motion, row, system


def kicks(seed: int, x: np.ndarray, speed: float = 1.0) -> np.ndarray:
    return speed * np.random.default_rng(seed).normal(size=x.shape)


def free(masses: Sequence[float], pairs: Any, x: Any, words: str, seed: int, step: float = 0.001, steps: int = 200,
         speed: float = 1.0, forces: Any = (), **more: Any) -> Motion:
    x = np.array(x, dtype=float)
    return {
        "words": words, "system": {**system(masses, list(pairs), x, *forces), **more}, "x": x,
        "v": kicks(seed, x, speed), "step": step, "steps": steps
    }


def all_pairs(n: int) -> Any:
    return combinations(range(n), 2)


WATER = np.array([[0, 0, 0], [0.09572, 0, 0],
                  [0.09572 * math.cos(math.radians(104.52)), 0.09572 * math.sin(math.radians(104.52)), 0]])
WATER_MASSES = [15.9994, 1.008, 1.008]


def triatomic_near_180() -> Motion:
    x = [[-0.1, 0.0005, 0], [0, 0, 0], [0.1, 0.0005, 0.0002]]
    made = free([1, 12, 1], row(2), x, "Three atoms that lie nearly in a line bend away from it, and turn.", 1)
    made["v"] = np.array([[0, 1.5, 0.3], [0, 0, 0], [0, 0.5, -1]])
    return made


def triatomic_through_180() -> Motion:
    a = math.radians(25)
    x = [[-0.1 * math.cos(a), 0.1 * math.sin(a), 0], [0, 0, 0], [0.1 * math.cos(a), 0.1 * math.sin(a), 0]]
    made = free([1, 12, 1], row(2), x, "A bent triatomic straightens and bends to the other side.", 1, steps=100)
    made["v"] = np.array([[0, -1, 0], [0, 0.2, 0], [0, -1, 0.0]])
    return made


def unequal_triangle() -> Motion:
    return free([1, 5, 20], all_pairs(3), [[0, 0, 0], [0.16, 0, 0], [0.05, 0.09, 0]],
                "A rigid triangle of three lengths and three masses tumbles freely.", 2)


def tumbling_water() -> Motion:
    return free(WATER_MASSES, all_pairs(3), WATER, "A free rigid water tumbles.", 3, speed=1.5)


def one_step_of_water() -> Motion:
    return free(WATER_MASSES, all_pairs(3), WATER, "One step of 2 fs of a rigid water that turns fast.", 4, step=0.002,
                steps=1, speed=3)


def held_water() -> Motion:
    spring = {"kind": "harmonic_position", "atom": 0, "centre_nm": [0.01, 0.02, 0], "k_kj_per_mol_nm2": 2000}
    pull = {"kind": "constant_force", "atom": 1, "force_kj_per_mol_nm": [0, 0, 40]}
    return free(WATER_MASSES, all_pairs(3), WATER,
                "A rigid water whose oxygen a spring holds and whose hydrogen is pulled.", 5, forces=[spring, pull])


def star() -> Motion:
    arms = 0.1 * np.array([[1, 0, 0], [-1, 0.1, 0], [0, 1, 0], [0.1, -1, 0], [0, 0, 1], [0, 0.2, -1]])
    return free([12] + [1, 2, 3, 1, 2, 3], [(0, i) for i in range(1, 7)], np.vstack([[0, 0, 0], arms]),
                "Six arms on one centre: every bond acts on every other.", 6, steps=100)


def ring() -> Motion:
    a = np.arange(6) * math.pi / 3
    x = np.stack([0.15 * np.cos(a), 0.15 * np.sin(a), 0.02 * (-1.0)**np.arange(6)], axis=1)
    return free([12, 13, 14, 15, 16, 17], [(i, (i + 1) % 6) for i in range(6)], x, "A ring of six hinged atoms.", 7)


def tetrahedral_cage() -> Motion:
    return free([1, 2, 3, 4], all_pairs(4), 0.1 * np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1.2]]),
                "Four atoms with all six distances held tumble as a rigid body.", 8)


def cube_of_edges() -> Motion:
    x = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)]) * 0.15 + 0.01 * kicks(1, np.zeros((8, 3)))
    edges = [(i, j) for i, j in all_pairs(8) if bin(i ^ j).count("1") == 1]
    return free([12] * 8, edges, x, "Eight atoms and the twelve edges of a cube: a cage that shears.", 9)


def cholesterol_diamond() -> Motion:
    x = [[0, 0, 0], [0.49, 0.1, 0], [0.3, 0.45, 0], [0.75, 0.5, 0.1]]
    return free(
        [50, 50, 50, 50], [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)], x,
        "The frame of Martini's cholesterol (doi:10.1063/1.4937783): two triangles hinged on an edge. LINCS's series "
        "does not converge on such.", 10, step=0.005, speed=0.3)


def redundant_methane() -> Motion:
    x = 0.0629 * np.array([[0, 0, 0], [1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]])
    return free([12, 1, 1, 1, 1], all_pairs(5), x,
                "Methane with all ten distances held, one more than a rigid body has.", 11)


def rigid_angles_alkane() -> Motion:
    x = np.array([[0.125 * i, 0.088 * (i % 2), 0.03 * (i > 3)] for i in range(6)])
    return free([15, 14, 14, 14, 14, 15],
                row(5) + [(i, i + 2) for i in range(4)], x,
                "A chain of six with rigid bonds and rigid angles: triangles hinged on edges.", 12)


def free_chain_of_20() -> Motion:
    x = np.array([[0.12 * i, 0.05 * math.sin(i), 0.06 * math.cos(2 * i)] for i in range(20)])
    return free([14] * 20, row(19), x, "A free chain of 20 equal atoms.", 13)


def chain_with_side_atoms() -> Motion:
    x = [[0.0, 0, 0], [0.15, 0.02, 0], [0.3, 0, 0], [0.0, 0.1, 0], [0.15, -0.09, 0], [0.3, 0.1, 0.02], [-0.1, 0, 0.02]]
    return free([12, 12, 12, 1, 1, 1, 1], [(0, 1), (1, 2), (0, 3), (1, 4), (2, 5), (0, 6)], x,
                "A tree: a chain of three heavy atoms with light ones at their sides.", 14)


def trimer_with_an_angle() -> Motion:
    angle = {"kind": "harmonic_angle", "atoms": [0, 1, 2], "angle_rad": 1.9, "k_kj_per_mol_rad2": 400}
    return free([1, 16, 2], row(2), [[0.1, 0, 0], [0, 0, 0], [-0.02, 0.1, 0]],
                "Two rigid bonds with a harmonic angle between them.", 15, forces=[angle])


def butane() -> Motion:
    x = [[0, 0, 0], [0.153, 0, 0], [0.2, 0.145, 0], [0.34, 0.16, 0.05]]
    forces = [{"kind": "harmonic_angle", "atoms": [i, i + 1, i + 2], "angle_rad": 1.95, "k_kj_per_mol_rad2": 500}
              for i in (0, 1)]
    forces.append(
        {"kind": "periodic_torsion", "atoms": [0, 1, 2, 3], "periodicity": 3, "phase_rad": 0.4, "k_kj_per_mol": 8})
    return free([15, 14, 14, 15], row(3), x, "Butane's four beads: rigid bonds, harmonic angles and a torsion.", 16,
                step=0.002, forces=forces)


def spring_between_rotors() -> Motion:
    spring = {"kind": "harmonic_bond", "atoms": [1, 2], "length_nm": 0.15, "k_kj_per_mol_nm2": 3000}
    return free([1, 8, 8, 1], [(0, 1), (2, 3)], [[0, 0.1, 0], [0, 0, 0], [0.16, 0, 0], [0.16, 0, 0.1]],
                "Two rigid bonds with a spring between.", 17, forces=[spring])


def two_waters() -> Motion:
    x = np.vstack([WATER, WATER + [0.1, -0.29, 0.05]])
    force = {
        "kind": "nonbonded", "sigma_nm": [0.315, 0.1, 0.1] * 2, "epsilon_kj_per_mol": [0.6364, 0, 0] * 2,
        "charges_e": [-0.834, 0.417, 0.417] * 2,
        "excluded": [[a + b, a + c] for a in (0, 3) for b, c in ((0, 1), (0, 2), (1, 2))]
    }
    pairs = [(a + i, a + j) for a in (0, 3) for i, j in all_pairs(3)]
    return free(WATER_MASSES * 2, pairs, x, "Two rigid TIP3P waters in empty space.", 18, forces=[force], speed=0.6)


def pair_across_a_triclinic_box() -> Motion:
    x = np.array([[0.05, 0.1, 0.5], [0.05, 0.2, 0.5], [1.15, 0.12, 0.55], [1.15, 0.12, 0.65]])
    force = {
        "kind": "nonbonded", "sigma_nm": [0.25] * 4, "epsilon_kj_per_mol": [0.5] * 4,
        "charges_e": [0.2, -0.2, -0.2, 0.2], "excluded": [[0, 1], [2, 3]], "cutoff_nm": 0.55, "solvent_dielectric": 78.3
    }
    return free([10] * 4, [(0, 1), (2, 3)], x,
                "Two dumbbells meet across the face of a triclinic box, within the cutoff all the time.", 19,
                forces=[force], speed=0.3, box_nm=[[1.3, 0, 0], [0.3, 1.25, 0], [-0.2, 0.35, 1.2]])


def rigid_benzene_with_sites() -> Motion:
    """Three carbons carry mass and bonds; the three between them are sites, 2/3 of two and −1/3 of the third."""
    a = np.arange(6) * math.pi / 3
    x = np.stack([0.139 * np.cos(a), 0.139 * np.sin(a), 0 * a], axis=1)[[0, 2, 4, 1, 3, 5]]
    thirds = [2 / 3, 2 / 3, -1 / 3]
    sites = [{"atom": 3, "of": [0, 1, 2], "weights": thirds}, {"atom": 4, "of": [1, 2, 0], "weights": thirds},
             {"atom": 5, "of": [2, 0, 1], "weights": thirds}]
    forces = [{"kind": "constant_force", "atom": 3, "force_kj_per_mol_nm": [0, 30, 60]},
              {"kind": "constant_force", "atom": 5, "force_kj_per_mol_nm": [0, 10, -90]},
              {"kind": "harmonic_position", "atom": 4, "centre_nm": [0, 0.1, 0], "k_kj_per_mol_nm2": 900}]
    return free([26, 26, 26, 0, 0, 0], all_pairs(3), x,
                "Benzene as a rigid triangle of three carbons and three virtual sites, on "
                "which forces act.", 20, forces=forces, virtual_sites=sites)


def four_site_water_in_a_field() -> Motion:
    x = np.vstack([WATER, [0, 0, 0]])
    w = 0.13194
    x[3] = (1 - 2 * w) * x[0] + w * (x[1] + x[2])
    forces = [{"kind": "constant_force", "atom": atom, "force_kj_per_mol_nm": [0, 0, pull]}
              for atom, pull in ((1, 100), (2, 100), (3, -200))]
    return free(WATER_MASSES + [0], all_pairs(3), x,
                "A four-site water whose virtual site and hydrogens feel an electric field.", 21, forces=forces,
                virtual_sites=[{"atom": 3, "of": [0, 1, 2], "weights": [1 - 2 * w, w, w]}])


def rods_linked_by_sites() -> Motion:
    """A site beyond the end of one rod, another within the second."""
    x = np.array([[0, 0, 0], [0.3, 0.02, 0], [0.5, 0.15, 0.1], [0.62, 0.4, -0.05], [0, 0, 0], [0, 0, 0]])
    sites = [{"atom": 4, "of": [0, 1], "weights": [-0.2, 1.2]}, {"atom": 5, "of": [2, 3], "weights": [0.7, 0.3]}]
    for site in sites:
        x[site["atom"]] = np.array(site["weights"]) @ x[site["of"]]
    made = free([20, 12, 16, 30, 0, 0], [(0, 1), (2, 3), (4, 5)], x,
                "Two rods fly and tumble, linked by a rigid bond between virtual sites of theirs.", 24,
                virtual_sites=sites)
    return {**made, "tensions": True}


def ring_through_the_box() -> Motion:
    x = [[0, 0, 0], [0.33, 0.2, 0], [0.67, -0.05, 0.1]]
    made = free([10, 11, 12], row(2), x, "Three atoms on bonds that close through the box: a loop with no end.", 22,
                box_nm=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    last = float(np.linalg.norm(np.array(x[0]) + [1, 0, 0] - x[2]))
    made["system"]["bonds"].append({"atoms": [2, 0], "length_nm": last, "image": [1, 0, 0]})
    return {**made, "tensions": True}


def net_through_the_box() -> Motion:
    x = np.array([[0.2 * i, 0.2 * j, 0.05 * (-1.0)**(i + j)] for i in (0, 1) for j in (0, 1)])
    made = free([12, 13, 14, 15], [], x, "A puckered square net, endless in two directions through a triclinic box.",
                23, speed=4, box_nm=[[0.4, 0, 0], [0.1, 0.4, 0], [0, 0, 1]])
    box, bonds = np.array(made["system"]["box_nm"]), []
    for i, j, image in ((0, 2, (0, 0, 0)), (2, 0, (1, 0, 0)), (1, 3, (0, 0, 0)), (3, 1, (1, 0, 0)), (0, 1, (0, 0, 0)),
                        (1, 0, (0, 1, 0)), (2, 3, (0, 0, 0)), (3, 2, (0, 1, 0))):
        along = x[j] - x[i] + np.array(image) @ box
        bonds.append({"atoms": [i, j], "length_nm": float(np.linalg.norm(along)), "image": list(image)})
    made["system"]["bonds"] = bonds
    return made


def springs(x: np.ndarray, k: float) -> List[Dict[str, Any]]:
    return [{"kind": "harmonic_position", "atom": i, "centre_nm": x[i].tolist(), "k_kj_per_mol_nm2": k}
            for i in range(len(x))]


def swinging_rotors() -> Motion:
    x = np.array([[0.5 * i + 0.1 * k * math.cos(i), 0.1 * k * math.sin(i), 0] for i in range(6) for k in (0, 1)])
    return free([10, 4] * 6, [(i, i + 1) for i in range(0, 12, 2)], x, "Six rotors on springs.", 24, step=0.004,
                forces=springs(x, 500))


def rigid_angles_chain() -> Motion:
    made = rigid_angles_alkane()
    made["system"]["forces"] = springs(np.array(made["x"]) * 1.02, 2000)
    return {**made, "step": 0.002}


MOLECULES = [
    triatomic_near_180, triatomic_through_180, unequal_triangle, tumbling_water, one_step_of_water, held_water, star,
    ring, tetrahedral_cage, cube_of_edges, cholesterol_diamond, redundant_methane, rigid_angles_alkane,
    free_chain_of_20, chain_with_side_atoms, trimer_with_an_angle, butane, spring_between_rotors, two_waters,
    pair_across_a_triclinic_box, rigid_benzene_with_sites, four_site_water_in_a_field, rods_linked_by_sites,
    ring_through_the_box, net_through_the_box
]
