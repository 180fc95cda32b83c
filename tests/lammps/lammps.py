"""Runs taut-lammps on so many processors, and reads what comes out."""

import os
import pathlib
import re
import subprocess

import numpy as np

MPIRUN = os.environ.get("TAUT_MPIRUN", "mpirun --allow-run-as-root --oversubscribe --bind-to none").split()
PROGRAM = os.environ.get("TAUT_LAMMPS", str(pathlib.Path(__file__).parents[2] / "build/taut-lammps"))


class Failed(Exception):
    pass


def run(folder, text, ranks=1, omp=0, **variables):
    """The output of an input; Failed, with the error line, if LAMMPS stops. `omp`: of its own OPENMP package so many
    threads, OMP_NUM_THREADS not said."""
    script = pathlib.Path(folder) / f"in.{len(list(pathlib.Path(folder).glob('in.*')))}"
    script.write_text(text)
    several = [*MPIRUN, "-np", str(ranks)] if ranks > 1 else []  # mpirun takes two seconds to end after an error
    command = [*several, PROGRAM, "-in", script.name, "-log", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    # Open MPI looks for no other machines and networks, which takes it a third of a second.
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_btl_vader_single_copy_mechanism="none",
                       OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_ess_singleton_isolated="1", OMPI_MCA_pml="ob1",
                       OMPI_MCA_btl="self,vader")
    if omp:
        del environment["OMP_NUM_THREADS"]
        command += ["-sf", "omp", "-pk", "omp", str(omp)]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment, timeout=600)
    error = re.search(r"ERROR.*", done.stdout + done.stderr)
    if error or done.returncode:
        raise Failed(error.group(0) if error else done.stdout[-300:] + done.stderr[-300:])
    return done.stdout


def has_package(name):
    """Whether the LAMMPS under test has it."""
    told = subprocess.run([PROGRAM, "-h"], capture_output=True, text=True, timeout=60).stdout
    return name in told.partition("Installed packages:")[2].partition("List of individual")[0].split()


def table(output, which=-1):
    """The columns of the thermo output of one run, by name."""
    lines = re.sub(r"^WARNING.*\n", "", output, flags=re.M)
    blocks = re.findall(r"^\s*(Step .*)\n((?:\s*[-\d].*\n)+)", lines, re.M)
    names = blocks[which][0].split()
    rows = [[float(word) for word in line.split()] for line in blocks[which][1].splitlines()
            if len(line.split()) == len(names)]
    return dict(zip(names, np.array(rows).T))


def dump(path):
    """The last frame of a dump sorted by id: numbers, an atom a row, ids left out."""
    text = pathlib.Path(path).read_text()
    frame = text[text.rindex("ITEM: ATOMS"):].splitlines()[1:]
    return np.array([[float(word) for word in line.split()[1:]] for line in frame])
