"""A run may be written to, interrupted and go wrong anywhere: it is then as one that was stopped there, or never
disturbed, to the last bit."""

import itertools

import numpy as np
import pytest

import taut

WATER = {"build.molecules": 216, "forcefield.cutoff_nm": 0.6, "forcefield.switch_nm": 0.5}
BATHS = {
    "alone": {},
    "rescaling": {"run.thermostat": "rescaling", "run.thermostat_ps": 0.1, "run.temperature_k": 300},
    "langevin": {"run.thermostat": "langevin", "run.temperature_k": 300},
    "c-rescale": {"run.thermostat": "rescaling", "run.thermostat_ps": 0.1, "run.temperature_k": 300,
                  "run.barostat": "c-rescale", "run.barostat_every": 4},
    "monte-carlo": {"run.thermostat": "langevin", "run.temperature_k": 300, "run.barostat": "monte-carlo",
                    "run.barostat_every": 4},
}


def expect_same(one, other, log=True):
    for name in ("positions", "velocities", "forces", "box", "time_ps", "steps_taken"):
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
    assert one.energies == other.energies
    assert np.array_equal(one.tensions, other.tensions)
    for name, column in one.log.items() if log else ():
        assert name == "ns_per_day" or np.array_equal(column, other.log[name], equal_nan=True), name


class Own(taut.ConstraintMethod):
    """Holds nothing, and keeps a number."""

    kept = ("count", "last")
    act = None

    def prepare(self, system, h):
        self.count, self.last = 0.0, np.zeros((len(system.masses), 3))

    def project_positions(self, system, h, state):
        self.come_to("project_positions", h, state)

    def add_forces(self, system, push, state):
        self.come_to("add_forces", push.last_h, state)

    def project_velocities(self, system, h, state):
        self.come_to("project_velocities", h, state)

    def come_to(self, stage, h, state):
        self.count += 1
        self.last = state.velocities.copy()
        state.velocities *= 1 - 1e-7 * self.count * (h > 0)  # what is to be seen if it is not taken back
        if type(self).act is not None:
            type(self).act(stage)


class Field(taut.Force):
    def __init__(self, act=lambda place: None):
        self.act = act

    def add(self, positions, forces):
        forces[:, 2] += 0.5
        self.act("add")
        return -0.5 * positions[:, 2].sum()


@pytest.mark.parametrize("bath", BATHS)
@pytest.mark.parametrize("method", ["feedforward", "penalty", Own])
def test_written_in_a_callback_is_as_between_runs(method, bath):
    held = method not in ("penalty", Own)
    watched, stopped = (taut.Simulation("water", method=method, dt_fs=1 if held else 0.05, set={**WATER, **BATHS[bath]})
                        for _ in range(2))
    views = watched.positions, watched.velocities

    def write(sim):
        before = sim.energies["kinetic"]
        sim.velocities[:] *= 0.5
        now = sim.energies["kinetic"]  # what lay along bonds that are not held is taken out
        assert now == pytest.approx(before / 4, rel=1e-2) if held else now < 0.26 * before
        sim.positions[:3] += 0.01
        sim.positions[4] += 0.001
        assert sim.energies and abs(sim.bond_errors).max() < (1e-8 if held else 0.05)

    watched.run(40, every=10, callback=lambda row: write(watched) if row.step in (0, 20, 40) else None)
    write(stopped)
    for _ in range(2):
        stopped.run(20, every=10)
        write(stopped)
    expect_same(watched, stopped, log=False)
    assert list(watched.log["step"]) == [0, 10, 20, 30, 40]
    assert np.shares_memory(views[0], watched.positions) and np.array_equal(views[1], watched.velocities)
    for one in (watched, stopped):
        one.run(5)
    expect_same(watched, stopped, log=False)


class Custom(BaseException):
    pass


EXCEPTIONS = [KeyboardInterrupt, SystemExit, GeneratorExit, ZeroDivisionError, Custom]
PLACES = ["add", "project_positions", "add_forces", "project_velocities"]


