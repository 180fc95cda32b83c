"""What cannot be done is refused by one line that names the fix."""

import pathlib
import shutil
import subprocess

import numpy as np
import pytest

import inputs
import lammps
import systems

WATER = [
    ("taut nonsense b 1", 'there is no "nonsense"'),
    ("taut feedforward", "no bonds are named"),
    ("taut feedforward b 2", "expected types from 1 to 1"),
    ("taut feedforward m 300", "no bond of the group"),
    ("taut feedforward b 1 tol 1e-8 toll 3", 'no keyword "toll"; did you mean "tol"'),
    ("taut feedforward b 1 tol much", 'tol: expected a number, got "much"'),
    ("taut feedforward b 1 tol -1", "tolerance"),
    ("taut baumgarte b 1 gains dead-beet", "dead-beat"),
    ("taut feedforward b 1 clear maybe", "expected yes or no"),
    ("taut feedforward a 1 b 1 kbond 0", "more than 0"),
]


@pytest.mark.parametrize("fix, said", WATER)
def test_keywords(run, fix, said):
    text = inputs.of(inputs.WATER).replace("fix hold all taut feedforward b 1 a 1", f"fix hold all {fix}") + "run 0\n"
    with pytest.raises(lammps.Failed) as failed:
        run(text)
    assert "Fix taut hold" in str(failed.value) and said in str(failed.value)


def failing(run, text, ranks=1):
    with pytest.raises(lammps.Failed) as failed:
        run(text, ranks)
    assert "Fix taut hold" in str(failed.value)
    return str(failed.value)


def test_ghosts_that_reach_too_little_name_the_remedy(run):
    text = inputs.of(inputs.CHAINS, cutoff=1.5, dt=0.002, rest="run 0\n")
    assert "comm_modify cutoff" in failing(run, text, ranks=2)


def test_a_bond_style_without_lengths(run):
    text = inputs.of(inputs.METHANE, dt=0.002, rest="run 0\n")
    assert "gives it no length" in failing(run, text.replace("bond_coeff 1 100 1.0", "bond_coeff 1 100 0.0"))


def test_no_bond_style(run):
    text = inputs.of(inputs.METHANE, dt=0.002, rest="run 0\n")
    text = text.replace("bond_style harmonic\nbond_coeff 1 100 1.0", "bond_style none")
    assert "no bond style" in failing(run, text)


def test_dependent_bonds(folder, run):
    """Methane with all ten distances held: one follows from the others."""
    braced = systems.methane()
    pairs = [(i, j) for i in range(2, 5) for j in range(i + 1, 6)]
    braced.bonds += [(2, 5 * m + i, 5 * m + j) for m in range(27) for i, j in pairs]
    (folder / "methane.data").write_text(braced.text([12.0, 1.0]))
    text = inputs.of(inputs.METHANE, dt=0.002, rest="run 0\n")
    text = text.replace("bond_coeff 1", "bond_coeff 2 100 1.6329931618554521\nbond_coeff 1")
    run(text)
    assert "A is singular" in failing(run, text.replace("b 1\n", "b *\n"))


def test_atoms_without_a_map_or_bonds(run):
    text = "units lj\natom_style atomic\nlattice fcc 0.8\nregion b block 0 2 0 2 0 2\ncreate_box 1 b\n" \
           "create_atoms 1 box\nmass 1 1\nfix hold all taut feedforward b 1\n"
    assert "atom style" in failing(run, text)


def test_molecule_templates(folder, run):
    (folder / "pair.txt").write_text(
        "\n2 atoms\n1 bonds\n\nCoords\n\n1 0 0 0\n2 1 0 0\n\nTypes\n\n1 1\n2 1\n\nBonds\n\n1 1 1 2\n\n"
        "Special Bond Counts\n\n1 1 0 0\n2 1 0 0\n\nSpecial Bonds\n\n1 2\n2 1\n")
    text = "units lj\nmolecule pair pair.txt\natom_style template pair\natom_modify map yes\n" \
           "region b block 0 5 0 5 0 5\ncreate_box 1 b bond/types 1\nmass 1 1\nbond_style harmonic\n" \
           "bond_coeff 1 1 1\nfix hold all taut feedforward b 1\n"
    assert "atom_style template" in failing(run, text)


@pytest.mark.parametrize("degrees, held", [(175, True), (179.9, False), (180, False)])
def test_angles_that_are_nearly_straight(folder, run, degrees, held):
    """At 175 degrees the temperature is that of fix shake; beyond 179.5 the angle is refused by name."""
    half = np.radians(degrees) / 2
    shape = np.array([[0, 0, 0], [np.sin(half), np.cos(half), 0], [-np.sin(half), np.cos(half), 0]])
    bent = systems.repeated(shape, [1, 2, 2], [-0.02, 0.01, 0.01], [(1, 1, 2), (1, 1, 3)], [(1, 2, 1, 3)], 4, 3.1)
    (folder / "water.data").write_text(bent.text([15.9994, 12.0]))
    output = "thermo_style custom step temp\nthermo_modify format float %.15g\nthermo 50\nrun 100\n"

    def temperature(fix):
        text = inputs.of(inputs.WATER, dt=0.5, fix=fix, rest=output).replace("109.47", f"{degrees}")
        return lammps.table(run(text))["Temp"][-1]

    if not held:
        with pytest.raises(lammps.Failed, match="Fix taut hold.*too near to straight"):
            temperature("taut feedforward")
        return
    assert temperature("taut feedforward") == pytest.approx(temperature("shake 1e-12 500 0"), rel=1e-5)


def test_fixes_that_push_afterwards(run):
    text = inputs.of(inputs.METHANE, dt=0.002, rest="fix warm all langevin 1 1 1 4711\nrun 0\n")
    assert "warm" in failing(run, text)


def test_respa(run):
    text = inputs.of(inputs.METHANE, dt=0.002, rest="run_style respa 2 2 bond 1 pair 2\nrun 0\n")
    assert "respa" in failing(run, text)


@pytest.mark.skipif(not lammps.PROGRAM.endswith("taut-lammps") or not shutil.which("mpicxx"),
                    reason="another LAMMPS than Debian's, or no mpicxx")
@pytest.mark.parametrize("rest, refused", [("run 0\n", True), ("unfix hold\nrun 0\n", False)])
def test_kokkos(run, folder, monkeypatch, rest, refused):
    """Debian's LAMMPS has no KOKKOS package; a preloaded library makes fixes believe that it is on."""
    tree, library = pathlib.Path(lammps.__file__).parents[2], folder / "kokkos_host.so"
    subprocess.run(["mpicxx", "-std=c++20", "-shared", "-fPIC", "-DOMPI_SKIP_MPICXX", f"-I{tree}", "-I/usr/include/lammps",
                    str(tree / "tests/lammps/kokkos_host.cpp"), "-o", str(library)], check=True)
    monkeypatch.setenv("LD_PRELOAD", str(library))
    text = inputs.of(inputs.METHANE, dt=0.002, rest=rest)
    if refused:
        assert "start LAMMPS without -k on" in failing(run, text)
    else:
        run(text)


def test_bonds_held_twice(run):
    text = inputs.of(inputs.METHANE, dt=0.002, rest="")
    text = text.replace("fix hold", "fix other all taut feedforward b 1\nfix hold")
    assert "held by another fix" in failing(run, text)


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_lost_bond_names_its_atoms(run, ranks):
    text = inputs.of(inputs.METHANE, dt=0.002, rest="velocity all scale 1e5\nrun 10\n")
    assert "the bond of atoms" in failing(run, text, ranks)
