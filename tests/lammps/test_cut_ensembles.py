"""Chains longer than a processor's part on 2, 3 and 4 processors as on one: 500 steps on two, 150 on more."""

import struct

import numpy as np
import pytest

import inputs
import lammps
import systems

OUTPUT = "thermo_style custom step temp etotal press f_hold[1] f_hold[3] f_hold[4]\nthermo_modify format float %.15g\nthermo 50\n"
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
    for ranks, steps in ((2, 500), (3, 150), (4, 150)) if name == "nve" else ((3, 150),):
        alone, atoms = trajectory(folder, run, name, 1, steps)
        cut, cut_atoms = trajectory(folder, run, name, ranks, steps)
        assert cut["f_hold[3]"].max() > 0 and alone["f_hold[3]"].max() == 0  # it is cut, and was not
        assert np.abs(cut_atoms - atoms).max() < 1e-7
        assert cut["f_hold[1]"].max() < 2 * alone["f_hold[1]"].max() + 1e-9
        # Momentum is exact at the end of a run, but for what a thermostat makes of the last two steps.
        assert np.abs(cut_atoms[:, 3:].sum(axis=0)).max() < (1e-9 if "integrate" in CASES[name] else 1e-11)


def langevin(run, ranks, more=""):
    """What it printed, and the table. Each processor has random numbers of its own: no trajectory is another's."""
    text = inputs.of(inputs.CHAINS, dt=0.002, integrate="fix warm all langevin 1 1 0.5 4711\nfix move all nve",
                     rest=OUTPUT.replace("thermo 50", "thermo 1") + "run 300\n")
    output = run(text.replace(" b 1\n", f" b 1 {more}\n"), ranks)
    return output, lammps.table(output)


@pytest.mark.parametrize("overlap", [3, 8])
def test_what_random_forces_leave_is_exchanged(run, overlap):
    """Nobody foresees them: what lies beyond a cut is guessed worse, and exchanges tell it, as many as it takes."""
    whole, (output, cut) = langevin(run, 1)[1], langevin(run, 3, f"overlap {overlap}")
    assert cut["f_hold[3]"][1:].min() == overlap
    assert cut["f_hold[1]"].max() < 1e-7  # the tolerance
    assert 1 <= cut["f_hold[4]"][-50:].mean() < 3 and "left off" not in output
    assert cut["Temp"][50:].mean() == pytest.approx(whole["Temp"][50:].mean(), abs=0.3)


def test_too_few_exchanges_are_not_passed_over(run):
    output, cut = langevin(run, 3, "exchanges 0")
    assert cut["f_hold[1]"].max() > 1e-7
    assert "bonds between processors are left off by" in output


def test_exchanges_come_and_go_with_random_forces(run):
    noise = "fix warm all langevin {} 4711\n"  # in its place before fix taut, also the second time
    text = inputs.of(inputs.CHAINS, dt=0.002, integrate=noise.format("0 0 1e9") + "fix move all nve",
                     rest=OUTPUT + "run 150\n" + noise.format("1 1 0.5") + "run 200\n")
    output = run(text, 2)
    calm, warm = (lammps.table(output, n)["f_hold[4]"] for n in (-2, -1))
    assert calm[0] == 2 and calm[-1] == 0 and warm[0] == 0 and warm[-1] >= 1
    assert lammps.table(output)["f_hold[1]"][-2:].max() < 1e-7


@pytest.mark.parametrize("ranks", [1, 3])
def test_restart_on_other_processors(folder, run, ranks):
    rest = OUTPUT + "run 100\nwrite_restart half\nrun 400\n" + inputs.END.format(dump="whole.dump")
    run(inputs.of(inputs.CHAINS, dt=0.002, heat=0.5, rest=rest), 2)
    text = inputs.of(inputs.CHAINS, dt=0.002, rest=OUTPUT + "run 400\n" + inputs.END.format(dump="parts.dump"))
    text = text.replace("read_data chains.data", "read_restart half").replace("velocity all create", "#")
    run(text.replace("atom_style full", ""), ranks)
    assert np.abs(lammps.dump(folder / "whole.dump") - lammps.dump(folder / "parts.dump")).max() < 1e-7


def test_a_restart_file_of_another_version_is_refused(folder, run):
    """What an atom has of the fix begins with its size, the steps known and the number of its bonds: a version whose
    bonds take other room wrote sizes that do not fit."""
    run(inputs.of(inputs.CHAINS, dt=0.002, rest="run 5\nwrite_restart half\n"))
    path = folder / "half"
    data, ends = path.read_bytes(), 0
    for size in range(4, 100):  # an atom at the end of a chain has one bond
        for steps in range(1, 20):
            known = struct.pack("<3d", size, steps, 1)
            ends += data.count(known)
            data = data.replace(known, struct.pack("<3d", size, steps, 2))
    assert ends == 12
    path.write_bytes(data)
    text = inputs.of(inputs.CHAINS, dt=0.002, rest="run 5\n").replace("atom_style full", "")
    text = text.replace("read_data chains.data", "read_restart half").replace("velocity all create", "#")
    with pytest.raises(lammps.Failed, match="another version of fix taut wrote this restart file"):
        run(text)
