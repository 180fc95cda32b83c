#!/usr/bin/env python3
"""Measures how runs of solvated protein grow with their atoms: a step, the start, the minimiser, checkpoints, memory.

    benchmarks/growth.py FOLDER [--build build] [--systems ala2,dhfr,dhfr8,dhfr48] [--threads 1]

FOLDER holds what real_systems.py makes. Mixed precision, newton, 2 fs, PME. A step is the least of three runs of 50 steps
or more, as many as half a million moves of an atom. The start is the run of no step, from the files to the first row and
the last file; the minimiser is what a move of its adds to the start. Memory is the largest resident set of the run.
"""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

import machine


def run(taut, folder, name, threads, steps, settings, out):
    """Runs taut; returns seconds, the largest resident set [MiB] and what was printed."""
    files = [f"{folder}/{name}.system.xml", f"{folder}/{name}.state.xml"]
    command = [taut, "run", "--openmm", *files, "--steps", str(steps), "--precision", "mixed", "--threads", str(threads),
               "--out", out, "--overwrite", "--set", "run.dt_fs=2", f"run.log_every={max(steps, 1)}", *settings]
    started = time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        text = process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise SystemExit(text)
    return time.monotonic() - started, usage.ru_maxrss / 1024, text


def us_of_a_step(measure, out, steps):
    """Runs that many steps; returns the microseconds that one of them took by taut's own clock."""
    measure(steps)
    return json.loads((pathlib.Path(out) / "summary.json").read_text())["us_per_step"]


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--systems", default="ala2,dhfr,dhfr8,dhfr48")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=3, help="runs whose fastest step counts")
    options = parser.parse_args()
    print(f"# {machine.describe()}; {options.threads} threads, mixed precision")
    print("system,atoms,ns_a_step_and_atom,us_of_start_an_atom,us_of_minimiser_a_move_and_atom,checkpoint_bytes_an_atom,"
          "memory_bytes_an_atom")
    for name in options.systems.split(","):
        with tempfile.TemporaryDirectory() as out:
            def measure(steps, *settings):
                return run(options.build / "taut", options.folder, name, options.threads, steps, settings, out)
            start, memory, text = measure(0)
            atoms = int(re.search(r"atoms (\d+)", text)[1])
            checkpoint = (pathlib.Path(out) / "checkpoint.cbor").stat().st_size
            a_step = min(us_of_a_step(measure, out, max(50, 500_000 // atoms)) for _ in range(options.repeats))
            minimised, _, text = measure(0, "run.minimise=true")
            moves = int(re.search(r"minimised in (\d+) moves", text)[1])
            print(f"{name},{atoms},{1000 * a_step / atoms:.0f},{1e6 * start / atoms:.1f},{1e6 * (minimised - start) / moves / atoms:.2f},"
                  f"{checkpoint / atoms:.0f},{memory * 2**20 / atoms:.0f}", flush=True)


if __name__ == "__main__":
    main()
