#!/usr/bin/env python3
"""Measures the constraint time of a protein in water: villin of openmm.app in 2761 waters (Amber14, PME), bonds with
hydrogen rigid, and all of them.

    python benchmarks/protein_bonds.py [--taut build/taut] [--steps 100] [--turns 5] > protein_bonds.csv

taut: the constraints' part of whole steps of 2 fs, from its summary, on one thread. OpenMM's CPU platform, one thread,
processor time: steps with bonds less steps without, nothing else acting, of velocity Verlet that constrains positions
and velocities, to the tolerance of 1e-6, 20 of them. All take turns; medians and the least of the turns. Needs openmm
(8.6, from PyPI).
"""
import argparse
import json
import os
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import openmm as mm
from openmm import unit

from openmm_parity import brought, reference

SYSTEMS = {"hydrogens": "villin-amber14", "all": "villin-all-bonds"}
SETTLE = ["settle", "--set", "method.solute=newton"]
METHODS = {"baumgarte": ["baumgarte"], "feedforward": ["feedforward"], "newton": ["newton"], "shake 1e-6":
           ["shake", "--set", "method.tolerance=1e-6"], "rattle 1e-6": ["rattle", "--set", "method.tolerance=1e-6"],
           "settle and newton": SETTLE, "settle and feedforward": [*SETTLE[:-1], "method.solute=feedforward"]}


def constraint_us(options, folder, method):
    ran = subprocess.run(
        [options.taut, "run", "--openmm", folder / "system.xml", folder / "state.xml", "--dt-fs", "2", "--json",
         "--precision", "double", "--threads", "1", "--steps", str(options.steps), "--method", *METHODS[method]], capture_output=True, text=True)
    if ran.returncode:
        raise RuntimeError(f"{method}: {ran.stderr.strip().splitlines()[0]}")
    return json.loads(ran.stdout)["constraint_us_per_step"]


def without_forces(system, rigid):
    bare = mm.System()
    for atom in range(system.getNumParticles()):
        bare.addParticle(system.getParticleMass(atom))
    for bond in range(system.getNumConstraints() if rigid else 0):
        bare.addConstraint(*system.getConstraintParameters(bond))
    return bare


def velocity_verlet():
    rattle = mm.CustomIntegrator(0.002)
    rattle.addPerDofVariable("free", 0)
    rattle.addComputePerDof("v", "v + 0.5*dt*f/m")
    rattle.addComputePerDof("x", "x + dt*v")
    rattle.addComputePerDof("free", "x")
    rattle.addConstrainPositions()
    rattle.addComputePerDof("v", "v + 0.5*dt*f/m + (x - free)/dt")
    rattle.addConstrainVelocities()
    rattle.setConstraintTolerance(1e-6)
    return rattle


class OpenMM:
    def __init__(self, system, state):
        platform = mm.Platform.getPlatformByName("CPU")
        self.contexts = [mm.Context(without_forces(system, rigid), velocity_verlet(), platform, {"Threads": "1"})
                         for rigid in (True, False)]
        self.start = state

    def us_a_step(self, context, steps):
        context.setPositions(self.start.getPositions())
        context.setVelocities(self.start.getVelocities())
        context.getIntegrator().step(2)
        begin = time.process_time()
        context.getIntegrator().step(steps)
        context.getState(getPositions=True)
        return (time.process_time() - begin) / steps * 1e6

    def measure(self, steps, rigid, free):
        rigid.append(self.us_a_step(self.contexts[0], steps))
        free.append(self.us_a_step(self.contexts[1], steps))


def measure(options, bonds):
    system, positions = brought()[SYSTEMS[bonds]]()
    context = reference(system, positions)
    context.setVelocitiesToTemperature(300 * unit.kelvin, 1)
    state = context.getState(getPositions=True, getVelocities=True)
    theirs = OpenMM(system, state)
    times, rigid, free = {name: [] for name in METHODS}, [], []
    with tempfile.TemporaryDirectory() as folder:
        for name, what in (("system", system), ("state", state)):
            (Path(folder) / f"{name}.xml").write_text(mm.XmlSerializer.serialize(what))
        for _ in range(options.turns):
            for method in METHODS:
                times[method].append(constraint_us(options, Path(folder), method))
            # Without forces, with all bonds rigid, its run ends in NaN within 100 steps.
            theirs.measure(min(options.steps, 20), rigid, free)
    figures = {name: (statistics.median(us), min(us)) for name, us in times.items()}
    figures["OpenMM CPU 1e-6"] = statistics.median(rigid) - statistics.median(free), min(rigid) - min(free)
    count = system.getNumConstraints()
    for name, (median, least) in figures.items():
        print(f"{bonds},{count},{name},{median:.0f},{least:.0f},{1000 * least / count:.1f}", flush=True)


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--taut", default=str(Path(__file__).resolve().parent.parent / "build/taut"))
    arguments.add_argument("--steps", type=int, default=100)
    arguments.add_argument("--turns", type=int, default=5)
    options = arguments.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    print("rigid,bonds,method,us_a_step,least_us_a_step,least_ns_a_bond")
    for bonds in SYSTEMS:
        measure(options, bonds)


if __name__ == "__main__":
    main()
