"""taut.read beside OpenMM's own energies of what its readers read."""

from pathlib import Path

import numpy as np
import pytest

import taut
from taut.reading import _whole

app = pytest.importorskip("openmm.app", reason="needs OpenMM")
import openmm  # noqa: E402
import openmm.unit as unit  # noqa: E402

TOP = """
[ defaults ]
1 2 no 1.0 1.0
[ atomtypes ]
CH 6 14.0 0.0 A 0.37 0.6
HC 1 1.0 0.0 A 0.2 0.1
[ moleculetype ]
MOL 3
[ atoms ]
1 CH 1 MOL C1 1 -0.2 14.0
2 HC 1 MOL H1 1 0.2 1.0
3 CH 1 MOL C2 1 -0.2 14.0
4 HC 1 MOL H2 1 0.2 1.0
[ bonds ]
1 2 1 0.11 300000
1 3 1 0.15 200000
3 4 1 0.11 300000
[ angles ]
2 1 3 1 110 400
1 3 4 1 110 400
[ dihedrals ]
2 1 3 4 9 0 1.5 3
[ system ]
pairs
[ molecules ]
MOL 30
"""


def but_for_the_centre(sim, velocities):
    """Velocities less the centre of mass's [nm/ps], which is stopped at the start, and said."""
    centre = sim.masses @ velocities / sim.masses.sum()
    assert any(f"the centre of mass moved at {np.linalg.norm(centre):.2g} nm/ps" in note for note in sim.notes)
    return velocities - centre


@pytest.fixture
def files(tmp_path):
    rng = np.random.default_rng(1)
    shape = np.array([[0, 0, 0], [-0.04, 0.1, 0], [0.15, 0, 0], [0.19, 0.1, 0.01]])
    centres = [(i, j, k) for i in range(4) for j in range(4) for k in range(2)][:30]
    rows = []
    for m, centre in enumerate(centres):
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
        for a, x in enumerate(shape @ turn.T + 0.7 * (np.array(centre) + 0.5)):
            rows.append(f"{m + 1:5d}{'MOL':5s}{('C1', 'H1', 'C2', 'H2')[a]:>5s}{4 * m + a + 1:5d}"
                        + "".join(f"{c:8.3f}" for c in x))
    (tmp_path / "x.top").write_text(TOP)
    (tmp_path / "x.gro").write_text("\n".join(["pairs", str(len(rows)), *rows, "2.8 2.8 2.8", ""]))
    return tmp_path


@pytest.mark.parametrize("coulomb, method, within", [("pme", "PME", 1e-3),  # grids of other sizes
                                                     ("reaction-field", "CutoffPeriodic", 1e-6)])
def test_gromacs_files_have_openmms_energy(files, coulomb, method, within):
    sim = taut.read(files / "x.top", files / "x.gro", cutoff_nm=1.0, coulomb=coulomb)
    gro = app.GromacsGroFile(str(files / "x.gro"))
    top = app.GromacsTopFile(str(files / "x.top"), periodicBoxVectors=gro.getPeriodicBoxVectors())
    system = top.createSystem(nonbondedMethod=getattr(app, method), nonbondedCutoff=1 * unit.nanometer,
                              constraints=app.HBonds)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(sim.positions)  # brought to the bonds
    energy = context.getState(getEnergy=True).getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    assert sim.energies["potential"] == pytest.approx(energy, rel=within)
    assert len(sim.bonds) == 60 and sim.box is not None
    sim.run(10)


# Alanine dipeptide and three waters in a box, which ParmEd wrote from OpenMM's amber14: 12 bonds to hydrogen and 9 of
# waters, their H–H bonds among them.
PEPTIDE = [str(Path(__file__).resolve().parents[2] / "tests/data/peptide") + end for end in (".prmtop", ".rst7")]


@pytest.mark.parametrize("constraints, bonds", [("h-bonds", 21), (None, 0)])
@pytest.mark.parametrize("coulomb, method, within", [("pme", "PME", 1e-3), ("reaction-field", "CutoffPeriodic", 1e-9),
                                                     ("none", "NoCutoff", 1e-9)])
