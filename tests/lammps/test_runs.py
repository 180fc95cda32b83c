"""Runs that stop and go on, other ensembles, units and boxes, minimisation: what a LAMMPS user expects of a fix."""

import re

import numpy as np
import pytest

import inputs
import lammps
import systems

TIGHT = "taut feedforward tol 1e-14"
THERMO = "thermo_style custom step temp pe etotal press f_hold[1]\nthermo_modify format float %.15g\nthermo 20\n"
METHANE = dict(dt=0.002)


def methane(run, rest, ranks=1, fix=TIGHT, **given):
    return run(inputs.of(inputs.METHANE, **{**METHANE, "fix": fix, "rest": THERMO + rest, **given}), ranks)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_run_in_two_parts_is_one_run(folder, run, ranks):
    methane(run, "run 60\n" + inputs.END.format(dump="whole.dump"))
    methane(run, "run 20\nrun 40\n" + inputs.END.format(dump="parts.dump"), ranks)
    assert np.abs(lammps.dump(folder / "whole.dump") - lammps.dump(folder / "parts.dump")).max() < 1e-10


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_restart_goes_on_with_its_multipliers(folder, run, ranks):
    """On as many processors or fewer. With feedforward's default tolerance: its past counts."""
    methane(run, "run 20\nwrite_restart half\nrun 40\n" + inputs.END.format(dump="whole.dump"), 2, fix="taut feedforward")
    text = inputs.of(inputs.METHANE, **METHANE, fix="taut feedforward",
                     rest=THERMO + "run 40\n" + inputs.END.format(dump="parts.dump"))
    text = text.replace("read_data methane.data", "read_restart half").replace("velocity all create", "#")
    text = text.replace("atom_style full", "")
    output = run(text, ranks)
    assert np.abs(lammps.dump(folder / "whole.dump") - lammps.dump(folder / "parts.dump")).max() < 1e-10
    assert lammps.table(output)["f_hold[1]"].max() < 1e-9


@pytest.mark.parametrize("change", ["timestep 0.001\n", "velocity all create 2.0 99 loop geom\n",
                                    "displace_atoms all random 0.001 0.001 0.001 5\n"])
def test_what_changes_between_runs_is_noticed(run, change):
    output = methane(run, "run 20\n" + change + "run 40\n")
    assert lammps.table(output)["f_hold[1]"][1:].max() < 1e-9


@pytest.mark.parametrize("ensemble, off", [
    ("fix move all npt temp 1 1 0.2 iso 0.1 0.1 2.0", 2e-6),  # with the box's strain unknown: 1e-4
    ("fix move all nvt temp 1 1 0.2", 1e-7),
    ("fix warm all langevin 1 1 0.5 4711\nfix move all nve", 1e-5),
])
@pytest.mark.parametrize("ranks", [1, 2])
def test_ensembles(run, ensemble, off, ranks):
    output = methane(run, "run 200\n", ranks, fix="taut feedforward", integrate=ensemble)
    assert lammps.table(output)["f_hold[1]"][1:].max() < off


@pytest.mark.parametrize("ranks", [1, 2])
def test_temperature_counts_what_is_held(run, ranks):
    """27 molecules of 5 atoms: 405 coordinates, 108 bonds, 3 of the whole."""
    rest = "variable d equal 2*ke*atoms/temp\nrun 0\nprint 'freedom: ${d}'\n"
    output = methane(run, rest, ranks, fix="taut feedforward")
    shown = [line for line in output.splitlines() if line.startswith("freedom")]
    assert float(shown[-1].split()[1]) == pytest.approx(405 - 108 - 3, rel=1e-12)


def along_bonds(atoms):
    """r·v of the three distances of every water, at most."""
    atoms = atoms.reshape(-1, 3, 6)
    apart = atoms - np.roll(atoms, 1, axis=1)
    return np.abs((apart[:, :, :3] * apart[:, :, 3:]).sum(axis=2)).max(axis=1)


def test_triclinic_boxes_and_metal_units(folder, run):
    """Both against fix rattle; velocities where they are rattle's at all: LAMMPS of July 2025 leaves them along the bonds
    of molecules that lie across the periodic boundary, four here."""
    tilted = systems.water()
    tilted.tilt = (2.0, -1.0, 1.0)
    (folder / "water.data").write_text(tilted.text([15.9994, 1.008]))
    found = []
    for fix, ranks in (("rattle 1e-14 1000 0", 1), (TIGHT + " clear yes", 2)):
        rest = "run 50\n" + inputs.END.format(dump="last.dump")
        text = inputs.of(inputs.WATER, dt=0.0002, fix=fix, rest=rest).replace("units real", "units metal")
        run(text.replace("1 1 0.15535", "1 1 0.0067366"), ranks)
        found.append(lammps.dump(folder / "last.dump"))
    theirs, ours = found
    held = along_bonds(theirs) < 1e-9
    assert held.sum() >= 60 and along_bonds(ours).max() < 1e-9
    assert np.abs(ours[:, :3] - theirs[:, :3]).max() < 1e-9
    assert np.abs(ours - theirs)[np.repeat(held, 3)].max() < 1e-9


