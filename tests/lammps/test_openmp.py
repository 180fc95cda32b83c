"""LAMMPS with OpenMP threads of its own: as many after fix taut has computed as before."""

import numpy as np
import pytest

import inputs
import lammps

THERMO = "thermo_style custom step temp pe etotal f_hold[1]\nthermo_modify format float %.15g\nthermo 5\n"


@pytest.mark.skipif(not lammps.has_package("OPENMP"), reason="this LAMMPS has no OPENMP package (Debian's has not)")
@pytest.mark.parametrize("threads", [2, 3])
def test_threads_of_lammps_stay_its_own(folder, threads):
    text = inputs.of(inputs.WATER, rest=THERMO + "run 10\nrun 10\n")
    plain, omp = lammps.run(folder, text), lammps.run(folder, text, omp=threads)
    assert "lj/cut/coul/cut/omp" in omp
    for which in (0, 1):
        one, several = lammps.table(plain, which), lammps.table(omp, which)
        for column in ("PotEng", "Temp", "TotEng"):
            np.testing.assert_allclose(several[column], one[column], rtol=1e-9)