def test_amber_files_have_openmms_energy(coulomb, method, within, constraints, bonds):
    sim = taut.read(*PEPTIDE, cutoff_nm=1.0, coulomb=coulomb, constraints=constraints, rigid_water=bonds > 0)
    placed = app.AmberInpcrdFile(PEPTIDE[1])
    top = app.AmberPrmtopFile(PEPTIDE[0], periodicBoxVectors=placed.boxVectors)
    system = top.createSystem(nonbondedMethod=getattr(app, method), nonbondedCutoff=1 * unit.nanometer,
                              constraints=app.HBonds if bonds else None, rigidWater=bonds > 0)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(sim.positions)
    energy = context.getState(getEnergy=True).getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    assert sim.energies["potential"] == pytest.approx(energy, rel=within)
    assert len(sim.bonds) == bonds == system.getNumConstraints()
    assert (sim.box is None) == (coulomb == "none")
    if not bonds:  # nothing projects the file's velocities
        given = placed.getVelocities(asNumpy=True).value_in_unit(unit.nanometer / unit.picosecond)
        np.testing.assert_allclose(sim.velocities, but_for_the_centre(sim, given), rtol=1e-6, atol=1e-9)
    sim.run(10)


@pytest.mark.parametrize("decimals", [3, 5])
def test_velocities_and_the_box_of_a_gro_are_read(files, decimals):
    title, count, *rows, box = (files / "x.gro").read_text().splitlines()
    v = np.random.default_rng(2).normal(size=(len(rows), 3))
    wide = decimals + 5
    (files / "v.gro").write_text("\n".join([title, count] + [
        row[:20] + "".join(f"{float(row[n:n + 8]):{wide}.{decimals}f}" for n in (20, 28, 36))
        + "".join(f"{c:{wide}.{decimals + 1}f}" for c in of) for row, of in zip(rows, v)] + [box, ""]))
    sim = taut.read(files / "x.top", files / "v.gro", constraints=None, coulomb="reaction-field")
    np.testing.assert_allclose(sim.velocities, but_for_the_centre(sim, v), atol=1.02 * 10**-(decimals + 1))
    np.testing.assert_allclose(sim.box, 2.8 * np.eye(3))
    held = taut.read(files / "x.top", files / "v.gro", coulomb="reaction-field")
    assert held.temperature > 100  # the bonds take a part of it
    (files / "two.gro").write_text(2 * (files / "v.gro").read_text())
    with pytest.warns(UserWarning, match="two.gro: the first of its frames is taken"):
        taut.read(files / "x.top", files / "two.gro", coulomb="reaction-field")


