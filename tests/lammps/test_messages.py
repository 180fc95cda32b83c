"""What processors tell each other, counted by lammps/cost/count.py's library."""

import pathlib
import shutil
import sys

import pytest

import inputs
import lammps
import systems

sys.path.insert(0, str(pathlib.Path(lammps.__file__).parents[2] / "lammps/cost"))
import count  # noqa: E402

pytestmark = pytest.mark.skipif(not shutil.which("mpicc"), reason="no mpicc")


def sent(folder, text, **given):
    """Messages and kB a processor and step, of steps 20 to 60, on two processors. Lists are built before alone."""
    text = text.replace("every 1 delay 0 check yes", "every 1000 delay 0 check no")
    def total(steps):
        (folder / "in.counted").write_text(inputs.of(text, rest=f"run {steps}\n", **given))
        return count.run("in.counted", 2, folder)
    return count.a_step(total(20), total(60), 40)


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


def test_bytes_are_those_of_the_model(folder):
    """Of whole molecules, which share nothing with other processors in a run's first steps."""
    (folder / "water.data").write_text(systems.water(8).text([15.9994, 1.008]))
    shutil.copy(pathlib.Path(count.__file__).parent / "in.water", folder)
    found = count.counted("in.water", 2, folder)
    assert found["kB"] == pytest.approx(found["kB by the model"], rel=0.01)
