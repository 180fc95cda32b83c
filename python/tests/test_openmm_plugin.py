"""TautIntegrator, the plug-in for OpenMM, under OpenMM's own programs: contexts, reporters, barostats, states."""

import copy
import io
import math
import pickle
import re
from pathlib import Path

import numpy as np
import pytest
from openmm_host import bond_error, constraints, openmm, platform, positions, refusal, total_energy, velocities

import taut
import taut.openmm

app, unit = pytest.importorskip("openmm.app"), pytest.importorskip("openmm.unit")
NM, PS = unit.nanometer, unit.picosecond
PLATFORMS = ["Reference", "CPU"]


def water(edge=1.9, model="tip3p", **named):
    """A System of water that fills a box, and its Modeller."""
    field = app.ForceField(f"{model}.xml")
    made = app.Modeller(app.Topology(), [] * NM)
    made.addSolvent(field, model="tip3p" if model == "tip3p" else "tip4pew", boxSize=openmm.Vec3(edge, edge, edge) * NM)
    named = {"nonbondedMethod": app.CutoffPeriodic, "nonbondedCutoff": min(0.9, 0.45 * edge) * NM, **named}
    return field.createSystem(made.topology, **named), made


@pytest.fixture(scope="module")
def small():
    return water(1.0, nonbondedMethod=app.NoCutoff)


def simulation(made, integrator, on="CPU"):
    system, model = made
    run = app.Simulation(model.topology, system, integrator, platform(on))
    run.context.setPositions(model.positions)
    return run


@pytest.mark.parametrize("method, error", [("feedforward", 1e-7), ("baumgarte", 1e-4), ("newton", 1e-9), ("rattle", 1e-9)])
@pytest.mark.parametrize("on", PLATFORMS)
def test_holds_bonds_and_energy(small, method, error, on):
    run = simulation(small, taut.openmm.Integrator(0.001, method), on)
    run.minimizeEnergy(maxIterations=50)
    run.context.setVelocitiesToTemperature(300, 1)
    run.step(20)
    before = total_energy(run.context)
    run.step(100)
    assert bond_error(constraints(small[0]), positions(run.context)) < error
    assert total_energy(run.context) == pytest.approx(before, abs=1.5)


@pytest.mark.parametrize("method", ["feedforward", "baumgarte", "newton"])
def test_same_trajectory_as_tauts(method):
    system, model = water(1.0)
    sim = taut.Simulation.from_openmm(system, model.positions, method=method, dt_fs=1)
    start, pushed = np.array(sim.positions), np.array(sim.velocities)
    run = simulation((system, model), taut.openmm.Integrator(0.001, method), "Reference")
    run.context.setPositions(start)
    run.context.setVelocities(pushed)
    sim.run(50)
    run.step(50)
    assert abs(positions(run.context) - sim.positions).max() < 1e-10
    assert abs(velocities(run.context) - sim.velocities).max() < 1e-8


def test_same_langevin_dynamics_as_tauts():
    """The noise of ensembles/langevin.cpp, drawn in the same order."""
    system, model = water(1.0, removeCMMotion=False)
    sim = taut.Simulation.from_openmm(system, model.positions, method="newton", dt_fs=1, set={
        "run.thermostat": "langevin", "run.temperature_k": 300, "run.friction_per_ps": 20, "run.seed": 7})
    run = simulation((system, model), taut.openmm.Integrator(0.001, "newton", temperature=300, friction=20, seed=7),
                     "Reference")
    run.context.setPositions(np.array(sim.positions))
    run.context.setVelocities(np.array(sim.velocities))
    sim.run(50)
    run.step(50)
    assert abs(positions(run.context) - sim.positions).max() < 1e-10


def test_friction_is_set_between_steps(small):
    run = simulation(small, taut.openmm.Integrator(0.001, "newton"), "Reference")
    run.minimizeEnergy(maxIterations=50)
    run.context.setVelocitiesToTemperature(300, 1)
    run.step(5)
    before = total_energy(run.context)
    run.integrator._set_bath(300, 50)
    run.step(20)
    assert abs(total_energy(run.context) - before) > 5
    run.integrator._set_bath(0, 0)
    run.step(1)
    before = total_energy(run.context)
    run.step(50)
    assert total_energy(run.context) == pytest.approx(before, abs=1.5)


