"""What a step of a LAMMPS input costs a processor: messages, bytes, all-reduces, and its own time outside MPI.

    python3 count.py in.melt 1 2 4 8 16 [-var steps 0 ...]

The input's variable `steps` is set to 20 and to 40, and the difference taken; an input without it can be counted by
run() and a_step(). Time is the processor's own, so that waiting is no part of it. mpicc and mpirun are needed;
TAUT_LAMMPS names the program.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("TAUT_LAMMPS", str(HERE.parents[1] / "build/taut-lammps"))
MPIRUN = os.environ.get("TAUT_MPIRUN", "mpirun --allow-run-as-root --oversubscribe --bind-to none").split()
_made = tempfile.TemporaryDirectory()


def library():
    made = pathlib.Path(_made.name) / "count_mpi.so"
    if not made.exists():
        subprocess.run(["mpicc", "-shared", "-fPIC", "-O2", str(HERE / "count_mpi.c"), "-o", str(made)], check=True)
    return made


def run(script, ranks, folder=".", words=()):
    """Of one run: means over the processors, and the ghosts of one at its end."""
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_mpi_yield_when_idle="1",
                       OMPI_MCA_btl_vader_single_copy_mechanism="none")
    command = [*MPIRUN, "-np", str(ranks), "env", f"LD_PRELOAD={library()}", PROGRAM, "-in", str(script), *words]
    done = subprocess.run([*command, "-log", "none"], cwd=folder, env=environment, capture_output=True, text=True)
    lines = re.findall(r"^count_mpi (.*)$", done.stdout, re.M)
    if done.returncode or len(lines) != ranks:
        raise RuntimeError(done.stdout[-500:] + done.stderr[-500:])
    messages, size, reductions, _, seconds = np.mean([[float(x) for x in line.split()[1:]] for line in lines], axis=0)
    ghosts = re.findall(r"^Nghost: +(\S+)", done.stdout, re.M)
    return {"messages": messages, "kB": size / 1e3, "all-reduces": reductions, "ms": 1e3 * seconds,
            "ghosts": float(ghosts[-1]) if ghosts else 0}


def a_step(shorter, longer, steps):
    found = {name: (longer[name] - shorter[name]) / steps for name in shorter}
    return {**found, "ghosts": longer["ghosts"]}


def main(script, *words):
    numbers = [word for word in words if word.isdigit()]
    split = words.index("-var") if "-var" in words else len(words)
    for ranks in (int(n) for n in words[:split] if n in numbers):
        short, long = (run(script, ranks, words=["-var", "steps", str(n), *words[split:]]) for n in (20, 40))
        found = a_step(short, long, 20)
        print(f"{ranks:3} processors: " + ", ".join(f"{value:.4g} {name}" for name, value in found.items()), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
