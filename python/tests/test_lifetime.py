"""A simulation is freed with what knows it: forces, methods, views and callbacks that hold it in turn."""

import gc
import weakref

import pytest

import taut


def knowing_force():
    class Knows(taut.Force):
        def add(self, positions, forces):
            return 0.0

    force = Knows()
    force.sim = taut.Simulation("pair", forces=[force])
    return force.sim


def knowing_views():
    sim = knowing_force()
    sim._forces[0].views = sim.positions, sim.velocities[1:], sim.forces
    return sim


def knowing_method():
    known = []

    class Knows(taut.ConstraintMethod):
        def add_forces(self, system, push, state):
            self.sim = known[0] if known else None

    known.append(taut.Simulation("pair", method=Knows))
    return known[0]


def knowing_callback():
    sim = taut.Simulation("pair")
    sim.run(3, every=1, callback=lambda row: sim.velocities)
    return sim


def knowing_failure():
    sim = knowing_force()
    sim._forces[0].add = lambda positions, forces: 1 / 0
    with pytest.raises(ZeroDivisionError):
        sim.run(2)
    sim._forces[0].add = lambda positions, forces: 0.0
    return sim


@pytest.mark.parametrize("make", [knowing_force, knowing_views, knowing_method, knowing_callback, knowing_failure])
def test_what_knows_its_simulation_is_freed_with_it(make):
    alive = []
    for _ in range(200):
        sim = make()
        sim.run(1)
        alive += [weakref.ref(sim), weakref.ref(sim._engine)]
    del sim
    gc.collect()
    assert sum(ref() is not None for ref in alive) <= 2  # the last method's class is registered


def test_collecting_at_any_time():
    threshold = gc.get_threshold()
    gc.set_threshold(1)
    try:
        for make in (knowing_force, knowing_views, knowing_method, knowing_failure):
            sims = [make() for _ in range(3)]
            for sim in sims:
                sim.run(3)
                sim.velocities[:] *= 0.5
                sim.minimise()
            del sims, sim
    finally:
        gc.set_threshold(*threshold)
