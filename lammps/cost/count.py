"""What a step of a LAMMPS input costs a processor: messages, bytes, all-reduces, and its own time outside MPI.

    python3 count.py in.melt 1 2 4 8 16 [-var steps 0 ...]

The input's variable `steps` is set to 20 and to 40, and the difference taken; an input without it can be counted by
run() and a_step(). Beside it stands what modelled_kb() says of fix taut without exchanges of its own. Time is the
processor's own, so that waiting is no part of it. mpicc and mpirun are needed; TAUT_LAMMPS names the program.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

BUILD_STEPS = 10  # between builds of lists, in in.water and in.chains
HERE = pathlib.Path(__file__).resolve().parent
PROGRAM = os.environ.get("TAUT_LAMMPS", str(HERE.parents[1] / "build/taut-lammps"))
MPIRUN = os.environ.get("TAUT_MPIRUN", "mpirun --allow-run-as-root --oversubscribe --bind-to none").split()
_made = tempfile.TemporaryDirectory()


def library():
    made = pathlib.Path(_made.name) / "count_mpi.so"
    if not made.exists():
        subprocess.run(["mpicc", "-shared", "-fPIC", "-O2", str(HERE / "count_mpi.c"), "-o", str(made)], check=True)
    return made


def output_of(script, ranks, folder=".", words=()):
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_mpi_yield_when_idle="1",
                       OMPI_MCA_btl_vader_single_copy_mechanism="none")
    command = [*MPIRUN, "-np", str(ranks), "env", f"LD_PRELOAD={library()}", PROGRAM, "-in", str(script), *words]
    done = subprocess.run([*command, "-log", "none"], cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode or len(re.findall(r"^count_mpi ", done.stdout, re.M)) != ranks:
        raise RuntimeError(done.stdout[-500:] + done.stderr[-500:])
    return done.stdout


def figures(output):
    """Of one run: means over the processors, and the ghosts of one at its end."""
    lines = re.findall(r"^count_mpi (.*)$", output, re.M)
    messages, size, reductions, _, seconds = np.mean([[float(x) for x in line.split()[1:]] for line in lines], axis=0)
    ghosts = re.findall(r"^Nghost: +(\S+)", output, re.M)
    return {"messages": messages, "kB": size / 1e3, "all-reduces": reductions, "ms": 1e3 * seconds,
            "ghosts": float(ghosts[-1]) if ghosts else 0}


def run(*asked):
    return figures(output_of(*asked))


def a_step(shorter, longer, steps):
    found = {name: (longer[name] - shorter[name]) / steps for name in shorter}
    return {**found, "ghosts": longer["ghosts"]}


def modelled_kb(output, ghosts):
    """What a processor sends in a step, from the number of its ghosts [kB].

    Ghosts fill a layer around the processor's part of the box, made dimension by dimension; those of dimensions that
    are split come by messages. A ghost's position and force are three numbers each; when lists are built it is eight in
    place of its position, and thirteen of fix taut: how many bonds, and six for each of its two.
    """
    atoms = int(re.search(r"with (\d+) atoms", output)[1])
    edges = [float(edge) for edge in re.search(r"\) to \((.*?)\)", output)[1].split()]
    grid = [int(count) for count in re.search(r"(\d+) by (\d+) by (\d+) MPI", output).groups()]
    own = [edge / count for edge, count in zip(edges, grid)]
    density = atoms / np.prod(edges)

    def layer(dimensions, depth):
        wide = [edge + 2 * depth for edge in own]
        return density * sum(2 * depth * np.prod(wide[:d]) * np.prod(own[d + 1:]) for d in dimensions)
    thin, thick = 0.0, max(edges)
    for _ in range(60):
        depth = (thin + thick) / 2
        thin, thick = (depth, thick) if layer(range(3), depth) < ghosts else (thin, depth)
    sent = layer([d for d in range(3) if grid[d] > 1], depth)
    return 8e-3 * sent * (6 + (8 - 3 + 13) / BUILD_STEPS)


def counted(script, ranks, folder=".", words=()):
    """Of a step between lists that are built every BUILD_STEPS."""
    short, long = (output_of(script, ranks, folder, ["-var", "steps", str(n), *words]) for n in (20, 40))
    found = a_step(figures(short), figures(long), 20)
    return {**found, "kB by the model": modelled_kb(long, found["ghosts"])}


def main(script, *words):
    numbers = [word for word in words if word.isdigit()]
    split = words.index("-var") if "-var" in words else len(words)
    for ranks in (int(n) for n in words[:split] if n in numbers):
        found = counted(script, ranks, words=words[split:])
        print(f"{ranks:3} processors: " + ", ".join(f"{value:.4g} {name}" for name, value in found.items()), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
