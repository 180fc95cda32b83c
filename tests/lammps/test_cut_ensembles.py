"""Chains longer than a processor's part over 500 steps, on 2, 3 and 4 processors as on one."""

import numpy as np
import pytest

import inputs
import lammps
import systems

OUTPUT = "thermo_style custom step temp etotal press f_hold[1] f_hold[3]\nthermo_modify format float %.15g\nthermo 50\n"
CASES = {
    "nve": {},
    "newton off": dict(newton="off"),
    "nvt": dict(integrate="fix move all nvt temp 1 1 0.2"),
    "skewed npt": dict(tilt=(2.0, -1.0, 1.0), integrate="fix move all npt temp 1 1 0.2 iso 1 1 2.0"),
    "balance": dict(integrate="fix even all balance 20 1.0 shift xyz 5 1.0\nfix move all nve"),
    "around the box": dict(box=13.0, cutoff=12),  # chains of 40 along x
}


def trajectory(folder, run, name, ranks, steps=500):
    given = dict({"dt": 0.002, "heat": 0.5}, **CASES[name])
    chains = systems.chains(6, 40, straight="box" in given)
    chains.tilt, chains.box = given.pop("tilt", None), np.full(3, given.pop("box", chains.box[0]))
    (folder / "chains.data").write_text(chains.text([1.0]))
    rest = OUTPUT + f"run {steps}\n" + inputs.END.format(dump="last.dump")
    output = run(inputs.of(inputs.CHAINS, **given, rest=rest), ranks)
    return lammps.table(output), lammps.dump(folder / "last.dump")


@pytest.mark.parametrize("name", CASES)
def test_any_processors_give_the_same(folder, run, name):
    alone, atoms = trajectory(folder, run, name, 1)
    for ranks in (2, 3, 4) if name == "nve" else (3,):
        cut, cut_atoms = trajectory(folder, run, name, ranks)
        assert cut["f_hold[3]"].max() > 0 and alone["f_hold[3]"].max() == 0  # it is cut, and was not
        assert np.abs(cut_atoms - atoms).max() < 1e-7
        assert cut["f_hold[1]"].max() < 2 * alone["f_hold[1]"].max() + 1e-9
        # Momentum is exact at the end of a run, but for what a thermostat makes of the last two steps.
        assert np.abs(cut_atoms[:, 3:].sum(axis=0)).max() < (1e-9 if "integrate" in CASES[name] else 1e-11)


def test_langevin_forces_leave_bonds_at_their_floor(folder, run):
    """Nobody foresees random forces: what lies beyond a cut is guessed worse, and exchanges tell it. Each processor has
    random numbers of its own, so that no trajectory is another's."""
    def residual_and_temperature(ranks, more=""):
        integrate = "fix warm all langevin 1 1 0.5 4711\nfix move all nve"
        text = inputs.of(inputs.CHAINS, dt=0.002, integrate=integrate, rest=OUTPUT + "run 500\n")
        found = lammps.table(run(text.replace(" b 1\n", f" b 1 {more}\n"), ranks))
        assert (found["f_hold[3]"].max() > 0) == (ranks > 1)
        return found["f_hold[1]"][1:].max(), found["Temp"][5:].mean()

    whole, temperature = residual_and_temperature(1)
    cut, cut_temperature = residual_and_temperature(3)
    assert cut < 1e-5 and cut_temperature == pytest.approx(temperature, abs=0.3)
    assert residual_and_temperature(3, "exchanges 2")[0] < 2 * whole


@pytest.mark.parametrize("ranks", [1, 3])
def test_restart_on_other_processors(folder, run, ranks):
    rest = OUTPUT + "run 100\nwrite_restart half\nrun 400\n" + inputs.END.format(dump="whole.dump")
    run(inputs.of(inputs.CHAINS, dt=0.002, heat=0.5, rest=rest), 2)
    text = inputs.of(inputs.CHAINS, dt=0.002, rest=OUTPUT + "run 400\n" + inputs.END.format(dump="parts.dump"))
    text = text.replace("read_data chains.data", "read_restart half").replace("velocity all create", "#")
    run(text.replace("atom_style full", ""), ranks)
    assert np.abs(lammps.dump(folder / "whole.dump") - lammps.dump(folder / "parts.dump")).max() < 1e-7