def disturbed(place, thrown, bath, at):
    """A simulation whose own code throws when it comes to a place for the n-th time, one that does not, and how often
    the first came to each place."""
    seen = {name: 0 for name in PLACES}

    def act(where):
        seen[where] += 1
        if where == place and seen[where] == at:
            raise thrown("mine")

    Disturbing = type("Own", (Own,), {"act": staticmethod(act)})
    settings = {**WATER, **BATHS[bath]}
    if place == "add":
        sims = [taut.Simulation("water", method="feedforward", set=settings, forces=[Field(), f])
                for f in (Field(act), Field())]
    else:
        sims = [taut.Simulation("water", method=method, dt_fs=0.05, set=settings, forces=[Field()])
                for method in (Disturbing, Own)]
    return (*sims, seen)


@pytest.mark.parametrize("bath, place, thrown", [
    *((bath, "add", KeyboardInterrupt) for bath in BATHS), *(("alone", "add", thrown) for thrown in EXCEPTIONS),
    *(("alone", place, ZeroDivisionError) for place in PLACES[1:]),
    *(("c-rescale", place, Custom) for place in PLACES[1:])])
@pytest.mark.parametrize("at", [5, 20])
def test_an_exception_in_a_step_takes_it_back(bath, place, thrown, at):
    sim, undisturbed, seen = disturbed(place, thrown, bath, at)
    with pytest.raises(thrown, match="mine"):
        sim.run(40, every=5)
    assert seen[place] == at  # and is not called again
    taken = sim.steps_taken
    assert taken > 0
    undisturbed.step(taken)
    expect_same(sim, undisturbed, log=False)
    assert seen[place] == at
    sim.run(40 - taken, every=5)
    undisturbed.run(40 - taken, every=5)
    expect_same(sim, undisturbed, log=False)
    never = disturbed(place, thrown, bath, -1)[1]
    never.run(40, every=5)
    expect_same(sim, never)
    for key in ("energy_drift_kj_mol_ns_dof", "constraint_work_kj_mol", "temperatures_k", "pressure_bar"):
        assert sim.summary[key] == never.summary[key]


@pytest.mark.parametrize("thrown", [KeyboardInterrupt, ZeroDivisionError])
@pytest.mark.parametrize("bath", ["alone", "monte-carlo"])
def test_an_exception_in_a_start_or_a_minimisation_takes_it_back(bath, thrown):
    asks = {"minimise": lambda sim: sim.minimise(10), "energies": lambda sim: sim.energies,
            "run": lambda sim: sim.run(1)}
    for name, ask in asks.items():
        left = []  # calls until it throws

        def act(place):
            if left and left.pop() is None:
                raise thrown("mine")

        sim, undisturbed = (taut.Simulation("water", method="feedforward", set={**WATER, **BATHS[bath]}, forces=[f])
                            for f in (Field(act), Field()))
        for one in (sim, undisturbed):
            one.run(10)
        if name != "minimise":
            sim.velocities[:] *= 0.5
        left[:] = [None, 1, 1, 1] if name == "minimise" else [None]
        with pytest.raises(thrown, match="mine"):
            ask(sim)
        assert not left
        expect_same(sim, undisturbed)
        for one in (sim, undisturbed):
            one.run(15)
        expect_same(sim, undisturbed)


@pytest.mark.parametrize("thrown", [KeyboardInterrupt, KeyError])
@pytest.mark.parametrize("step", [0, 10, 20])
def test_an_exception_in_a_callback_stops_between_steps(thrown, step, tmp_path):
    sim, other = (taut.Simulation("water", set=WATER, out=tmp_path / name) for name in ("sim", "other"))

    def raises(row):
        if row.step == step:
            raise thrown("mine")

    with pytest.raises(thrown, match="mine"):
        sim.run(20, every=10, callback=raises)
    assert sim.steps_taken == step
    if step < 20:
        sim.run(20 - step, every=10)
    other.run(20, every=10)
    expect_same(sim, other)


def test_written_before_the_callback_threw_counts():
    sim, other = (taut.Simulation("water", set=WATER) for _ in range(2))

    def raises(row):
        if row.step == 10:
            sim.velocities[:] *= 0.5
            raise KeyError("mine")

    with pytest.raises(KeyError):
        sim.run(20, every=10, callback=raises)
    other.run(10)
    other.velocities[:] *= 0.5
    assert other.energies == sim.energies
    expect_same(sim, other, log=False)


