"""Systems that openmm.app makes from its own bundled files, against OpenMM's Reference platform."""

import os

import numpy as np
import pytest

import taut

openmm = pytest.importorskip("openmm", reason="needs OpenMM from PyPI: pip install openmm")
app, unit = pytest.importorskip("openmm.app"), pytest.importorskip("openmm.unit")
DATA = os.path.join(os.path.dirname(app.__file__), "data")
KJ, NM = unit.kilojoule_per_mole, unit.nanometer
BONDS = unit.kilojoule_per_mole / unit.nanometer


def made(pdb, files, dry=False, **named):
    """System and Modeller of a bundled PDB file under a force field; dry: without water and ions."""
    if missing := [file for file in files if not os.path.exists(os.path.join(DATA, file))]:
        pytest.skip(f"needs an OpenMM that has {missing[0]}")
    read = app.PDBFile(os.path.join(DATA, pdb))
    field = app.ForceField(*files)
    model = app.Modeller(read.topology, read.positions)
    if dry:
        model.delete([one for one in read.topology.residues() if one.name in ("HOH", "Cl")])
        model.topology.setPeriodicBoxVectors(None)
    model.addExtraParticles(field)
    named = {"nonbondedMethod": app.PME, "nonbondedCutoff": 0.8 * NM, "constraints": app.HBonds, **named}
    system = field.createSystem(model.topology, **named)
    for force in system.getForces():
        if isinstance(force, openmm.NonbondedForce) and named["nonbondedMethod"] is app.PME:
            force.setPMEParameters(3.0, 60, 60, 60)  # else each picks a grid of its own
    return system, model


def reference(system, sim, what="forces"):
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    if sim.box is not None:
        context.setPeriodicBoxVectors(*sim.box)
    context.setPositions(sim.positions)
    state = context.getState(getEnergy=True, getForces=True)
    return state.getPotentialEnergy().value_in_unit(KJ), state.getForces(asNumpy=True).value_in_unit(BONDS)


SYSTEMS = [
    ("test.pdb", ["amber14-all.xml", "amber14/tip3pfb.xml"], {}),
    ("test.pdb", ["amber14-all.xml", "amber14/tip3pfb.xml"], {"nonbondedMethod": app.CutoffPeriodic}),
    ("test.pdb", ["amber14-all.xml", "amber14/tip3pfb.xml"], {"constraints": app.AllBonds}),
    ("tip3p.pdb", ["tip3p.xml"], {}),
    ("spce.pdb", ["spce.xml"], {"nonbondedMethod": app.CutoffPeriodic}),
    ("tip4pew.pdb", ["amber14/tip4pew.xml"], {}),
    ("test.pdb", ["charmm36.xml", "charmm36/water.xml"], {}),
    ("test.pdb", ["amber14-all.xml"], {"dry": True, "nonbondedMethod": app.NoCutoff}),
    ("test.pdb", ["amber19-all.xml", "amber19/opc.xml"], {"constraints": app.HAngles}),
]


@pytest.mark.parametrize("pdb, files, named", SYSTEMS, ids=[f"{p} {f[0]} {i}" for i, (p, f, n) in enumerate(SYSTEMS)])
def test_energies_and_forces(pdb, files, named):
    system, model = made(pdb, files, **named)
    sim = taut.Simulation.from_openmm(system, model.positions, topology=model.topology, method="newton", dt_fs=1)
    energy, forces = reference(system, sim)
    real = np.array([not system.isVirtualSite(n) for n in range(len(forces))])  # OpenMM leaves on a site what it
    rms = np.sqrt((forces**2).mean())  # hands to its parents
    assert sim.energies["potential"] == pytest.approx(energy, rel=1e-9)
    assert abs(sim.forces - forces)[real].max() < 1e-7 * rms
    again = taut.Simulation.resume(sim.checkpoint())
    for one in (sim, again):
        assert list(one.names["atom"]) == [atom.name for atom in model.topology.atoms()]
        assert list(one.names["residue_index"]) == [atom.residue.index for atom in model.topology.atoms()]


def test_bond_lengths_of_trajectories():
    system, model = made("test.pdb", ["amber14-all.xml", "amber14/tip3pfb.xml"])
    sim = taut.Simulation.from_openmm(system, model.positions, method="newton", dt_fs=1)
    sim.minimise(5000)
    integrator = openmm.VerletIntegrator(0.001)
    integrator.setConstraintTolerance(1e-10)
    context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(sim.positions)
    sim.run(20)
    integrator.step(20)
    there = context.getState(getPositions=True).getPositions(asNumpy=True).value_in_unit(NM)
    lengths = [np.linalg.norm(x[sim.bonds[:, 1]] - x[sim.bonds[:, 0]], axis=1) for x in (sim.positions, there)]
    assert abs(lengths[0] - lengths[1]).max() < 1e-8
    assert abs(sim.positions - there).max() < 1e-2  # OpenMM's velocities begin half a step behind


