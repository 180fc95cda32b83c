#!/usr/bin/env python3
"""Measures density and compressibility of liquid water by model, method and barostat.

    benchmarks/density.py [--ps 200] [--models tip3p spce] [--methods newton feedforward baumgarte]
                          [--barostats c-rescale monte-carlo] [--set KEY=VALUE ...] [--runs DIR] > density.csv

216 molecules at 298.15 K and 1 bar, PME, Langevin's thermostat at 1/ps. The first tenth of a run is left out. Errors
are standard errors of means over ten blocks; the compressibility is (<V^2> - <V>^2)/(kT <V>), its error by leaving one
block out at a time. Runs are kept in DIR, and go on from there where they were stopped.

    benchmarks/density.py --side-by-side 8 [--models ...] [--methods newton ...] > pressure.csv

Measures whether a method shifts the density, without long averages. From the same start and with the same noise, runs
of two methods stay equal until chaos separates them after some 0.3 ps. The table has the difference of their pressures
from that of the first method over the first 0.2 ps at fixed volume [bar], over this many seeds. A difference dp moves
the density by compressibility dp, in TIP3P by 1 kg/m^3 for 18 bar.
"""
import argparse
import contextlib
import csv
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile

K_T = 8.31446261815324e-3 * 298.15 * 16.6053906717  # kT [bar nm^3]
BLOCKS = 10
SCENES = {"tip3p": ["water"], "spce": ["spce"], "tip4p2005": ["water", "--set", "build.model=tip4p2005"]}


def compressibility(volumes):
    return statistics.pvariance(volumes) / (K_T * statistics.fmean(volumes))


def cut(values):
    length = len(values) // BLOCKS
    return [values[n * length : (n + 1) * length] for n in range(BLOCKS)]


def figures(log):
    with open(log) as file:
        rows = list(csv.DictReader(file))
    rows = rows[len(rows) // 10 :]
    density = cut([float(r["Density (kg/m^3)"]) for r in rows])
    volume = cut([float(r["Box Volume (nm^3)"]) for r in rows])
    means = [statistics.fmean(block) for block in density]
    left_out = [
        compressibility([v for m, block in enumerate(volume) if m != n for v in block]) for n in range(BLOCKS)
    ]
    return {
        "ps": round(float(rows[-1]["Time (ps)"])),
        "density_kg_m3": statistics.fmean(means),
        "density_error": statistics.stdev(means) / math.sqrt(BLOCKS),
        "compressibility_1e-6_per_bar": 1e6 * compressibility(sum(volume, [])),
        "compressibility_error": 1e6 * math.sqrt((BLOCKS - 1) * statistics.pvariance(left_out)),
        "rms_rel_bond_error": math.sqrt(statistics.fmean(float(r["RMS Relative Bond Error"]) ** 2 for r in rows)),
    }


def log_of(options, out, model, method, *settings):
    command = [options.taut, "run", *SCENES[model], "--method", method]
    for setting in ["forcefield.coulomb=pme", "run.thermostat=langevin", *settings, *options.set]:
        command += ["--set", setting]
    subprocess.run([*command, "--continue", "--out", out], check=True, stdout=subprocess.DEVNULL)
    return out / "log.csv"


def run(options, folder, model, method, barostat):
    return figures(log_of(options, folder / f"{model}-{method}-{barostat}", model, method,
                          f"run.steps={500 * options.ps}", f"run.barostat={barostat}", "run.log_every=25"))


def pressures(options, folder, model, method, seed):
    out = folder / f"{model}-{method}-{seed}"
    log = log_of(options, out, model, method, "run.steps=100", "run.log_every=1", f"run.seed={seed}")
    with open(log) as file:
        return [float(row["Pressure (bar)"]) for row in csv.DictReader(file)][1:]


def side_by_side(options, folder):
    print("model,method,pressure_bar,error_bar,largest_bar")
    for model in options.models:
        seeds = range(1, options.side_by_side + 1)
        first = [pressures(options, folder, model, options.methods[0], seed) for seed in seeds]
        for method in options.methods[1:]:
            apart = [[p - q for p, q in zip(pressures(options, folder, model, method, seed), of_first)]
                     for seed, of_first in zip(seeds, first)]
            means = [statistics.fmean(run) for run in apart]
            error = statistics.stdev(means) / math.sqrt(len(means))
            largest = max(abs(d) for run in apart for d in run)
            print(f"{model},{method},{statistics.fmean(means):.3f},{error:.3f},{largest:.2f}", flush=True)


def table(options, folder):
    out = None
    for model in options.models:
        for barostat in options.barostats:
            for method in options.methods:
                row = {"model": model, "method": method, "barostat": barostat}
                row.update({k: f"{v:.4g}" if "rms" in k or k == "ps" else f"{v:.2f}"
                            for k, v in run(options, folder, model, method, barostat).items()})
                if out is None:
                    out = csv.DictWriter(sys.stdout, row, lineterminator="\n")
                    out.writeheader()
                out.writerow(row)
                sys.stdout.flush()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--taut", default=str(pathlib.Path(__file__).resolve().parent.parent / "build/taut"))
    parser.add_argument("--ps", type=int, default=200)
    parser.add_argument("--models", nargs="+", default=["tip3p", "spce"], choices=SCENES)
    parser.add_argument("--methods", nargs="+", default=["newton", "feedforward", "baumgarte"])
    parser.add_argument("--barostats", nargs="+", default=["c-rescale"])
    parser.add_argument("--set", nargs="+", default=[])
    parser.add_argument("--runs", type=pathlib.Path)
    parser.add_argument("--side-by-side", type=int, metavar="SEEDS")
    options = parser.parse_args()
    if options.side_by_side is not None and options.side_by_side < 2:
        parser.error("--side-by-side: expected 2 seeds or more")
    with contextlib.ExitStack() as stack:
        folder = options.runs or pathlib.Path(stack.enter_context(tempfile.TemporaryDirectory()))
        (side_by_side if options.side_by_side else table)(options, folder)


if __name__ == "__main__":
    main()
