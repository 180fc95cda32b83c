"""Drift of energy and mean temperature of long runs of in.water and in.melt, as a table with errors.

    TAUT_LAMMPS=build/taut-lammps python3 lammps/examples/long_runs.py [STEPS]      # 100000

The total energy's and the temperature's means over ten blocks: the slope of a line through the energies, per degree
of freedom, and its error; the mean of the temperatures and its error.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

import systems

HERE = pathlib.Path(__file__).parent
PROGRAM = os.path.abspath(os.environ.get("TAUT_LAMMPS", HERE.parents[1] / "build/taut-lammps"))
SIDE, CHAINS, BEADS = 3, 5, 60
WATER = dict(input="in.water", given=dict(cutoff=4.6, dt=1, relax=5000), freedom=6 * SIDE**3 - 3, units="kJ/mol/ns",
             scale=4.184 * 1e6, nvt="nvt temp 300 300 100")  # from kcal/mol/fs
MELT = dict(input="in.melt", given=dict(dt=0.005), freedom=3 * CHAINS * BEADS - CHAINS * (BEADS - 1) - 3, units="kT/tau",
            scale=1, nvt="nvt temp 1 1 0.5")
HELD = {"fix rattle 1e-10": "rattle 1e-10 500 0", "taut feedforward": "taut feedforward", "taut baumgarte": "taut baumgarte"}


def run(folder, system, **variables):
    """Columns of the last run's thermo output: time, temperature, total energy."""
    command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-np", "1", PROGRAM, "-in",
               str(HERE / system["input"]), "-log", "none"]
    for name, value in dict(system["given"], every=100, **variables).items():
        command += ["-var", name, str(value)]
    output = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True).stdout
    names, rows = re.findall(r"^\s*(Step .*)\n((?:\s*[-\d].*\n)+)", output, re.M)[-1]
    columns = dict(zip(names.split(), np.array([line.split() for line in rows.splitlines()], float).T))
    return columns["Step"] * system["given"]["dt"], columns["Temp"], columns["TotEng"]


def line(folder, name, system, **variables):
    time, temperature, energy = ([block.mean() for block in np.array_split(column[1:], 10)]
                                 for column in run(folder, system, **variables))
    (slope, _), covariance = np.polyfit(time, energy, 1, cov=True)
    drift, error = (number * system["scale"] / system["freedom"] for number in (slope, covariance[0, 0]**0.5))
    shown = f"{drift:.2g} ± {error:.1g} {system['units']}" if variables["move"] == "nve" else ""
    print(f"| {name} | {shown} | {np.mean(temperature):.4g} ± {np.std(temperature, ddof=1) / 10**0.5:.1g} |", flush=True)


def main(steps=100_000):
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "water.data").write_text(systems.water(SIDE).text([15.9994, 1.008]))
        (pathlib.Path(folder) / "melt.data").write_text(
            systems.chains(CHAINS, BEADS, bond=0.97, density=0.85).text([1.0]))
        print("| | drift | mean temperature |\n|---|---|---|")
        for what, system in (("melt", MELT), ("water", WATER)):
            for move, ensemble in (("nve", "NVE"), (system["nvt"], "NVT")):
                for name, hold in HELD.items():
                    if what == "water" or "taut" in name:  # chains are longer than fix rattle holds
                        line(folder, f"{what}, {ensemble}, {name}", system, hold=hold, move=move, steps=steps)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