def test_settings_and_edges_have_units():
    sim = taut.Simulation("water", dt_fs=0.002 * unit.picosecond, set={"run.thermostat": "langevin", "run.temperature_k": 300})
    assert sim.dt_fs == 2
    sim.dt_fs = 1 * unit.femtosecond
    sim.set_temperature(310 * unit.kelvin)
    sim.box = [20, 20, 20] * unit.angstrom
    sim.run(1)
    assert (sim.dt_fs, sim.log["bath_temperature_k"][-1]) == (1, 310) and np.allclose(sim.box, 2 * np.eye(3))
    sim.box = [2.1 * NM, 2.1 * NM, 21 * unit.angstrom]
    assert np.allclose(sim.box, 2.1 * np.eye(3))
    with pytest.raises(taut.InputError, match=r"dt_fs: expected a number \[fs\], got (3 K|Quantity\(value=3)"):
        sim.dt_fs = 3 * unit.kelvin


def test_states_boxes_and_units():
    system, model = made("tip3p.pdb", ["tip3p.xml"])
    velocities = np.full((system.getNumParticles(), 3), 0.1)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(model.positions)
    context.setVelocities(velocities)
    state = context.getState(getPositions=True, getVelocities=True)
    box = system.getDefaultPeriodicBoxVectors()
    positions = np.array(model.positions.value_in_unit(NM))
    sims = [taut.Simulation.from_openmm(system, *given, dt_fs=1, **named) for given, named in [
        ((state,), {}),
        ((model.positions,), {"velocities": velocities * unit.nanometer / unit.picosecond}),
        ((positions,), {"velocities": velocities, "box": box}),
        ((openmm.XmlSerializer.serialize(state),), {"topology": model})]]
    text = openmm.XmlSerializer.serialize(system)
    sims.append(taut.Simulation.from_openmm(text, state, dt_fs=1))
    for sim in sims[1:]:
        assert np.allclose(sim.positions, sims[0].positions, atol=1e-12)
        assert np.allclose(sim.velocities, sims[0].velocities, atol=1e-12)
        assert np.allclose(sim.box, sims[0].box)


def test_there_and_back():
    sim = taut.Simulation("water", set={"build.molecules": 27, "forcefield.cutoff_nm": 0.45,
                                        "forcefield.switch_nm": 0.4})
    system, state = sim.to_openmm()
    energy, forces = reference(system, sim)
    assert sim.energies["potential"] == pytest.approx(energy, rel=1e-9)
    again = taut.Simulation.from_openmm(system, state, method="rattle", dt_fs=2)
    assert np.allclose(again.positions, sim.positions, atol=1e-12)
    assert again.energies["potential"] == pytest.approx(energy, rel=1e-9)


def seventh_power():
    system, model = made("tip3p.pdb", ["tip3p.xml"])
    torsion = openmm.CustomTorsionForce("k*theta^7")
    torsion.addPerTorsionParameter("k")
    torsion.addTorsion(0, 1, 2, 3, [1])
    system.addForce(torsion)
    return system, model


def code():
    if not hasattr(openmm, "PythonForce"):
        pytest.skip("needs an OpenMM that has PythonForce")
    system, model = made("tip3p.pdb", ["tip3p.xml"])
    system.addForce(openmm.PythonForce(lambda state: (0, np.zeros((2685, 3)))))
    return system, model


VACUUM = {"dry": True, "nonbondedMethod": app.NoCutoff}


@pytest.mark.parametrize("make, words", [
    (seventh_power, "CustomTorsionForce"),
    (code, "system: OpenMM cannot write it as XML.*PythonForce"),
    (lambda: made("tip3p.pdb", ["amoeba2018.xml"], constraints=None, rigidWater=False), "AmoebaBond"),
    (lambda: made("tip3p.pdb", ["swm4ndp.xml"]), "DrudeForce: is not one taut knows"),
    (lambda: made("test.pdb", ["amber14-all.xml", "implicit/obc2.xml"], **VACUUM), "CustomGBForce: is not one taut"),
    (lambda: made("test.pdb", ["amber99sb.xml", "amber99_obc.xml"], **VACUUM), "GBSAOBCForce: is not one taut knows"),
    (lambda: made("tip3p.pdb", ["tip3p.xml"], nonbondedMethod=app.LJPME), "NonbondedForce: uses LJPME"),
], ids=["seventh power", "code", "amoeba", "drude", "obc2", "obc", "ljpme"])
def test_what_is_not_there_is_refused_by_name(make, words):
    system, model = make()
    with pytest.raises(taut.InputError, match=words):
        taut.Simulation.from_openmm(system, model.positions, dt_fs=1)


