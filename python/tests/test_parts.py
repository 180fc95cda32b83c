import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import taut

WATER = {"build.molecules": 27, "forcefield.cutoff_nm": 0.45, "forcefield.switch_nm": 0.4}


EXAMPLE = (Path(__file__).resolve().parents[1] / "examples" / "own_method.py").read_text()
WORKED = EXAMPLE[:EXAMPLE.index("\n\n\ncharted")]


@pytest.fixture(scope="module")
def my_shake():
    names = {"__name__": "own_method"}
    exec(compile(WORKED, "own_method.py", "exec", dont_inherit=True), names)
    return names["MyShake"]


def test_the_worked_example_is_short():
    assert len([line for line in WORKED[WORKED.index("@dataclass"):].splitlines() if line.strip()]) < 25


def test_own_shake_is_shake(my_shake):
    ours = taut.Simulation("water", method=my_shake(tolerance=1e-12), dt_fs=1, set=WATER)
    theirs = taut.Simulation("water", method=taut.Shake(tolerance=1e-12), dt_fs=1, set=WATER)
    for sim in (ours, theirs):
        sim.run(20)
    assert abs(ours.positions - theirs.positions).max() < 1e-10
    assert abs(ours.velocities - theirs.velocities).max() < 1e-7
    assert ours.setting == "tolerance = 1e-12, relaxation = 1.25" and ours.summary["converged"]


@pytest.mark.parametrize("method", ["rattle", "newton", "feedforward", taut.Shake(tolerance=1e-6), "own"])
def test_verify_passes_what_is_right(method, my_shake):
    found = taut.verify(my_shake if method == "own" else method, steps=10)
    assert found["bond_error"] < 2e-6 and found["energy"] < 1e-4
    assert found["momentum"] < 1e-12 and found["across_bonds"] < 1e-9
    assert found["same_again"] and found["resumes"]


def test_verify_sees_what_is_wrong():
    class Central(taut.ConstraintMethod):
        def add_forces(self, system, push, state):
            state.forces -= state.positions

    class Forgetful(taut.ConstraintMethod):
        def prepare(self, system, h):
            self.count = 0

        def add_forces(self, system, push, state):
            self.count += 1
            i, j = system.bonds[0]
            pull = 0.1 * self.count * (state.positions[j] - state.positions[i])
            state.forces[i] += pull
            state.forces[j] -= pull

    class Mindful(Forgetful):
        kept = ("count",)

    class Chancy(taut.ConstraintMethod):
        def project_velocities(self, system, h, state):
            state.velocities *= 1 + 1e-9 * np.random.random()

    central, forgetful, mindful, chancy = (taut.verify(m, steps=6) for m in (Central, Forgetful, Mindful, Chancy))
    assert central["momentum"] > 1e-6 and central["across_bonds"] > 1e-3
    assert forgetful["same_again"] and not forgetful["resumes"] and forgetful["across_bonds"] < 1e-9
    assert mindful["resumes"] and not chancy["same_again"]
    assert np.isnan(taut.verify("rattle", "water", set=WATER, steps=2)["across_bonds"])


class Baumgarte(taut.ConstraintMethod):
    """The bond's acceleration with feedback, solved densely."""

    kept = ("multipliers",)

    def __init__(self, ah=0.5, bh=0.5):
        self.ah, self.bh = ah, bh

    def prepare(self, system, h):
        self.h = h
        self.multipliers = np.zeros(len(system.lengths))

    def add_forces(self, system, push, state):
        (i, j), w = system.bonds.T, system.inverse_masses
        r, v = state.positions[j] - state.positions[i], state.velocities[j] - state.velocities[i]
        jacobian = np.zeros((len(i), len(w), 3))
        k = np.arange(len(i))
        jacobian[k, j], jacobian[k, i] = r, -r
        flat = jacobian.reshape(len(i), -1)
        inverse = np.repeat(w, 3)
        sigma = ((r * r).sum(1) - system.lengths**2) / 2
        a, b = self.ah / self.h, self.bh / self.h
        target = flat @ (inverse * state.forces.ravel()) + (v * v).sum(1) + 2 * a * (r * v).sum(1) + b * b * sigma
        self.multipliers = np.linalg.solve(flat * inverse @ flat.T, -target)
        state.forces += (flat.T @ self.multipliers).reshape(-1, 3)


