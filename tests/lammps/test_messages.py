"""What processors tell each other, counted by count_mpi.c."""

import os
import pathlib
import re
import shutil
import subprocess

import numpy as np
import pytest

import inputs
import lammps
import systems

pytestmark = pytest.mark.skipif(not shutil.which("mpicc"), reason="no mpicc")


def sent(folder, text, **given):
    """Messages and kB a processor and step, of steps 20 to 60, on two processors. Lists are built before alone."""
    counter, source = folder / "count_mpi.so", pathlib.Path(__file__).with_name("count_mpi.c")
    subprocess.run(["mpicc", "-shared", "-fPIC", "-O2", source, "-o", counter], check=True)
    text = text.replace("every 1 delay 0 check yes", "every 1000 delay 0 check no")
    def total(steps):
        (folder / "in.counted").write_text(inputs.of(text, rest=f"run {steps}\n", **given))
        environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_btl_vader_single_copy_mechanism="none")
        done = subprocess.run([*lammps.MPIRUN, "-np", "2", "env", f"LD_PRELOAD={counter}", lammps.PROGRAM, "-in", "in.counted",
                               "-log", "none"], cwd=folder, env=environment, capture_output=True, text=True)
        counts = re.findall(r"^count_mpi (\d+) (\d+)$", done.stdout, re.M)
        assert len(counts) == 2, done.stdout[-500:] + done.stderr[-500:]
        return np.mean(np.array(counts, float), axis=0)
    messages, size = (total(60) - total(20)) / 40
    return {"messages": messages, "kB": size / 1e3}


def test_ghosts_that_no_processor_solves_with_are_told_nothing(folder):
    """The border goes through the middle one of three layers: few of the ghosts are parts of molecules it cuts."""
    (folder / "water.data").write_text(systems.water(3).text([15.9994, 1.008]))
    shake = sent(folder, inputs.WATER, fix="shake 1e-4 500 0")
    taut = sent(folder, inputs.WATER, fix="taut feedforward")
    assert taut["messages"] == shake["messages"]
    assert taut["kB"] < 0.8 * shake["kB"]


def test_deep_ghosts_cost_no_more_multipliers(folder):
    """What the fix says of chains depends on what is solved, not on how far ghosts reach."""
    near, far = (sent(folder, inputs.CHAINS, dt=0.002, cutoff=reach, fix="taut feedforward overlap 1 exchanges 3")["kB"]
                 - sent(folder, inputs.CHAINS, dt=0.002, cutoff=reach, fix="taut feedforward overlap 1 exchanges 1")["kB"]
                 for reach in (4, 6))
    assert far == pytest.approx(near, rel=0.2)
