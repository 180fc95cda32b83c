"""Chains longer than a processor's part of the box."""

import numpy as np
import pytest

import inputs
import lammps

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
    assert cut["f_hold[1]"].max() < 2 * whole["f_hold[1]"].max() + 1e-9
