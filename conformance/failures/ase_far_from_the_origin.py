"""ASE's FixBondLengths asks for 1e-13 by default, which rounding does not allow far from the origin: it stops."""

import numpy as np
from ase import Atoms, units
from ase.calculators.lj import LennardJones
from ase.constraints import FixBondLengths
from ase.md.verlet import VelocityVerlet

for far in (0, 100, 10000):
    rotor = Atoms("C2", positions=[[far, -far, far], [far + 1, -far, far]], constraint=FixBondLengths([[0, 1]]))
    rotor.calc = LennardJones(epsilon=0)
    rotor.set_velocities(np.array([[0, -0.01, 0], [0, 0.01, 0]]) / units.fs)
    try:
        VelocityVerlet(rotor, 2 * units.fs).run(100)
        print(f"{far} Å away: bond {rotor.get_distance(0, 1):.13f} Å")
    except RuntimeError as said:
        print(f"{far} Å away: {said}")
