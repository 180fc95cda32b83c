"""Systems as LAMMPS data files: water, a molecule like methane, chains of beads, with bonds of exact lengths.

    python3 systems.py water 12 > water.data            # 12³ molecules of SPC/E or TIP3P
    python3 systems.py solution 20 8 > solution.data    # a chain of 20 among what is left of 8³ waters
    python3 systems.py melt 20 500 > melt.data          # 20 chains of 500 beads, at density 0.85
"""

import sys

import numpy as np


class Topology:
    def __init__(self, atoms, bonds, angles, box):
        self.types, self.molecules, self.charges, self.x = atoms
        self.bonds, self.angles = bonds, angles
        self.box, self.tilt = np.asarray(box, float), None

    def text(self, masses):
        lines = ["taut", "", f"{len(self.x)} atoms", f"{len(self.bonds)} bonds", f"{len(self.angles)} angles",
                 f"{len(masses)} atom types", f"{max(b[0] for b in self.bonds)} bond types",
                 f"{max([a[0] for a in self.angles], default=0)} angle types"]
        lines += [f"0 {edge:.17g} {axis}lo {axis}hi" for edge, axis in zip(self.box, "xyz")]
        if self.tilt:
            lines += ["{} {} {} xy xz yz".format(*self.tilt)]
        lines += ["", "Masses", ""] + [f"{k + 1} {mass}" for k, mass in enumerate(masses)]
        lines += ["", "Atoms # full", ""]
        lines += [f"{k + 1} {m} {t} {q} {x[0]:.17g} {x[1]:.17g} {x[2]:.17g}"
                  for k, (t, m, q, x) in enumerate(zip(self.types, self.molecules, self.charges, self.x))]
        lines += ["", "Bonds", ""] + [f"{k + 1} {t} {i} {j}" for k, (t, i, j) in enumerate(self.bonds)]
        if self.angles:
            lines += ["", "Angles", ""] + [f"{k + 1} {t} {i} {j} {l}" for k, (t, i, j, l) in enumerate(self.angles)]
        return "\n".join(lines) + "\n"


def repeated(shape, types, charges, bonds, angles, side, spacing, seed=1):
    """side³ molecules of one shape, each turned at random, on a lattice."""
    rng = np.random.default_rng(seed)
    n, x, all_bonds, all_angles = len(shape), [], [], []
    for m in range(side**3):
        q, r = np.linalg.qr(rng.normal(size=(3, 3)))
        q *= np.sign(np.diag(r))
        if np.linalg.det(q) < 0:
            q[:, 0] *= -1
        place = np.array([m % side, m // side % side, m // side**2]) * spacing + 0.5 * spacing
        x += list(shape @ q.T + place)
        all_bonds += [(t, m * n + i, m * n + j) for t, i, j in bonds]
        all_angles += [(t, m * n + i, m * n + j, m * n + k) for t, i, j, k in angles]
    count = side**3
    atoms = (types * count, [m + 1 for m in range(count) for _ in range(n)], charges * count, np.array(x))
    return Topology(atoms, all_bonds, all_angles, [side * spacing] * 3)


def water(side=4, model="spce"):
    bond, angle = {"spce": (1.0, 109.47), "tip3p": (0.9572, 104.52)}[model]
    half = np.radians(angle) / 2
    shape = bond * np.array([[0, 0, 0], [np.sin(half), np.cos(half), 0], [-np.sin(half), np.cos(half), 0]])
    return repeated(shape, [1, 2, 2], [-0.8476, 0.4238, 0.4238] if model == "spce" else [-0.834, 0.417, 0.417], [(1, 1, 2), (1, 1, 3)], [(1, 2, 1, 3)], side, 3.1)


def methane(side=3):
    shape = np.array([[0, 0, 0], [1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3)
    shape[0] = 0
    return repeated(shape, [1, 2, 2, 2, 2], [0] * 5, [(1, 1, k) for k in (2, 3, 4, 5)], [], side, 3.2)


def chains(count, beads, straight=False, bond=1.0, density=0.5, seed=2):
    """Chains of unit bonds: random walks that do not turn back, or straight along x; beads are to be soft at first."""
    rng = np.random.default_rng(seed)
    box = (count * beads / density) ** (1 / 3)
    box = max(box, beads + 1.0) if straight else box
    x, bonds = [], []
    for c in range(count):
        here, last = rng.uniform(0, box, 3), None
        for b in range(beads):
            x.append(here)
            step = rng.normal(size=3)
            step /= np.linalg.norm(step)
            while last is not None and step @ last < -0.3:
                step = rng.normal(size=3)
                step /= np.linalg.norm(step)
            if straight:
                step = np.array([1.0, 0.02 * rng.normal(), 0.02 * rng.normal()])
                step /= np.linalg.norm(step)
            here, last = here + bond * step, step
            if b:
                bonds.append((1, c * beads + b, c * beads + b + 1))
    n = count * beads
    atoms = ([1] * n, [c + 1 for c in range(count) for _ in range(beads)], [0] * n, np.array(x))
    return Topology(atoms, bonds, [], [box] * 3)


def solution(beads, side):
    """A chain of CH2 beads along a zigzag, and water on a lattice where the chain is not."""
    box = water(side)
    along = np.arange(beads)
    half = np.radians(56)
    chain = 1.54 * np.column_stack([along * np.sin(half), (along % 2) * np.cos(half), 0 * along])
    chain += box.box / 2 - chain.mean(axis=0)
    waters = box.x.reshape(-1, 3, 3)
    far = [w for w in waters if np.linalg.norm(chain - w[0], axis=1).min() > 3.2]
    n = 3 * len(far)
    atoms = ([1, 2, 2] * len(far) + [3] * beads, [m + 1 for m in range(len(far)) for _ in range(3)] + [len(far) + 1] * beads,
             [-0.8476, 0.4238, 0.4238] * len(far) + [0] * beads, np.concatenate([np.concatenate(far), chain]))
    bonds = [(1, 3 * m + 1, 3 * m + k) for m in range(len(far)) for k in (2, 3)]
    bonds += [(2, n + b, n + b + 1) for b in range(1, beads)]
    angles = [(1, 3 * m + 2, 3 * m + 1, 3 * m + 3) for m in range(len(far))]
    return Topology(atoms, bonds, angles, box.box)


if __name__ == "__main__":
    kind, *numbers = sys.argv[1:]
    if kind == "melt":
        print(chains(int(numbers[0]), int(numbers[1]), bond=0.97, density=0.85).text([1.0]), end="")
    elif kind == "solution":
        print(solution(int(numbers[0]), int(numbers[1])).text([15.9994, 1.008, 14.027]), end="")
    else:
        print(water(int(numbers[0]), *numbers[1:]).text([15.9994, 1.008]), end="")
