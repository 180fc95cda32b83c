"""What a stage of a method or a force in Python sees: the engine's own numbers, for the length of the call."""

import gc
import inspect
import os

import numpy as np
import pytest

import taut


class Passive(taut.ConstraintMethod):
    """Does nothing; what a test hands it does."""

    act = None

    def project_positions(self, system, h, state):
        return None if self.act is None else type(self).act(system, h, state)


def acting(act):
    return type("Acting", (Passive,), {"act": staticmethod(act)})


def test_stages_see_the_engines_own_numbers():
    seen = []

    def look(system, h, state):
        seen.append(np.shares_memory(state.positions, sim.positions) if sim else None)
        assert all(a.flags.writeable and not a.flags.owndata and a.shape == (len(system.masses), 3)
                   for a in (state.positions, state.velocities, state.forces))

    sim = None
    sim = taut.Simulation("double_pendulum", method=acting(look))
    sim.positions
    sim.run(3)
    assert seen[-3:] == [True] * 3


def test_the_system_cannot_be_written_to_and_may_be_kept():
    kept = []

    def keep(system, h, state):
        kept.append(system.masses)
        for array in (system.masses, system.inverse_masses, system.bonds, system.lengths):
            with pytest.raises(ValueError, match="read-only"):
                array[:] = 0

    taut.Simulation("double_pendulum", method=acting(keep)).run(3)
    gc.collect()
    assert np.array_equal(kept[0], kept[-1]) and kept[0].sum() > 0


@pytest.mark.parametrize("viewed", [False, True], ids=["", "viewed before"])
@pytest.mark.parametrize("keep", [
    lambda s: s.positions, lambda s: s.velocities[1:].T, lambda s: memoryview(s.forces), lambda s: s.positions.flat,
], ids=["array", "slice", "buffer", "iterator"])
def test_a_stage_that_keeps_a_view_fails_and_what_it_kept_stays_readable(keep, viewed):
    kept = []
    method = acting(lambda system, h, state: kept.append(keep(state)) if state.time_ps > 0.0025 else None)
    sim = taut.Simulation("double_pendulum", method=method, dt_fs=1)
    before = sim.positions if viewed else None
    with pytest.raises(BufferError, match=r"it kept a view of state\.(positions|velocities|forces).*copy\(\)"):
        sim.run(10)
    assert sim.steps_taken == 2
    assert not viewed or np.shares_memory(before, sim.positions)
    sim.velocities[:] = 0
    del sim, before, method
    gc.collect()
    junk = [np.full((3, 3), 7.0) for _ in range(1000)]
    assert len(junk) == 1000 and all(np.isfinite(np.array(list(np.ravel(k)))).all() for k in kept)
    assert not any((np.ravel(k) == 7.0).any() for k in kept)


def test_views_in_a_traceback_stay_readable():
    def breaks(system, h, state):
        x = state.positions  # noqa: F841  in the traceback
        raise ZeroDivisionError

    def run():
        with pytest.raises((ZeroDivisionError, taut.SimulationFailure)) as failed:
            sim = taut.Simulation("double_pendulum", method=acting(breaks), dt_fs=1)
            sim.run(5)
        return failed

    failed = run()
    gc.collect()
    frames = [frame.frame for frame in inspect.getinnerframes(failed.value.__traceback__) if frame.function == "breaks"]
    assert frames and all(np.isfinite(frame.f_locals["x"]).all() for frame in frames)


def test_a_state_is_empty_between_stages():
    kept = []
    taut.Simulation("double_pendulum", method=acting(lambda system, h, state: kept.append(state))).run(3)
    with pytest.raises(AttributeError, match=r"state\.positions: .*during a stage alone"):
        kept[0].positions


