"""Clusters that every processor knows whole: water, methane."""

import numpy as np
import pytest

import inputs
import lammps

TIGHT = "taut feedforward tol 1e-14"
PAIRS = {"water": (inputs.WATER, dict(dt=0.5)), "methane": (inputs.METHANE, dict(dt=0.002))}


def trajectory(folder, run, system, fix, ranks=1, steps=100, **given):
    text, values = PAIRS[system]
    rest = inputs.THERMO + f"run {steps}\n" + inputs.END.format(dump="last.dump")
    output = run(inputs.of(text, **{**values, "fix": fix, "rest": rest, **given}), ranks)
    return lammps.table(output), lammps.dump(folder / "last.dump")


def test_water_is_that_of_fix_rattle(folder, run):
    """Positions, velocities, energies, pressure, temperature and so degrees of freedom."""
    theirs, their_atoms = trajectory(folder, run, "water", "rattle 1e-14 1000 0")
    ours, our_atoms = trajectory(folder, run, "water", TIGHT + " clear yes")
    assert np.abs(our_atoms[:, :3] - their_atoms[:, :3]).max() < 1e-9
    assert np.abs(our_atoms[:, 3:] - their_atoms[:, 3:]).max() < 1e-9
    for column in ("Temp", "PotEng", "KinEng"):
        assert np.allclose(ours[column], theirs[column], rtol=1e-9), column


def test_water_is_that_of_fix_shake(folder, run):
    theirs, their_atoms = trajectory(folder, run, "water", "shake 1e-14 1000 0", integrate="fix p all rattle 1e-13 500 0 b 1 a 1\nrun 0\nunfix p\nfix move all nve")
    ours, our_atoms = trajectory(folder, run, "water", TIGHT, integrate="fix p all rattle 1e-13 500 0 b 1 a 1\nrun 0\nunfix p\nfix move all nve")
    assert np.abs(our_atoms - their_atoms).max() < 1e-9
    for column in ("Temp", "PotEng", "KinEng", "Press", "Pxx", "Pxy"):
        assert np.allclose(ours[column][1:], theirs[column][1:], rtol=1e-8, atol=1e-6), column


@pytest.mark.parametrize("system", PAIRS)
@pytest.mark.parametrize("given", [dict(ranks=2), dict(ranks=2, newton="off", processors="1 1 2"), dict(ranks=4)])
def test_any_processors_give_the_same(folder, run, system, given):
    alone, alone_atoms = trajectory(folder, run, system, TIGHT)
    shared, shared_atoms = trajectory(folder, run, system, TIGHT, **given)
    assert np.abs(shared_atoms - alone_atoms).max() < 1e-9
    for column in ("TotEng", "Press", "Pxz"):
        assert np.allclose(shared[column], alone[column], rtol=1e-9, atol=1e-7), column
