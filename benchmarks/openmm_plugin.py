#!/usr/bin/env python3
"""Runs OpenMM with taut.openmm.Integrator and with OpenMM's own, where rigid bonds are hard or cost much.

    python benchmarks/openmm_plugin.py cholesterol [--steps 1000000] [--molecules 8]
    python benchmarks/openmm_plugin.py protein SYSTEM.xml STATE.xml [--steps 40] [--rigid hydrogens|all|angles]
    python benchmarks/openmm_plugin.py water SYSTEM.xml STATE.xml [--steps 20000]

cholesterol: the bonded model of Martini 2 (doi:10.1021/ja507832e), whose frame is two triangles hinged on an edge and
nearly flat, at 20 fs and 300 K; where each integrator ends. protein: milliseconds a step of 2 fs with rigid bonds to
hydrogen, all bonds, or all bonds and the angles that OpenMM's HAngles makes rigid; whole steps, and steps without
forces but those of angles, from which OpenMM takes its matrix: integrator and bonds alone. water: temperature and
potential with a thermostat, beside OpenMM's own, and the drift of the energy without.
All on the CPU platform, one thread. Needs the plug-in (openmm_plugin/README.md).
"""
import argparse
import itertools
import math
import statistics
import time
from pathlib import Path

import numpy as np
import openmm as mm
from openmm import unit

import taut.openmm
from machine import describe

R = 8.31446261815324e-3  # kJ/mol/K
FRAME = {"masses": (77.22, 38.69, 159.65, 39.44, 72.0), "bonds": ((0, 1), (0, 2), (1, 2), (1, 3), (2, 3))}


def context_of(system, integrator, x, v=None):
    context = mm.Context(system, integrator, mm.Platform.getPlatformByName("CPU"), {"Threads": "1"})
    context.setPositions(x)
    if v is not None:
        context.setVelocities(v)
    return context


def constraints_of(system):
    return [(i, j, d._value) for i, j, d in map(system.getConstraintParameters, range(system.getNumConstraints()))]


def free_motions(system):
    """Degrees of freedom, as StateDataReporter counts them."""
    masses = [system.getParticleMass(i)._value for i in range(system.getNumParticles())]
    still = any(isinstance(force, mm.CMMotionRemover) for force in system.getForces())
    return 3 * sum(mass > 0 for mass in masses) - system.getNumConstraints() - 3 * still


def bond_error(bonds, x):
    i, j, d = (np.array(column) for column in zip(*bonds))
    return float(np.max(np.abs(np.linalg.norm(x[j] - x[i], axis=1) / d - 1)))


def apex(from_a, from_b, edge, side):
    """The third corner of a triangle in the plane on the edge from (0, 0) to (edge, 0)."""
    along = (from_a**2 - from_b**2 + edge**2) / (2 * edge)
    return np.array([along, side * math.sqrt(from_a**2 - along**2), 0])