def test_a_users_script_with_one_line_changed(tmp_path, monkeypatch):
    """The script of openmm_plugin/README.md, and the same with OpenMM's integrator, as its comment has it."""
    page = (Path(__file__).parents[2] / "openmm_plugin/README.md").read_text()
    script = re.search(r"```python\n(.*?)```", page, re.S).group(1)
    script = script.replace("1000)", "20)").replace("1000,", "20,").replace("step(10000)", "step(100)")
    script = script.replace("minimizeEnergy()", "minimizeEnergy(maxIterations=15)")
    theirs = re.sub(r"# instead of (.*)\n(integrator = ).*", r"\2\1", script).replace("import taut.openmm", "import openmm")
    assert "LangevinMiddleIntegrator" in theirs.split("simulation =")[0].splitlines()[-1]
    _, model = water(2.2)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMM_DEFAULT_PLATFORM", "CPU")  # on pocl 3.1 OpenMM's minimizer crashes
    logs = []
    for text in (script, theirs):
        with open("input.pdb", "w") as file:
            app.PDBFile.writeFile(model.topology, model.positions, file)
        ran = {}
        exec(text, ran)
        logs.append(np.genfromtxt("log.csv", delimiter=","))
        assert Path("output.pdb").read_text().count("MODEL") >= 5
    assert [len(log) for log in logs] == [5, 5]
    assert (logs[0][:, 0] == logs[1][:, 0]).all()
    # Both start at the same minimum and warm up alike, each with a noise of its own.
    assert logs[0][-1, 1] == pytest.approx(logs[1][-1, 1], rel=0.03)
    assert logs[0][-1, 2] == pytest.approx(logs[1][-1, 2], rel=0.3)


def test_two_runs_are_one(small):
    """Steps, however cut into calls, and energies asked for between them, leave the same bits."""
    ends = []
    for cuts in ([30], [7, 23], [1] * 30):
        run = simulation(small, taut.openmm.Integrator(0.001), "Reference")
        for cut in cuts:
            run.step(cut)
            total_energy(run.context)
        ends.append(positions(run.context))
    assert (ends[0] == ends[1]).all() and (ends[0] == ends[2]).all()


@pytest.mark.parametrize("friction", [0, 5])
def test_checkpoints_go_on_to_the_last_bit(small, friction):
    bath = {"temperature": 300, "friction": friction, "seed": 7} if friction else {}
    make = lambda: simulation(small, taut.openmm.Integrator(0.001, **bath), "Reference")
    run = make()
    run.step(20)
    kept, state = io.BytesIO(), run.context.getState(positions=True, velocities=True, integratorParameters=True)
    kept.write(run.context.createCheckpoint())
    run.step(20)
    for load in (lambda one: one.context.loadCheckpoint(kept.getvalue()), lambda one: one.context.setState(state),
                 lambda one: one.context.setState(openmm.XmlSerializer.deserialize(openmm.XmlSerializer.serialize(state)))):
        again = make()
        again.step(3)
        load(again)
        again.step(20)
        assert (positions(again.context) == positions(run.context)).all()
    moved = make()
    moved.context.loadCheckpoint(kept.getvalue())
    moved.context.setVelocities(-velocities(moved.context))  # what was loaded counts no more
    moved.step(20)
    assert abs(positions(moved.context) - positions(run.context)).max() > 1e-3