@pytest.mark.parametrize("ranks", [1, 2])
def test_minimise_and_go_on(folder, run, ranks):
    """Springs stand for bonds on the way down; what they leave is gone after the first steps."""
    output = methane(run, "minimize 1e-6 1e-6 200 2000\nvelocity all create 1 3 loop geom\nrun 40\n", ranks,
                     fix="taut feedforward kbond 1e3")
    energies, after = lammps.table(output, 0)["PotEng"], lammps.table(output)["TotEng"]
    assert energies[-1] < energies[0]
    assert np.ptp(after) < 2e-3  # what is left of the springs does not drive atoms apart
    assert lammps.table(output)["f_hold[1]"][1:].max() < 1e-8


def test_rerun(folder, run):
    first = methane(run, "dump d all custom 20 frames.dump id type x y z vx vy vz\n"
                    "dump_modify d format float %.16g\nrun 40\n")
    again = methane(run, "rerun frames.dump dump x y z vx vy vz\n")
    assert np.allclose(lammps.table(again)["Press"][1:], lammps.table(first)["Press"][1:], rtol=1e-3)  # whose velocities are cleared at the start


def test_balance_while_it_runs(folder, run):
    methane(run, "run 60\n" + inputs.END.format(dump="one.dump"))
    methane(run, "fix even all balance 10 1.0 shift xz 5 1.0\nrun 60\n" + inputs.END.format(dump="two.dump"), 2)
    assert np.abs(lammps.dump(folder / "one.dump") - lammps.dump(folder / "two.dump")).max() < 1e-9


@pytest.mark.parametrize("newton, ranks", [("on", 1), ("off", 2)])
def test_statistics_are_those_of_fix_shake(run, newton, ranks):
    """A line a type of bonds and of angles: mean length or degrees, the spread, how many there are."""
    def printed(fix):
        output = run(inputs.of(inputs.WATER, newton=newton, fix=fix, rest="run 10\n"), ranks)
        title, *rows = re.search(r"stats \(type/ave/delta/count\) on step 10\n(?:.*\n){2}", output).group(0).splitlines()
        return np.array([[float(word) for word in row.split(":")[-1].split()] for row in rows])

    ours, theirs = printed("taut feedforward every 10"), printed("shake 1e-10 500 10")
    assert ours[:, [0, 3]].tolist() == [[1, 128], [1, 64]]
    assert theirs[1, 3] == 64  # of water's bonds it counts 192: each with every atom of the molecule
    assert ours[:, 1] == pytest.approx([1, 109.47], rel=1e-6) and theirs[:, 1] == pytest.approx([1, 109.47], rel=1e-5)
    assert (ours[:, 2] > 0).all() and (ours[:, 2] < [1e-6, 1e-4]).all()


def test_stored_forces(folder, run):
    """Forces by atom are those of the tensions by bond, and add up to nothing."""
    output = methane(run, "compute t all reduce sum f_hold[1] f_hold[2] f_hold[3]\n"
                     "thermo_style custom step c_t[1] c_t[2] c_t[3]\n"
                     "dump b all local 10 bonds.dump f_hold[1] f_hold[2] f_hold[3]\n"
                     "dump f all custom 10 forces.dump id f_hold[1] f_hold[2] f_hold[3]\nrun 20\n", fix="taut feedforward store yes")
    sums = lammps.table(output)
    assert max(np.abs(sums[f"c_t[{k}]"]).max() for k in (1, 2, 3)) < 1e-9
    text = (folder / "bonds.dump").read_text()
    rows = np.array([line.split() for line in text[text.rindex("ITEM: ENTRIES"):].splitlines()[1:]], float)
    assert len(rows) == 108 and len({(a, b) for a, b, _ in rows}) == 108


@pytest.mark.parametrize("ranks", [1, 2])
def test_molecules_that_drift_through_the_box(folder, run, ranks):
    """Lists are built at every fifth step, atoms sorted at every tenth: all cross the boundary, and move as if at rest."""
    drift, time = np.array([3.0, 2.0, -2.5]), 0.4
    often = "neigh_modify every 5 delay 0 check no\natom_modify sort 10 2.0\n"
    methane(run, often + "run 200\n" + inputs.END.format(dump="rest.dump"))
    methane(run, often + "velocity all set 3.0 2.0 -2.5 sum yes\nrun 200\n" + inputs.END.format(dump="drift.dump"), ranks)
    rest, drifted = lammps.dump(folder / "rest.dump"), lammps.dump(folder / "drift.dump")
    assert np.abs(drifted - rest - np.concatenate([drift * time, drift])).max() < 1e-9