def cholesterol(count):
    hinge = np.array([0.2719, 0, 0])
    head, tail = apex(0.4904, 0.6019, 0.2719, 1), apex(0.7237, 0.5376, 0.2719, -1)
    end = tail + 0.425 * (tail - hinge) / np.linalg.norm(tail - hinge)
    molecule = np.array([head, [0, 0, 0], hinge, tail, end])
    system, x, side = mm.System(), [], math.ceil(count ** (1 / 3))
    system.setDefaultPeriodicBoxVectors(*(1.5 * max(side, 2) * np.eye(3)))
    pairs, springs = mm.NonbondedForce(), mm.HarmonicBondForce()
    pairs.setNonbondedMethod(pairs.CutoffPeriodic), pairs.setCutoffDistance(1.2)
    angles = mm.CustomAngleForce("12.5*(cos(theta)+1)^2")
    torsions = mm.CustomTorsionForce("25*min(d,6.283185307-d)^2; d=abs(theta+3.136357)")
    for n in range(count):
        o = len(x)
        for mass, at in zip(FRAME["masses"], molecule):
            system.addParticle(mass), pairs.addParticle(0, 0.43, 2.6)
            x.append(at + 1.5 * np.array([n % side, n // side % side, n // side**2]))
        for i, j in FRAME["bonds"]:
            system.addConstraint(o + i, o + j, round(float(np.linalg.norm(molecule[j] - molecule[i])), 4))
        springs.addBond(o + 3, o + 4, 0.425, 1250), angles.addAngle(o + 2, o + 3, o + 4, [])
        torsions.addTorsion(o, o + 1, o + 2, o + 3, [])
        for i, j in itertools.combinations(range(5), 2):
            pairs.addException(o + i, o + j, 0, 0.3, 0)
    for force in (pairs, springs, angles, torsions):
        system.addForce(force)
    return system, x


def run_cholesterol(options):
    print("integrator,step fs,steps,largest bond error,mean temperature K,seconds,end")
    system, x = cholesterol(options.molecules)
    freedoms, bonds = free_motions(system), constraints_of(system)
    bath = {"temperature": 300, "friction": 1, "seed": 1}
    unbound = mm.XmlSerializer.clone(system)
    taken = taut.openmm.rigid_bonds(unbound)
    for name, dt, make in (("taut feedforward, bonds of its own, minimized", 0.02,
                            lambda dt: taut.openmm.Integrator(dt, bonds=taken, **bath)),
                           ("taut feedforward", 0.02, lambda dt: taut.openmm.Integrator(dt, **bath)),
                           ("OpenMM, tolerance 1e-5", 0.02, lambda dt: mm.LangevinMiddleIntegrator(300, 1, dt)),
                           ("OpenMM, tolerance 1e-5", 0.002, lambda dt: mm.LangevinMiddleIntegrator(300, 1, dt))):
        own = "of its own" in name
        context = context_of(unbound if own else system, make(dt), x)
        begin, done, worst, temperatures, end = time.time(), 0, 0, [], "all steps"
        every = max(1, min(1000, options.steps // 100))
        try:
            if own:
                mm.LocalEnergyMinimizer.minimize(context)
            context.setVelocitiesToTemperature(300, 1)
            while done < options.steps:
                context.getIntegrator().step(every)
                state = context.getState(positions=True, energy=True)
                done += every
                worst = max(worst, bond_error(bonds, state.getPositions(asNumpy=True)._value))
                temperatures.append(2 * state.getKineticEnergy()._value / R / freedoms)
        except mm.OpenMMException as wrong:
            end = f"failed within the next {every}: {str(wrong).split('.')[0]}"
        mean = statistics.fmean(temperatures) if temperatures else math.nan
        print(f"{name},{1e3 * dt:g},{done},{worst:.1e},{mean:.1f},{time.time() - begin:.1f},{end}", flush=True)


def with_more_bonds(text, angles):
    """All bonds rigid, and with `angles` H-X-H and H-O-X, too."""
    system = mm.XmlSerializer.deserialize(text)
    length = {}
    for k in range(system.getNumConstraints()):
        i, j, d = system.getConstraintParameters(k)
        length[frozenset((i, j))] = d._value
    mass = [system.getParticleMass(i)._value for i in range(system.getNumParticles())]
    forces = {force.__class__.__name__: force for force in system.getForces()}
    springs = forces["HarmonicBondForce"]
    for k in range(springs.getNumBonds()):
        i, j, d, stiffness = springs.getBondParameters(k)
        if frozenset((i, j)) not in length:
            length[frozenset((i, j))] = d._value
            system.addConstraint(i, j, d)
        springs.setBondParameters(k, i, j, d, 0)
    bends = forces["HarmonicAngleForce"]
    for k in range(bends.getNumAngles() if angles else 0):
        i, j, m, theta, stiffness = bends.getAngleParameters(k)
        hydrogens = (mass[i] < 2) + (mass[m] < 2)
        if hydrogens == 2 or (hydrogens == 1 and 15.5 < mass[j] < 16.5):
            a, b = length[frozenset((i, j))], length[frozenset((j, m))]
            if frozenset((i, m)) not in length:
                system.addConstraint(i, m, math.sqrt(a * a + b * b - 2 * a * b * math.cos(theta._value)))
                length[frozenset((i, m))] = 0
            bends.setAngleParameters(k, i, j, m, theta, 0)
    return system


def read(options):
    state = mm.XmlSerializer.deserialize(Path(options.state).read_text())
    return Path(options.system).read_text(), state


def without_forces(system):
    bare = mm.XmlSerializer.clone(system)
    for k in reversed(range(bare.getNumForces())):
        if not isinstance(bare.getForce(k), mm.HarmonicAngleForce):
            bare.removeForce(k)
    return bare


def ms_a_step(context, steps):
    """The least of five turns, in processor time."""
    context.getIntegrator().step(5)
    times = []
    for _ in range(5):
        begin = time.process_time()
        context.getIntegrator().step(steps // 5)
        times.append((time.process_time() - begin) / (steps // 5) * 1e3)
    return min(times)


def run_protein(options):
    text, state = read(options)
    system = with_more_bonds(text, options.rigid == "angles")
    if options.rigid == "hydrogens":
        system = mm.XmlSerializer.deserialize(text)
    start = context_of(system, taut.openmm.Integrator(0.002), state.getPositions(), state.getVelocities())
    start.applyConstraints(1e-8), start.applyVelocityConstraints(1e-8)
    kept = start.getState(positions=True, velocities=True)
    print("rigid,bonds,integrator,ms a step,ms without forces,bond error,end")
    for name, make in (("taut feedforward", lambda: taut.openmm.Integrator(0.002)),
                       ("OpenMM Langevin 1e-5", lambda: mm.LangevinMiddleIntegrator(300, 1, 0.002)),
                       ("taut Langevin", lambda: taut.openmm.Integrator(0.002, temperature=300, friction=1)),
                       ("OpenMM Verlet 1e-5", lambda: mm.VerletIntegrator(0.002))):
        cost, bare, error, end = math.nan, math.nan, math.nan, "all steps"
        try:
            context = context_of(system, make(), kept.getPositions(), kept.getVelocities())
            cost = ms_a_step(context, options.steps)
            error = bond_error(constraints_of(system), context.getState(positions=True).getPositions(asNumpy=True)._value)
            bare = ms_a_step(context_of(without_forces(system), make(), kept.getPositions(), kept.getVelocities()),
                             5 * options.steps)
        except mm.OpenMMException as wrong:
            end = f"failed: {str(wrong).split('.')[0]}"
        print(f"{options.rigid},{system.getNumConstraints()},{name},{cost:.1f},{bare:.2f},{error:.1e},{end}",
              flush=True)


def run_water(options):
    text, state = read(options)
    system = mm.XmlSerializer.deserialize(text)
    freedoms = free_motions(system)
    print("integrator,ps,mean temperature K,its standard error,mean potential kJ/mol,its standard error,"
          "drift kJ/mol/ns/degree of freedom,its standard error")
    for name, make in (("feedforward with friction 1/ps at 298.15 K",
                        lambda: taut.openmm.Integrator(0.002, temperature=298.15, friction=1, seed=1)),
                       ("OpenMM's LangevinMiddleIntegrator with the same friction",
                        lambda: mm.LangevinMiddleIntegrator(298.15, 1, 0.002)),
                       ("feedforward", lambda: taut.openmm.Integrator(0.002))):
        context = context_of(system, make(), state.getPositions(), state.getVelocities())
        context.getIntegrator().step(2000)
        energies = []
        for _ in range(options.steps // 20):
            context.getIntegrator().step(20)
            now = context.getState(energy=True)
            energies.append((now.getKineticEnergy()._value, now.getPotentialEnergy()._value))
        kinetic, potential = np.array(energies).T
        means = [np.array([block.mean() for block in np.array_split(of, 10)])
                 for of in (2 * kinetic / R / freedoms, potential)]
        drift = error = math.nan
        if "friction" not in name:
            t = 0.04e-3 * np.arange(len(kinetic))  # ns
            slopes = [np.polyfit(a, b, 1)[0] / freedoms
                      for a, b in zip(np.array_split(t, 2), np.array_split(kinetic + potential, 2))]
            drift, error = np.polyfit(t, kinetic + potential, 1)[0] / freedoms, abs(slopes[0] - slopes[1]) / 2
        averages = ",".join(f"{of.mean():.2f},{of.std(ddof=1) / 10**0.5:.2f}" for of in means)
        print(f"{name},{options.steps * 0.002:g},{averages},{drift:.3f},{error:.3f}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(required=True)
    for name, run, steps in (("cholesterol", run_cholesterol, 1000000), ("protein", run_protein, 40),
                             ("water", run_water, 20000)):
        kind = kinds.add_parser(name)
        kind.add_argument("--steps", type=int, default=steps)
        kind.set_defaults(run=run)
        if name == "protein":
            kind.add_argument("--rigid", choices=("hydrogens", "all", "angles"), default="hydrogens")
        if name == "cholesterol":
            kind.add_argument("--molecules", type=int, default=8)
        else:
            kind.add_argument("system"), kind.add_argument("state")
    options = parser.parse_args()
    print(f"# {describe()}; OpenMM {mm.Platform.getOpenMMVersion()}")
    options.run(options)


if __name__ == "__main__":
    main()