@pytest.mark.parametrize("turned", [lambda x: x, lambda x: x[::-1][::-1], np.array, np.asfortranarray])
def test_arrays_that_change_places(turned):
    class Turns(taut.ConstraintMethod):
        def project_velocities(self, system, h, state):
            state.velocities, state.forces = turned(state.forces), turned(state.velocities)

    sim, plain = (taut.Simulation("double_pendulum", method=m, dt_fs=0.1) for m in (Turns, taut.ConstraintMethod))
    for one in (sim, plain):
        one.step()
    assert np.array_equal(sim.velocities, plain.forces) and np.array_equal(sim.forces, plain.velocities)


def pulling(act):
    class Pulling(taut.Force):
        def add(self, positions, forces):
            act(positions, forces)
            forces[:, 2] += 1
            return -positions[:, 2].sum()

    return Pulling()


def test_a_force_sees_the_states_own_positions_and_zeros():
    seen = []

    def look(positions, forces):
        assert not positions.flags.writeable and not forces.any() and forces.shape == positions.shape
        with pytest.raises(ValueError, match="read-only"):
            positions[:] = 0
        seen.append(sim is not None and np.shares_memory(positions, sim.positions))
        forces[:] = 7  # it may set what it adds: others' forces are not in there
        forces[:] = 0

    sim = None
    sim = taut.Simulation("chain", forces=[pulling(look), pulling(look)])
    plain = taut.Simulation("chain")
    assert np.array_equal(sim.positions, plain.positions)
    assert np.allclose(sim.forces.sum(0) - plain.forces.sum(0), [0, 0, 2 * len(sim.masses)])
    sim.run(3)
    assert sum(seen) == 2 * 3, seen


@pytest.mark.parametrize("viewed", [False, True], ids=["", "viewed before"])
@pytest.mark.parametrize("which", [0, 1], ids=["positions", "forces"])
def test_a_force_that_keeps_a_view_fails_and_what_it_kept_stays_readable(which, viewed):
    kept, calls = [], []

    def keep(*arrays):
        calls.append(None)
        if len(calls) > 4:
            kept.append(arrays[which][1:])

    sim = taut.Simulation("chain", forces=[pulling(keep)])
    before = sim.positions if viewed else None
    with pytest.raises(BufferError, match=f"it kept a view of {['positions', 'forces'][which]}, .*copy"):
        sim.run(10)
    assert not viewed or np.shares_memory(before, sim.positions)
    x = sim.positions.copy()
    del sim, before
    gc.collect()
    junk = [np.full(x.shape, 7.0) for _ in range(1000)]
    expected = np.array([[0, 0, 1.0]] * (len(x) - 1)) if which else x[1:]
    assert len(junk) == 1000 and np.allclose(kept[0], expected, atol=0.1)


def test_a_cycle_around_positions_costs_no_full_collection():
    def make_cycle(positions, forces):
        cycle = [positions]
        cycle.append(cycle)

    sim, seen = taut.Simulation("pair", forces=[pulling(make_cycle)]), []

    def watch(phase, about):
        seen.append(about["generation"])

    gc.callbacks.append(watch)
    try:
        sim.run(20)
    finally:
        gc.callbacks.remove(watch)
    assert seen.count(0) >= 40 and seen.count(2) <= 2


def memory_mib():
    with open("/proc/self/statm") as numbers:
        return int(numbers.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 2**20


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="needs Linux's /proc")
def test_memory_is_flat_over_many_simulations():
    def run_one():
        taut.Simulation("pair").step(2)

    def run_one_in_a_cycle():
        force = pulling(lambda positions, forces: None)
        force.sim = taut.Simulation("pair", forces=[force])
        force.view = force.sim.positions
        force.sim.reporters.append(taut.Call(lambda sim, keep=force.sim: None, every=1))
        force.sim.step(2)

    for make in (run_one, run_one_in_a_cycle):
        for _ in range(200):
            make()
        gc.collect()
        before = memory_mib()
        for _ in range(1000):
            make()
        gc.collect()
        assert memory_mib() - before < 4, make.__name__  # a Simulation that stayed holds 27 kB
