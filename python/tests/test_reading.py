"""taut.read beside OpenMM's own energies of what its readers read."""

from pathlib import Path

import numpy as np
import pytest

import taut

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
        np.testing.assert_allclose(sim.velocities, given, rtol=1e-6)
    sim.run(10)


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
