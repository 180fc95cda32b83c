#!/usr/bin/env python3
"""Finds the largest step at which feedforward, shake and newton are stable, and their errors beyond it:

    benchmarks/limits.py [CASE ...] > benchmarks/results/limits.csv

A step is stable if 1000 of them run to the end. It is found to 3 %. TAUT names the command, build/taut by default.
"""
import os
import re
import subprocess
import sys
import tempfile

TAUT = os.environ.get("TAUT", "build/taut")
STEPS = 1000
DNA = "--openmm tests/data/dna-hbonds.system.xml.gz tests/data/dna-hbonds.state.xml.gz"
BAROSTAT = "water --set run.thermostat=langevin run.barostat_every=1 run.barostat="
# name: arguments, a step that holds [fs]
CASES = {
    "one rotor": ("diatomic", 50),
    "free chain": ("freely_jointed --set build.chains=10", 80),
    "double pendulum": ("double_pendulum", 20),
    "water": ("water", 5),
    "decane": ("decane", 5),
    "melt": ("melt", 8),
    "DNA, bonds to H": (DNA + " --set run.velocities=draw run.temperature_k=300", 3),
    "hot: water, 1000 K": ("water --set run.velocities=draw run.temperature_k=1000", 3),
    "hot: decane, 1000 K": ("decane --set run.velocities=draw run.temperature_k=1000", 3),
    "collisions: melt, kT x 4": ("melt --set run.velocities=draw run.temperature_k=481", 4),
    "light: systems/hard/hot_hydrogens": ("systems/hard/hot_hydrogens.toml", 5),
    "light: systems/hard/mass_ratio": ("systems/hard/mass_ratio.toml", 3),
    "minimised: water": ("water --set run.minimise=true run.velocities=draw", 5),
    "rescaling, 0.02 ps: water": ("water --set run.thermostat_ps=0.02", 5),
    "Langevin, 1/ps: water": ("water --set run.thermostat=langevin run.friction_per_ps=1", 5),
    "c-rescale every step: water": (BAROSTAT + "c-rescale run.barostat_ps=0.1", 5),
    "Monte Carlo every step: water": (BAROSTAT + "monte-carlo", 5),
    "restart from a step of 1 fs: water": ("water --set build.start={start}", 5),
    "Langevin, 100/ps: water": ("water --set run.thermostat=langevin run.friction_per_ps=100", 5),
}
METHODS = {"feedforward": "feedforward", "feedforward (order 0)": "feedforward --set method.extrapolation=0",
           "shake": "shake", "newton": "newton"}


def run(arguments, method, step):
    """Whether it held, and its largest bond error or what it said."""
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(
            f"{TAUT} run {arguments} --method {method} --dt-fs {step:.6g} --steps {STEPS} --out {folder}/run",
            shell=True, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode == 2:
        sys.exit(done.stderr)
    if done.returncode != 0:
        return False, done.stderr.splitlines()[0].removeprefix("taut: the simulation failed: ")
    error = re.search("bond error.*largest (.*?),", done.stdout)[1]
    return True, error + (" (in doubt)" if "in doubt: bonds" in done.stdout else "")


def largest(arguments, method, step):
    """[fs], the largest bond error there, and what it says beyond."""
    good, bad, error, said = 0.0, 0.0, "", ""
    while not (good and bad) or bad / good > 1.03:
        held, text = run(arguments, method, step)
        if held:
            good, error = step, text
        else:
            bad, said = step, text
        step = (good * bad) ** 0.5 if good and bad else step * 1.5 if good else step / 1.5
        if not 0.01 < step < 500:
            break
    return good, error, said


def ran_at_1_fs(folder):
    """The last state of such a run of water."""
    subprocess.run(f"{TAUT} run water --method newton --dt-fs 1 --steps 500 --out {folder}/run", shell=True, check=True,
                   stdout=subprocess.DEVNULL)
    return f"{folder}/run/final.start.toml"


def table(wanted, start):
    print("case,method,largest_step_fs,largest_bond_error,beyond_it", flush=True)
    for name, (arguments, step) in CASES.items():
        if wanted and not any(name.startswith(w) for w in wanted):
            continue
        for method, how in METHODS.items():
            good, error, said = largest(arguments.replace("{start}", start), how, step)
            print(f'"{name}",{method},{good:.3g},{error},"{said}"', flush=True)


def main():
    with tempfile.TemporaryDirectory() as folder:
        table(sys.argv[1:], ran_at_1_fs(folder))


main()