def test_a_gro_of_box_0_has_none(files):
    (files / "o.gro").write_text((files / "x.gro").read_text().replace("2.8 2.8 2.8", "0.00000 0.00000 0.00000"))
    sim = taut.read(files / "x.top", files / "o.gro", coulomb="none")
    top = app.GromacsTopFile(str(files / "x.top"))
    context = openmm.Context(top.createSystem(nonbondedMethod=app.NoCutoff), openmm.VerletIntegrator(0.001),
                             openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(sim.positions)
    energy = context.getState(getEnergy=True).getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
    assert sim.box is None and sim.energies["potential"] == pytest.approx(energy, rel=1e-9)
    with pytest.raises(taut.InputError, match="o.gro: has no box, which coulomb='pme' needs; take coulomb=\"none\""):
        taut.read(files / "x.top", files / "o.gro")


@pytest.mark.parametrize("mass, quantity", [(3, 3 * unit.dalton), (2.5 * unit.dalton, 2.5 * unit.dalton)])
def test_hydrogens_are_made_heavier(mass, quantity):
    sim = taut.read(*PEPTIDE, hydrogen_mass=mass)
    top = app.AmberPrmtopFile(PEPTIDE[0], periodicBoxVectors=app.AmberInpcrdFile(PEPTIDE[1]).boxVectors)
    system = top.createSystem(nonbondedMethod=app.PME, constraints=app.HBonds, hydrogenMass=quantity)
    masses = [system.getParticleMass(a).value_in_unit(unit.dalton) for a in range(system.getNumParticles())]
    np.testing.assert_allclose(sim.masses, masses, rtol=1e-12)
    assert np.sum(np.isclose(sim.masses, taut.read(*PEPTIDE).masses)) < len(masses)
    with pytest.raises(taut.InputError, match="hydrogen_mass: expected more than 0"):
        taut.read(*PEPTIDE, hydrogen_mass=0)


# What docs/from_gromacs.md gives the command: its State has the velocities of the .gro.
def test_the_page_for_gromacs_writes_what_the_gro_has(files, monkeypatch):
    page = (Path(__file__).resolve().parents[2] / "docs/from_gromacs.md").read_text()
    monkeypatch.chdir(files)
    (files / "dhfr.top").write_text(TOP)
    rows = (files / "x.gro").read_text().splitlines()
    rows[2:-1] = [row + f"{n / 1000:8.4f} -0.2500  1.5000" for n, row in enumerate(rows[2:-1])]
    (files / "dhfr.gro").write_text("\n".join(rows) + "\n")
    exec(page.split("```python\n")[1].split("```")[0], {})
    state = openmm.XmlSerializer.deserialize((files / "state.xml").read_text())
    v = state.getVelocities(asNumpy=True).value_in_unit(unit.nanometer / unit.picosecond)
    np.testing.assert_allclose(v, [[n / 1000, -0.25, 1.5] for n in range(len(rows) - 3)], atol=1e-12)


@pytest.mark.parametrize("call, words", [
    (lambda at: taut.read(at / "x.gro", at / "x.gro"), "expected a topology, one of .top, .prmtop, .parm7"),
    (lambda at: taut.read(at / "x.top", at / "x.pdb"), "expected GROMACS's coordinates, .gro"),
    (lambda at: taut.read(at / "y.top", at / "x.gro"), "y.top: no such file"),
    (lambda at: taut.read(at / "x.top", at / "x.gro", coulomb="ewald"), 'coulomb: expected "pme"'),
    (lambda at: taut.read(at / "x.top", at / "x.gro", constraints="bonds"), 'constraints: expected "h-bonds"'),
    (lambda at: taut.read(at / "bad.top", at / "x.gro"), "OpenMM cannot read them"),
])
def test_what_cannot_be_read_is_refused_by_name(files, call, words):
    (files / "bad.top").write_text(TOP.replace("0.11 300000", "long stiff"))
    with pytest.raises(taut.InputError, match=words):
        call(files)


def test_sites_stay_with_their_parents_where_a_file_is_wrapped(tmp_path):
    """Water of four sites whose M alone lies across the box."""
    system = openmm.System()
    for mass in (16, 1, 1, 0):
        system.addParticle(mass)
    system.setVirtualSite(3, openmm.ThreeParticleAverageSite(0, 1, 2, 0.8, 0.1, 0.1))
    for one, two, d in ((0, 1, 0.09572), (0, 2, 0.09572), (1, 2, 0.15139)):
        system.addConstraint(one, two, d)
    x = np.array([[0.01, 1, 1], [-0.0486, 1.0757, 1], [-0.0486, 0.9243, 1], [-0.0017, 1, 1]])
    wrapped = np.where(x < 0, x + 2.0, x)
    moved = np.array(_whole(system, wrapped, 2.0 * np.eye(3)))
    np.testing.assert_allclose(moved - moved[0], x - x[0], atol=1e-12)


def test_a_file_wrapped_atom_by_atom_is_made_whole(files):
    whole = taut.read(files / "x.top", files / "x.gro", cutoff_nm=1.0)
    lines = (files / "x.gro").read_text().splitlines()
    moved = [line[:20] + "".join(f"{(float(line[c:c + 8]) + 0.35) % 2.8:8.3f}" for c in (20, 28, 36))
             for line in lines[2:-1]]
    (files / "wrapped.gro").write_text("\n".join([*lines[:2], *moved, lines[-1], ""]))
    sim = taut.read(files / "x.top", files / "wrapped.gro", cutoff_nm=1.0)
    assert sim.energies["potential"] == pytest.approx(whole.energies["potential"], rel=1e-6)
