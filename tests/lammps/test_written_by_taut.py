"""The inputs that `taut crosscheck SCENE --export-lammps` writes run in taut-lammps as they are."""

import json
import os
import pathlib
import subprocess

import pytest

import lammps

TAUT = os.environ.get("TAUT_COMMAND", str(pathlib.Path(lammps.PROGRAM).parent / "taut"))
BOLTZMANN = 8.31446261815324e-3  # kJ/mol/K
MELT = ["build.chains=20", "build.beads=20"]
RUNS = {
    "constant energy": ("melt", MELT, 1e-8),
    "velocity rescaling": ("melt", [*MELT, "run.thermostat=rescaling", "run.thermostat_ps=0.5"], 1e-8),
    "Langevin": ("decane", ["run.thermostat=langevin"], 1e-6),  # pairs 1-4 have no cutoff in taut
}


def taut(*words):
    done = subprocess.run([TAUT, *words], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("run", RUNS)
def test_a_written_input_runs(folder, run):
    scene, settings, within = RUNS[run]
    arguments = [word for setting in settings for word in ("--set", setting)]
    taut("crosscheck", scene, *arguments, "--steps", "100", "--export-lammps", str(folder / "x"))
    text = (folder / "x.in").read_text()
    if not lammps.has_package("EXTRA-FIX"):  # as Debian's
        text = text.replace("fix bath all temp/csvr", "# ").replace("# without EXTRA-FIX: ", "")
    table = lammps.table(lammps.run(folder, text.replace("\nrun 100\n", """
thermo_style custom step temp pe etotal f_hold[1]
thermo_modify norm no format float %.15g
thermo 10
run 100
""")))
    assert len(table["Step"]) == 11
    start = json.loads(taut("run", scene, *arguments, "--steps", "0", "--json"))
    assert table["PotEng"][0] == pytest.approx(start["potential_kj_mol"], rel=within)
    assert table["Temp"][0] == pytest.approx(BOLTZMANN * start["temperature_k"], rel=5e-3)  # of other half steps
    assert 0 < max(table["f_hold[1]"]) < 1e-7
    energy = table["TotEng"]
    if run == "constant energy":
        assert max(abs(energy - energy[0])) < 2e-3 * start["temperature_k"] * BOLTZMANN * start["dof"]
    else:
        assert max(abs(energy - energy[0])) > 1  # kJ/mol: the bath exchanges some
