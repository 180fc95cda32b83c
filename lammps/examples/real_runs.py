"""Runs of 10 ps of LAMMPS's own peptide and rhodopsin with fix taut, fix shake and fix rattle, NVE and NPT, as a table.

    TAUT_LAMMPS=build/taut-lammps python3 lammps/examples/real_runs.py peptide DATA --seeds 3
    TAUT_LAMMPS=build/taut-lammps python3 lammps/examples/real_runs.py rhodopsin DATA --fixes "taut feedforward,shake"

DATA is examples/peptide/data.peptide or bench/data.rhodo of LAMMPS. A seed is one of velocities, at the temperature of
LAMMPS's input, then 1 ps with a thermostat and fix shake; rhodopsin starts with the velocities of its file. Errors are
from the seeds, or with one seed from ten blocks of the run. The drift is that of the total energy, per degree of
freedom. Each run has one processor, and LAMMPS's OPT styles where it has them.
"""

import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import tempfile

import numpy as np

PROGRAM = os.path.abspath(os.environ.get("TAUT_LAMMPS", pathlib.Path(__file__).parents[2] / "build/taut-lammps"))
INPUT = """
units real
atom_style full
bond_style harmonic
angle_style charmm
dihedral_style charmm
improper_style harmonic
pair_style lj/charmm/coul/long 8.0 10.0
pair_modify mix arithmetic
kspace_style pppm 1e-4
read_data {data}
special_bonds charmm
neighbor 2.0 bin
neigh_modify delay 5 every 1
timestep 2.0
{start}
{fixes}
thermo 10
thermo_modify norm no
thermo_style custom step temp etotal press pe density
run {steps}
"""
DRAW = """
velocity all create {temperature} {seed} loop geom
fix hold all shake 1e-8 500 0 {bonds}
fix move all nvt temp {temperature} {temperature} 100 tchain 1
run 500
unfix hold
unfix move
reset_timestep 0
"""
SYSTEMS = {"peptide": dict(temperature=275.0, start=DRAW, bonds="b 4 6 8 10 12 14 18 a 31",
                           npt="npt temp 275 275 100 iso 1 1 1000 mtk no pchain 0 tchain 1"),
           "rhodopsin": dict(temperature=300.0, start="", bonds="m 1.0 a 232",
                             npt="npt temp 300 300 100 z 0 0 1000 mtk no pchain 0 tchain 1")}
HELD = {"taut feedforward": "taut feedforward", "taut baumgarte": "taut baumgarte", "shake": "shake 1e-8 500 0",
        "rattle": "rattle 1e-8 500 0"}
KCAL_A_FS = 4.184 * 1e6  # in kJ/mol/ns


def run(folder, name, data, hold, ensemble, seed, steps):
    """Columns of the last run: time, temperature, total energy, pressure, potential energy, density; degrees of freedom."""
    system = SYSTEMS[name]
    move = "nve" if ensemble == "NVE" else system["npt"]
    script = folder / f"in.{hold.split()[0]}{hold.split()[1]}{ensemble}{seed}"
    fixes = [f"fix hold all {hold} {system['bonds']}", f"fix move all {move}"]
    if "rattle" in hold or (ensemble == "NVE" and "taut" not in hold):
        fixes.reverse()  # fix rattle stands after whatever integrates, the others before a barostat
    start = system["start"].format(seed=4710 + seed, **system)
    script.write_text(INPUT.format(data=data, start=start, steps=steps, fixes="\n".join(fixes)))
    command = ["mpirun", "--allow-run-as-root", "--oversubscribe", "--bind-to", "none", "-np", "1", PROGRAM,
               "-in", str(script), "-log", "none", "-sf", "opt"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stdout[-800:] + done.stderr[-800:])
    last = done.stdout[done.stdout.rindex("\nStep "):done.stdout.rindex("\nLoop time")]
    columns = np.array([line.split() for line in re.findall(r"^ +\d.*", last, re.M)], float).T  # warnings left out
    columns[0] *= 2.0  # fs
    kinetic = columns[2] - columns[4]
    return columns, np.median(2 * kinetic / (0.0019872067 * columns[1]))


def show(name, ensemble, hold, runs):
    blocks = [np.array_split(columns, 10, axis=1) for columns, _ in runs]
    if len(runs) > 1:
        means = np.array([columns[:, 1:].mean(axis=1) for columns, _ in runs])
        slopes = np.array([np.polyfit(columns[0], columns[2], 1)[0] for columns, _ in runs])
        slope, slope_error = slopes.mean(), slopes.std(ddof=1) / len(runs)**0.5
    else:
        means = np.array([block.mean(axis=1) for block in blocks[0]])
        (slope, _), covariance = np.polyfit(means[:, 0], means[:, 2], 1, cov=True)
        slope_error = covariance[0, 0]**0.5
    mean, error = means.mean(axis=0), means.std(axis=0, ddof=1) / len(means)**0.5
    drift = [number * KCAL_A_FS / runs[0][1] for number in (slope, slope_error)]
    cells = [f"{drift[0]:.3f} ± {drift[1]:.3f}" if ensemble == "NVE" else "",
             *(f"{mean[c]:.{digits}f} ± {error[c]:.{digits}f}" for c, digits in ((1, 2), (4, 0), (3, 0), (5, 4)))]
    print(f"| {name}, {ensemble}, {hold} | " + " | ".join(cells) + " |", flush=True)


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("system", choices=SYSTEMS)
    ask.add_argument("data", type=pathlib.Path)
    ask.add_argument("--seeds", type=int, default=1)
    ask.add_argument("--steps", type=int, default=5000)
    ask.add_argument("--fixes", default=",".join(HELD))
    ask.add_argument("--jobs", type=int, default=2, help="runs side by side")
    asked = ask.parse_args()
    if unknown := set(asked.fixes.split(",")) - set(HELD):
        ask.error(f"no fix {min(unknown)}: expected {', '.join(HELD)}")
    if asked.steps < 200:
        ask.error("ten blocks need 200 steps")
    print("| | drift, kJ/mol/ns | temperature, K | potential, kcal/mol | pressure, atm | density, g/cm³ |\n"
          "|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(asked.jobs) as pool:
        begun = {(ensemble, hold): [pool.submit(run, pathlib.Path(folder), asked.system, asked.data.resolve(), HELD[hold],
                                                ensemble, seed, asked.steps) for seed in range(asked.seeds)]
                 for ensemble in ("NVE", "NPT") for hold in asked.fixes.split(",")}
        for (ensemble, hold), runs in begun.items():
            show(asked.system, ensemble, hold, [each.result() for each in runs])


if __name__ == "__main__":
    main()