def test_a_method_of_forces_holds_bonds_and_is_kept_by_checkpoints():
    sim = taut.Simulation("double_pendulum", method=Baumgarte, dt_fs=0.5)
    sim.run(100)
    assert 1e-12 < abs(sim.bond_errors).max() < 1e-3
    again = taut.Simulation.resume(sim.checkpoint())
    for one in (sim, again):
        one.run(50)
    assert np.array_equal(sim.positions, again.positions)


def test_options_are_the_class_arguments():
    sim = taut.Simulation("double_pendulum", method=Baumgarte, set={"method.bh": 0.25})
    assert sim.setting == "ah = 0.5, bh = 0.25"
    with pytest.raises(taut.InputError, match=r"method\.gamma.*"):
        taut.Simulation("double_pendulum", method=Baumgarte, set={"method.gamma": 1})

    class Bare(taut.ConstraintMethod):
        def __init__(self, matrix):
            pass

    with pytest.raises(taut.InputError, match="Bare: its argument matrix is an option, and needs a default"):
        taut.Simulation("double_pendulum", method=Bare)

    class Rattle(taut.ConstraintMethod):
        pass

    Rattle.__name__ = "rattle"
    with pytest.raises(taut.InputError, match="is a method of taut's"):
        taut.Simulation("double_pendulum", method=Rattle)


@pytest.mark.parametrize("left, words", [
    (lambda x: x[:2], "expected numbers of shape"), (lambda x: x.ravel(), "expected numbers of shape"),
    (lambda x: x.astype(str), "could not convert|expected numbers"), (lambda x: None, "expected numbers"),
    (lambda x: [[1, 2]] * len(x), "expected numbers")])
def test_what_a_stage_may_not_leave(left, words):
    class Leaves(taut.ConstraintMethod):
        def project_positions(self, system, h, state):
            state.positions = left(state.positions)

    with pytest.raises((TypeError, ValueError), match=words):
        taut.Simulation("double_pendulum", method=Leaves).run(5)


def test_other_arrays_of_the_right_shape_are_taken():
    class Turns(taut.ConstraintMethod):
        def project_positions(self, system, h, state):
            state.positions = np.asfortranarray(state.positions + 0.0)[::-1][::-1].astype(np.float64)

    sim, plain = (taut.Simulation("double_pendulum", method=m, dt_fs=0.1) for m in (Turns, taut.ConstraintMethod))
    for one in (sim, plain):
        one.run(5)
    assert np.array_equal(sim.positions, plain.positions)


def test_not_converged_fails_the_step():
    class GivesUp(taut.ConstraintMethod):
        def project_positions(self, system, h, state):
            return taut.NotConverged(7, bond=1)

    with pytest.raises(taut.SimulationFailure, match="no convergence") as failed:
        taut.Simulation("double_pendulum", method=GivesUp).run(5)
    assert failed.value.bond == 1 and failed.value.atoms == (1, 2)


class Wall(taut.Force):
    """½k z² below z = 0."""

    def add(self, positions, forces):
        z = np.minimum(positions[:, 2], 0)
        forces[:, 2] -= 500 * z
        return 250 * (z**2).sum()


