"""The inputs of lammps/examples run to their end: few molecules, few steps."""

import pathlib
import re

import pytest

import lammps
import systems

EXAMPLES = pathlib.Path(lammps.__file__).parents[2] / "lammps/examples"
PEPTIDE = pathlib.Path("/usr/share/lammps/examples/peptide/data.peptide")  # of Debian's lammps-examples


def last_temperature(folder, name, **variables):
    output = lammps.run(folder, (EXAMPLES / f"in.{name}").read_text(), **variables)
    assert "Total wall time" in output
    if name == "peptide":  # thermo_style multi
        return float(re.findall(r"Temp += +(\S+)", output)[-1])
    return lammps.table(output)["Temp"][-1]


@pytest.mark.parametrize("model", ["spce", "tip3p"])
def test_water_with_pppm(tmp_path, model):
    (tmp_path / "water.data").write_text(systems.water(4, model).text([15.9994, 1.008]))
    given = dict(model=model, cutoff=6, steps=50, relax=100)
    theirs = last_temperature(tmp_path, "water", hold="rattle 1e-12 500 0", **given)
    for hold in ("taut feedforward tol 1e-12", "taut baumgarte"):
        assert last_temperature(tmp_path, "water", hold=hold, **given) == pytest.approx(theirs, rel=1e-5)


def test_melt(tmp_path):
    (tmp_path / "melt.data").write_text(systems.chains(4, 60, bond=0.97, density=0.85).text([1.0]))
    temperature = last_temperature(tmp_path, "melt", relax=500, steps=100)
    assert temperature == pytest.approx(1, abs=0.4)


def test_polymer_in_water(tmp_path):
    (tmp_path / "solution.data").write_text(systems.solution(8, 5).text([15.9994, 1.008, 14.027]))
    assert last_temperature(tmp_path, "polymer_in_water", steps=20) == pytest.approx(300, abs=200)


@pytest.mark.skipif(not PEPTIDE.exists(), reason="no lammps-examples")
def test_peptide_beside_fix_shake(tmp_path):
    theirs = last_temperature(tmp_path, "peptide", steps=20, hold="shake 1e-8 500 0")
    assert last_temperature(tmp_path, "peptide", steps=20) == pytest.approx(theirs, rel=1e-4)