def test_xml_pickle_and_copies():
    made = taut.openmm.Integrator(2 * unit.femtosecond, "newton", tolerance=1e-8, temperature=300 * unit.kelvin,
                                  friction=1 / PS, seed=3)
    made.setIntegrationForceGroups({0, 1})
    text = openmm.XmlSerializer.serialize(made)
    for same in (openmm.XmlSerializer.deserialize(text), copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        assert openmm.XmlSerializer.serialize(same) == text
        assert same.getStepSize() == 0.002 * PS and same.getConstraintTolerance() == 1e-8
    assert copy.copy(made).getTemperature() == 300 * unit.kelvin


def test_reporters_count_degrees_of_freedom(small, tmp_path):
    run = simulation(small, taut.openmm.Integrator(0.001, temperature=300, friction=20, seed=1), "CPU")
    run.reporters.append(app.StateDataReporter(str(tmp_path / "log"), 10, step=True, temperature=True, totalEnergy=True))
    run.reporters.append(app.DCDReporter(str(tmp_path / "dcd"), 100))
    run.reporters.append(app.CheckpointReporter(str(tmp_path / "chk"), 100))
    run.minimizeEnergy(maxIterations=50)
    run.context.setVelocitiesToTemperature(300, 1)
    run.step(2000)
    log = np.genfromtxt(tmp_path / "log", delimiter=",")
    assert log[-1, 0] == 2000 and run.context.getStepCount() == 2000
    assert run.context.getTime().value_in_unit(PS) == pytest.approx(2)
    atoms = small[0].getNumParticles()
    freedom = 3 * atoms - small[0].getNumConstraints() - 3
    kept = log[40:, 2]
    assert kept.mean() == pytest.approx(300, abs=4 * 300 * math.sqrt(2 / freedom / 20))


def test_virtual_sites_barostat_and_momentum():
    made = water(1.9, "tip4pew", nonbondedMethod=app.PME)
    made[0].addForce(openmm.MonteCarloBarostat(1, 300, 5))
    run = simulation(made, taut.openmm.Integrator(0.001, temperature=300, friction=1, seed=1))
    run.context.setVelocitiesToTemperature(300, 1)
    boxes = set()
    for _ in range(10):
        run.step(10)
        boxes.add(run.context.getState().getPeriodicBoxVolume()._value)
    assert len(boxes) > 2
    x = positions(run.context)
    assert bond_error(constraints(made[0]), x) < 1e-6
    run.context.computeVirtualSites()
    assert abs(positions(run.context) - x).max() < 1e-5
    masses = np.array([made[0].getParticleMass(n)._value for n in range(len(x))])
    v = velocities(run.context)
    assert np.linalg.norm(masses @ v) < 0.05 * np.sqrt(masses @ (v**2).sum(1) * masses.sum())


def test_changes_between_steps_count(small):
    system = copy.deepcopy(small[0])
    pull = openmm.CustomExternalForce("pull*x")
    pull.addGlobalParameter("pull", 0)
    pull.addParticle(0)
    system.addForce(pull)
    run = simulation((system, small[1]), taut.openmm.Integrator(0.001), "Reference")
    run.step(5)
    run.context.setParameter("pull", -10000)
    run.step(5)
    assert velocities(run.context)[:3, 0].mean() > 0.1
    run.integrator.setStepSize(0.0005)
    run.integrator.setConstraintTolerance(1e-10)
    run.step(5)
    assert run.context.getTime().value_in_unit(PS) == pytest.approx(0.0125)
    x = positions(run.context)
    run.context.setPositions(x + 0.001 * np.random.default_rng(1).normal(size=x.shape))
    run.step(1)
    assert bond_error(constraints(system), positions(run.context)) < 1e-7
    run.context.reinitialize(preserveState=True)
    run.step(1)


def test_velocities_and_positions_are_projected(small):
    run = simulation(small, taut.openmm.Integrator(0.001), "Reference")
    x = positions(run.context) + 0.003 * np.random.default_rng(2).normal(size=(small[0].getNumParticles(), 3))
    run.context.setPositions(x)
    run.context.applyConstraints(1e-3)
    x = positions(run.context)
    assert bond_error(constraints(small[0]), x) < 1e-12
    run.context.setVelocitiesToTemperature(300, 5)
    v = velocities(run.context)
    along = [abs((x[j] - x[i]) @ (v[j] - v[i])) for i, j, _ in constraints(small[0])[:60]]
    assert max(along) < 1e-12


def test_other_integrators_keep_openmms_constraints(small):
    run = simulation(small, openmm.VerletIntegrator(0.001), "Reference")
    x = positions(run.context) + 0.003
    run.context.setPositions(x + 0.001 * np.random.default_rng(2).normal(size=x.shape))
    run.context.applyConstraints(1e-3)
    assert 1e-9 < bond_error(constraints(small[0]), positions(run.context)) < 2e-3
    run.step(2)


def test_refusals(small):
    new = taut.openmm.Integrator
    assert 'did you mean "feedforward"' in refusal(new, 0.001, "feedforwards")
    assert 'method "newton" has no option "tolerence"; did you mean "tolerance"' in refusal(new, 0.001, "newton", tolerence=1)
    assert "expected a number" in refusal(new, 0.001, tolerance="small")
    assert "step of 0 ps" in refusal(new, 0)
    assert "without friction" in refusal(new, 0.001, temperature=300)
    assert "HarmonicBondForce" in refusal(new, 0.001, "penalty")
    assert 'no option "tolerance"' in refusal(new(0.001, "none").setConstraintTolerance, 1e-6)
    assert "friction of -1" in refusal(new(0.001).setFriction, -1)
    joined = openmm.CompoundIntegrator()
    joined.addIntegrator(new(0.001))
    assert "a Context of its own" in refusal(openmm.Context, small[0], joined, platform("Reference"))
    triangle = openmm.System()
    for _ in range(3):
        triangle.addParticle(1)
    for i, j, d in ((0, 1, 1), (1, 2, 1), (0, 2, 2)):  # in line: any one depends on the others
        triangle.addConstraint(i, j, d)
    context = openmm.Context(triangle, new(0.001), platform("Reference"))
    context.setPositions([[0, 0, 0], [1, 0, 0], [2, 0, 0]])
    assert "A is singular" in refusal(context.getIntegrator().step, 1)
