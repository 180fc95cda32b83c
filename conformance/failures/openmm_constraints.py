"""OpenMM's CCMA: a cube's edges end in NaN or far from the tolerance, and a bond of negative length is taken."""

import numpy as np
import openmm as mm

CUBE = 0.2 * np.array(list(np.ndindex(2, 2, 2)))
EDGES = [(i, j) for j in range(8) for i in range(j) if abs(CUBE[i] - CUBE[j]).sum() < 0.3]


def error_after_steps(platform, x, pairs, length):
    system = mm.System()
    for _ in x:
        system.addParticle(10)
    for i, j in pairs:
        system.addConstraint(i, j, length)
    integrator = mm.VerletIntegrator(0.002)
    integrator.setConstraintTolerance(1e-10)
    properties = {"Precision": "double"} if platform == "OpenCL" else {}
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName(platform), properties)
    context.setPositions(x)
    context.setVelocitiesToTemperature(300, 1)
    integrator.step(100)
    x = context.getState(positions=True).getPositions(asNumpy=True)._value
    return max(abs(np.linalg.norm(x[j] - x[i]) / abs(length) - 1) for i, j in pairs)


for n in range(mm.Platform.getNumPlatforms()):
    name = mm.Platform.getPlatform(n).getName()
    for what, *case in (("cube", CUBE, EDGES, 0.2), ("negative length", CUBE[:2], [(0, 1)], -0.2)):
        try:
            print(name, what, f"{error_after_steps(name, *case):.1e}")
        except mm.OpenMMException as said:
            print(name, what, str(said)[:60])
