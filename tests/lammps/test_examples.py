"""The inputs of lammps/examples run to their end: few molecules, few steps."""

import pathlib
import re

import numpy as np
import pytest

import lammps
import systems

EXAMPLES = pathlib.Path(lammps.__file__).parents[2] / "lammps/examples"
BOLTZMANN = 0.0019872067  # kcal/mol/K, as LAMMPS has it
PEPTIDE = pathlib.Path("/usr/share/lammps/examples/peptide/data.peptide")  # of Debian's lammps-examples


def columns(folder, name, **variables):
    output = lammps.run(folder, (EXAMPLES / f"in.{name}").read_text(), **variables)
    assert "Total wall time" in output
    return lammps.table(output)


@pytest.mark.parametrize("model", ["spce", "tip3p"])
def test_water_with_pppm(tmp_path, model):
    (tmp_path / "water.data").write_text(systems.water(4, model).text([15.9994, 1.008]))
    given = dict(model=model, cutoff=6, steps=50, relax=100)
    theirs = columns(tmp_path, "water", hold="shake 1e-12 500 0", **given)["Temp"][-1]
    for hold in ("taut feedforward tol 1e-12", "taut baumgarte"):
        assert columns(tmp_path, "water", hold=hold, **given)["Temp"][-1] == pytest.approx(theirs, rel=1e-5)


def test_melt(tmp_path):
    (tmp_path / "melt.data").write_text(systems.chains(4, 60, bond=0.97, density=0.85).text([1.0]))
    found = columns(tmp_path, "melt", relax=500, steps=100, every=5)
    atoms, bonds = 4 * 60, 4 * 59
    assert np.allclose(2 * atoms * found["KinEng"] / found["Temp"], 3 * atoms - bonds - 3, rtol=1e-6)
    assert np.ptp(found["KinEng"]) > 0.1 and np.ptp(found["TotEng"]) < 1e-3  # by atom
    assert found["f_hold[1]"][1:].max() < 1e-7


def test_polymer_in_water(tmp_path):
    solution = systems.solution(8, 5)
    (tmp_path / "solution.data").write_text(solution.text([15.9994, 1.008, 14.027]))
    found = columns(tmp_path, "polymer_in_water", steps=40, every=2)
    freedom = 3 * len(solution.x) - len(solution.bonds) - len(solution.angles) - 3
    assert np.allclose(2 / BOLTZMANN * found["KinEng"] / found["Temp"], freedom, rtol=1e-6)
    assert np.ptp(found["KinEng"]) > 50 and np.ptp(found["TotEng"]) < 1  # kcal/mol of 326 atoms
    assert found["f_hold[1]"][1:].max() < 2e-7


@pytest.mark.skipif(not PEPTIDE.exists(), reason="no lammps-examples")
def test_peptide_beside_fix_shake(tmp_path):
    def last_temperature(**given):
        output = lammps.run(tmp_path, (EXAMPLES / "in.peptide").read_text(), steps=20, **given)
        return float(re.findall(r"Temp += +(\S+)", output)[-1])  # thermo_style multi

    assert last_temperature() == pytest.approx(last_temperature(hold="shake 1e-8 500 0"), rel=1e-4)