def test_a_force_pushes_and_its_energy_counts():
    start = {"build.chains": 3, "run.seed": 5}
    sim = taut.Simulation("freely_jointed", method="newton", dt_fs=1, set=start, forces=[Wall()])
    free = taut.Simulation("freely_jointed", method="newton", dt_fs=1, set=start)
    z = np.minimum(sim.positions[:, 2], 0)
    assert sim.energies["Wall"] == pytest.approx(250 * (z**2).sum()) and sim.energies["Wall"] > 0
    for one in (sim, free):
        one.run(300, every=10)
    assert abs(sim.positions - free.positions).max() > 1e-3
    total = sim.log["total_kj_mol"]
    assert np.ptp(total) < 1e-3 * sim.log["kinetic_kj_mol"].mean()
    with pytest.raises(taut.InputError, match="the force Wall is no formula, but code"):
        sim.to_openmm_xml()


def test_a_force_that_is_wrong():
    class Silent(taut.Force):
        def add(self, positions, forces):
            forces[0] += 1

    class Shape(taut.Force):
        def add(self, positions, forces):
            forces += np.ones(7)

    with pytest.raises(taut.SimulationFailure, match="Silent.add.*expected it to return its energy"):
        taut.Simulation("double_pendulum", forces=[Silent()])
    with pytest.raises(taut.SimulationFailure, match="Shape.add: ValueError"):
        taut.Simulation("double_pendulum", forces=[Shape()])
    with pytest.raises(taut.InputError, match="forces: expected instances"):
        taut.Simulation("double_pendulum", forces=[7])


def test_python_ends_after_a_part_failed_at_the_start():
    program = """
import taut
class Fails(taut.Force):
    def add(self, positions, forces):
        raise KeyError("mine")
try:
    taut.Simulation("double_pendulum", forces=[Fails()])
except taut.SimulationFailure as error:
    print(error)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0 and "Fails.add: KeyError" in done.stdout, done.stderr


class Pull(taut.Force):
    def __init__(self, strength=5.0):
        self.strength = strength

    def add(self, positions, forces):
        forces[:, 0] += self.strength
        return -self.strength * positions[:, 0].sum()


def test_forces_of_ones_own_go_on_from_a_checkpoint_or_are_asked_for(tmp_path, command):
    sim = taut.Simulation("chain", forces=[Pull(3.0)], out=tmp_path / "run")
    sim.run(10)
    kept, pickled = sim.checkpoint(), pickle.loads(pickle.dumps(sim))
    again = taut.Simulation.resume(kept, forces=[Pull(3.0)])
    for one in (sim, again, pickled):
        one.run(10)
        assert np.array_equal(sim.positions, one.positions) and "Pull" in one.energies
    for forces in ([], [Wall()], [Pull(), Pull()]):
        with pytest.raises(taut.InputError, match=r"its forces \[Pull\] are code.*Simulation.resume\(..., forces="):
            taut.Simulation.resume(kept, forces=forces)
    with pytest.raises(taut.InputError, match=r"its forces \[\] are code.*\[Pull\] came with it"):
        taut.Simulation.resume(taut.Simulation("chain").checkpoint(), forces=[Pull()])
    with pytest.raises(taut.InputError, match="forces: expected instances"):
        taut.Simulation.resume(kept, forces=[Pull])
    del sim
    done = subprocess.run([command, "resume", str(tmp_path / "run"), "--steps", "30"], capture_output=True, text=True)
    assert done.returncode == 2 and "its forces [Pull] are code" in done.stderr


def test_a_simulation_with_ones_own_method_is_pickled_with_its_class():
    sim = taut.Simulation("double_pendulum", method=Baumgarte, dt_fs=0.5)
    sim.run(5)
    program = """
import pickle, sys
sys.path.insert(0, sys.argv[1])
sim = pickle.load(sys.stdin.buffer)
sim.run(5)
print(sim.method, sim.positions[2].tolist())
"""
    done = subprocess.run([sys.executable, "-c", program, str(Path(__file__).parent)], input=pickle.dumps(sim),
                          capture_output=True)
    sim.run(5)
    assert done.stdout.decode() == f"Baumgarte {sim.positions[2].tolist()}\n", done.stderr.decode()
