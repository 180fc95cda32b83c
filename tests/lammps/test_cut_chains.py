"""Chains longer than a processor's part of the box."""

import numpy as np
import pytest

import inputs
import lammps
import systems

OUTPUT = """
thermo_style custom step temp etotal press f_hold[1] f_hold[2] f_hold[3] f_hold[4] f_hold[5]
thermo_modify format float %.15g
thermo 10
"""


def trajectory(folder, run, fix, ranks=1, steps=100, **given):
    rest = OUTPUT + f"run {steps}\n" + inputs.END.format(dump="last.dump")
    output = run(inputs.of(inputs.CHAINS, **{"dt": 0.002, "fix": fix, "rest": rest, **given}), ranks)
    return lammps.table(output), lammps.dump(folder / "last.dump")


@pytest.mark.parametrize("method, near", [("feedforward", 1e-7), ("baumgarte", 1e-6)])
def test_parts_of_chains_move_as_the_whole(folder, run, method, near):
    whole, atoms = trajectory(folder, run, f"taut {method}")
    cut, cut_atoms = trajectory(folder, run, f"taut {method} overlap 6", ranks=2)
    assert cut["f_hold[3]"].max() > 0 and whole["f_hold[3]"].max() == 0  # it is cut, and was not
    assert np.abs(cut_atoms[:, :3] - atoms[:, :3]).max() < near
    assert np.abs(cut_atoms[:, 3:].sum(axis=0)).max() < 1e-11  # momentum
    assert cut["f_hold[1]"].max() < 2 * whole["f_hold[1]"].max() + 1e-9


def with_sides(chains, seed=3):
    """Hangs two beads on every third bead, one on the other; some of the sides lie across a border."""
    rng, n = np.random.default_rng(seed), len(chains.x)
    x, bonds, molecules = list(chains.x), list(chains.bonds), list(chains.molecules)
    for k in range(1, n, 3):
        at = k
        for _ in range(2):
            step = rng.normal(size=3)
            x.append(x[at] + step / np.linalg.norm(step))
            molecules.append(molecules[k])
            bonds.append((1, at + 1, len(x)))
            at = len(x) - 1
    atoms = [1] * len(x), molecules, [0] * len(x), np.array(x)
    return systems.Topology(atoms, bonds, [], chains.box)


def test_parts_of_branched_molecules_move_as_the_whole(folder, run):
    (folder / "chains.data").write_text(with_sides(systems.chains(6, 40)).text([1.0]))
    _, atoms = trajectory(folder, run, "taut feedforward", steps=40)
    for ranks in (2, 4):
        cut, cut_atoms = trajectory(folder, run, "taut feedforward", ranks=ranks, steps=40)
        assert cut["f_hold[3]"].max() > 0
        assert np.abs(cut_atoms[:, :3] - atoms[:, :3]).max() < 1e-7
        assert cut["f_hold[1]"].max() < 1e-6


def test_exchanges_make_up_for_a_short_overlap(folder, run):
    whole, atoms = trajectory(folder, run, "taut feedforward", steps=40)
    cut, cut_atoms = trajectory(folder, run, "taut feedforward overlap 2 exchanges 5", ranks=2, steps=40)
    assert cut["f_hold[3]"].max() == 2 and cut["f_hold[4]"].max() == 5
    assert np.abs(cut_atoms[:, :3] - atoms[:, :3]).max() < 1e-8


def test_straight_chains_take_exchanges_and_live(folder, run):
    """Influence does not decay along them. Fewer exchanges than they need are refused."""
    (folder / "chains.data").write_text(systems.chains(4, 30, straight=True).text([1.0]))
    given = dict(ranks=2, processors="2 1 1", cutoff=12, steps=60, dt=0.005)
    cut, _ = trajectory(folder, run, "taut feedforward overlap 3", **given)
    assert cut["f_hold[4]"].max() > 5
    assert cut["f_hold[1]"].max() < 1e-5
    with pytest.raises(lammps.Failed, match="so straight.* felt there by 0.9[0-9]*, overlap 3"):
        trajectory(folder, run, "taut feedforward overlap 3 exchanges 0", **given)


def test_lists_built_at_every_step_change_no_guess(folder, run):
    """The past of multipliers beyond the cut goes on through it: shifted twice, their guess would be 40 times as far off."""
    rest = OUTPUT.replace("thermo 10", "thermo 1") + "run 60\n"
    text = inputs.of(inputs.CHAINS, dt=0.002, fix="taut feedforward overlap 4", rest=rest)
    for lists in ("check yes", "check no"):
        found = lammps.table(run(text.replace("check yes", lists), 2))
        assert found["f_hold[5]"].max() < 3e-4
        assert found["f_hold[1]"][5:].max() < 1e-9
