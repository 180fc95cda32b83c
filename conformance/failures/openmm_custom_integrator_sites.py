"""OpenMM's CustomIntegrator takes forces on virtual sites where the sites were before.

On the platforms Reference and CPU sites are moved at the end of a step alone, so that velocity Verlet's second half step
has the force of the old place: the error falls by 2 at half the step. On OpenCL they are moved where the integrator has
addConstrainPositions(), which is right, and never without it.
"""

import numpy as np
import openmm as mm


def error_at(step, platform, constrain):
    system = mm.System()
    for mass in (1, 1, 0):
        system.addParticle(mass)
    system.setVirtualSite(2, mm.TwoParticleAverageSite(0, 1, 0.5, 0.5))
    spring = mm.CustomExternalForce("0.5*100*x^2")
    spring.addParticle(2, [])
    system.addForce(spring)
    integrator = mm.CustomIntegrator(step)
    integrator.addUpdateContextState()
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    integrator.addComputePerDof("x", "x+dt*v")
    if constrain:
        integrator.addConstrainPositions()
    integrator.addComputePerDof("v", "v+0.5*dt*f/m")
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName(platform))
    context.setPositions(np.array([[1, 0, 0], [1, 1, 0], [1, 0.5, 0]]))
    integrator.step(round(1 / step))
    x = context.getState(positions=True).getPositions(asNumpy=True)._value[0, 0]
    return x - np.cos(np.sqrt(50))  # half of the spring for each of two masses


for n in range(mm.Platform.getNumPlatforms()):
    name = mm.Platform.getPlatform(n).getName()
    for constrain in (True, False):
        print(name, constrain, *(f"{error_at(step, name, constrain):.2e}" for step in (0.01, 0.005, 0.0025)))