@pytest.mark.parametrize("part", ["positions", "velocities"])
@pytest.mark.parametrize("step", [0, 10, 20])
def test_nan_written_in_a_callback_is_the_writers(part, step):
    sim, other = (taut.Simulation("water", set=WATER) for _ in range(2))

    def spoils(row):
        if row.step == step:
            getattr(sim, part)[5, 1] = np.nan

    words = rf"the callback of step {step}: {part}\[5\]: .* nan, .* was written there, expected finite .* is undone"
    with pytest.raises(taut.InputError, match=words) as failed:
        sim.run(20, every=10, callback=spoils)
    assert "\n" not in str(failed.value)
    other.run(20, every=10, callback=lambda row: row.step < step)
    expect_same(sim, other)


def test_what_no_bonds_can_follow_is_undone_in_a_callback():
    sim, other = (taut.Simulation("water", set=WATER) for _ in range(2))

    def spoils(row):
        sim.positions[:] = 0

    with pytest.raises(taut.SimulationFailure):
        sim.run(20, every=10, callback=lambda row: spoils(row) if row.step == 10 else None)
    other.run(10)
    expect_same(sim, other)


@pytest.mark.parametrize("stage", PLACES)
def test_nan_of_ones_own_code_is_its_own(stage):
    class Spoils(taut.ConstraintMethod):
        pass

    def act(self, system, h, state):
        if state.time_ps > 0.0025:
            getattr(state, "forces" if stage == "add_forces" else "velocities")[4] = np.nan

    class Field(taut.Force):
        def add(self, positions, forces):
            if len(calls) > 3:
                forces[4] = np.nan
            calls.append(1)
            return 0.0

    calls = []
    if stage == "add":
        sim = taut.Simulation("chain", forces=[Field()], dt_fs=1)
    else:
        setattr(Spoils, stage, act)
        sim = taut.Simulation("chain", method=Spoils, dt_fs=1)
    with pytest.raises(taut.SimulationFailure, match=rf"{stage} left nan, nan, nan in .*\[4\]") as failed:
        sim.run(10)
    assert failed.value.step == sim.steps_taken + 1 and failed.value.bond is None
    assert np.isfinite(sim.positions).all() and np.isfinite(sim.forces).all()


@pytest.mark.parametrize("answer", [False, np.False_, np.bool_(0), None, 0, [], np.array([])])
def test_a_falsehood_stops_and_nothing_else(answer):
    sim, stops = taut.Simulation("chain"), isinstance(answer, (bool, np.bool_))
    sim.run(20, every=10, callback=lambda row: answer)
    assert sim.steps_taken == (0 if stops else 20)
    sim.run(100, every=10, callback=lambda row: answer if row.step >= 30 else np.True_)
    assert sim.steps_taken == (30 if stops else 120)


def test_code_that_asks_the_simulation_it_is_in():
    class Nosy(taut.Force):
        sim = None

        def add(self, positions, forces):
            if self.sim is not None and self.ask is not None:
                self.ask(self.sim)
            return 0.0

    sim = taut.Simulation("chain", forces=[nosy := Nosy()])
    nosy.sim = sim
    for ask in (lambda s: s.energies, lambda s: s.run(1), lambda s: s.minimise(), lambda s: s.checkpoint()):
        nosy.ask = ask
        for act in (lambda: sim.run(5), lambda: sim.minimise(1)):
            with pytest.raises(RuntimeError, match="it is (running|in the middle of a step)"):
                act()
        sim.velocities[:] *= 0.9
        with pytest.raises(RuntimeError, match="it is (running|in the middle of a step)"):
            sim.energies
        nosy.ask = None
        sim.run(2)
    nosy.ask = lambda s: s.positions.sum() + s.steps_taken
    sim.run(2)


def test_code_that_runs_another_simulation():
    class Wraps(taut.Force):
        def add(self, positions, forces):
            other = taut.Simulation("pair")
            other.run(2)
            if next(count) == 5:
                raise ZeroDivisionError("mine")
            return 0.0

    count = itertools.count()
    sim = taut.Simulation("chain", forces=[Wraps()])
    with pytest.raises(ZeroDivisionError):
        sim.run(10)
    assert sim.steps_taken == 5 - 1


def test_why_a_start_failed_is_its_cause():
    class Fails(taut.Force):
        def add(self, positions, forces):
            raise KeyError("mine")

    with pytest.raises(taut.SimulationFailure, match="Fails.add: KeyError") as failed:
        taut.Simulation("chain", forces=[Fails()])
    assert isinstance(failed.value.__cause__, KeyError)