@pytest.mark.parametrize("named, words", [
    ({"velocities": np.zeros((2, 3))}, "velocities: expected 648 rows"),
    ({"topology": app.Topology()}, "topology: has 0 atoms"),
])
def test_what_is_of_another_size_is_refused(named, words):
    system, _ = made("tip3p.pdb", ["tip3p.xml"])
    atoms = system.getNumParticles()
    with pytest.raises(taut.InputError, match=words.replace("648", str(atoms))):
        taut.Simulation.from_openmm(system, np.zeros((atoms, 3)), dt_fs=1, **named)


def test_sites_of_sites_have_openmms_energy_and_forces():
    rng = np.random.default_rng(3)
    system, pairs = openmm.System(), openmm.NonbondedForce()
    for atom in range(7):  # 4 and 5 are sites; the parents of 4 are 5, of a higher number, and 3
        system.addParticle(0 if atom in (4, 5) else 14)
        pairs.addParticle((-1)**atom * 0.3, 0.25, 0.5)
    system.setVirtualSite(4, openmm.TwoParticleAverageSite(5, 3, 0.6, 0.4))
    system.setVirtualSite(5, openmm.OutOfPlaneSite(0, 1, 2, 0.3, 0.4, 2.5))
    system.addForce(pairs)
    x = np.array([[0, 0, 0], [.4, 0, 0], [0, .4, .1], [.5, .5, .5], [9, 9, 9], [9, 9, 9], [.2, .1, .6]])
    sim = taut.Simulation.from_openmm(system, x + 0.01 * rng.normal(size=x.shape))
    try:
        energy, forces = reference(system, sim)
    except openmm.OpenMMException as older:
        pytest.skip(str(older))
    assert sim.energies["potential"] == pytest.approx(energy, rel=1e-9)
    moving = sim.masses > 0
    np.testing.assert_allclose(sim.forces[moving], forces[moving], rtol=1e-7, atol=1e-7 * np.abs(forces).max())


def test_what_is_no_system():
    with pytest.raises(taut.InputError, match="system: expected an object of OpenMM's"):
        taut.Simulation.from_openmm(7, np.zeros((1, 3)), box=[2, 2, 2])
    with pytest.raises(taut.InputError, match="cannot be read"):
        taut.Simulation.from_openmm("nowhere.xml", "nowhere.xml")
    with pytest.raises(taut.InputError, match="^openmm.system.xml:"):
        taut.Simulation.from_openmm("<System", "<State/>")


def test_held_ions_pull_with_openmms_forces():
    """Between atoms without other bonds the tension is τ = μ((F₁/m₁ − F₀/m₀)·n + |v₁ − v₀|²/d), F by OpenMM."""
    with taut.Simulation({
            "molecule": {"ions": {"atoms": [{"name": "NA", "mass_u": 23, "charge_e": 1, "sigma_nm": 0.24, "epsilon_kj_mol": 0.4},
                                            {"name": "CL", "mass_u": 35.5, "charge_e": -1, "sigma_nm": 0.45, "epsilon_kj_mol": 0.15}],
                                  "bonds": [[0, 1, 0.3]], "exclude": "none"}},
            "place": [{"molecule": "ions", "count": 1}, {"molecule": "tip3p", "count": 60}],
            "build": {"box_nm": 1.4}, "forcefield": {"cutoff_nm": 0.65},
            "run": {"dt_fs": 1, "temperature_k": 300, "minimise": True, "tension_of": [[0, 1]], "log_every": 10}}) as sim:
        sim.run(20)
        _, forces = reference(openmm.XmlSerializer.deserialize(sim.to_openmm_xml()[0]), sim)
        m, n = sim.masses[:2], sim.positions[1] - sim.positions[0]
        d = np.linalg.norm(n)
        apart = (forces[1] / m[1] - forces[0] / m[0]) @ n / d + ((sim.velocities[1] - sim.velocities[0])**2).sum() / d
        expected = m.prod() / m.sum() * apart
        bond = [sorted(pair) for pair in sim.bonds.tolist()].index([0, 1])
        assert abs(sim.tensions[bond] - expected) < 1e-8 * abs(expected)
        assert sim.log["tension_kj_mol_nm"].shape == (3,) and np.isfinite(sim.log["tension_kj_mol_nm"]).all()
