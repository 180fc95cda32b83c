"""A custom energy is either the number that OpenMM has, or refused: never another energy that it resembles."""

import numpy as np
import pytest

import taut

openmm = pytest.importorskip("openmm", reason="needs OpenMM from PyPI: pip install openmm")
FAR = np.array([[0, 0, 3], [5, 0, 3], [5.3, 0.2, 3], [6, 1, 3]])  # beyond every turn below
NEAR = np.array([[0.1, 0.2, 0.3], [0.5, 0.1, 0.4], [0.9, 0.5, 0.4], [1.1, 0.7, 0.2]])


def bond(energy):
    force = openmm.CustomBondForce(energy)
    for name in ("k", "r0"):
        force.addPerBondParameter(name)
    force.addBond(0, 1, [1000.0, 0.5])
    return force


def centres(energy):
    force = openmm.CustomCentroidBondForce(2, energy)
    for name in ("k", "at"):
        force.addPerBondParameter(name)
    force.addGroup([0])
    force.addGroup([1, 2])
    force.addBond([0, 1], [1000.0, 1.0])
    return force


def outside(energy, **of_each):
    force = openmm.CustomExternalForce(energy)
    for name in of_each:
        force.addPerParticleParameter(name)
    for a in range(4):
        force.addParticle(a, [value * (1 + a) for value in of_each.values()])
    return force


TAKEN = {
    "field on charges": lambda: outside("-q*E*z", q=3.0, E=0.5),
    "weight": lambda: outside("m*g*z", m=3.0, g=2.0),
    "plane": lambda: outside("0.5*k*(z-z0)^2", k=100.0, z0=0.1),
    "flat-bottomed sphere": lambda: outside("0.5*k*max(0,r-R)^2; r=sqrt(x^2+y^2+z^2)", k=100.0, R=0.3),
    "layer": lambda: outside("k*max(0,abs(z-0.5)-0.1)^2", k=100.0),
    "half space": lambda: outside("k*max(0,z-z0)^2", k=100.0, z0=0.05),
    "spring": lambda: bond("k*(r-r0)^2"),
    "umbrella": lambda: centres("0.5*k*(distance(g1, g2)-at)^2"),
}
REFUSED = {
    "spring that ends": lambda: bond("0.5*k*(r-r0)^2*step(4-r)"),
    "linear tail": lambda: bond("select(step(r-r0-3), k*3*(r-r0-1.5), 0.5*k*(r-r0)^2)"),
    "capped": lambda: bond("0.5*k*min(r-r0,3.5)^2"),
    "weak quartic": lambda: bond("0.5*k*(r-r0)^2+1e-6*k*(r-r0)^4"),
    "umbrella with a linear tail": lambda: centres(
        "select(step(distance(g1,g2)-at-1), k*(distance(g1,g2)-at-0.5), 0.5*k*(distance(g1,g2)-at)^2)"),
    "umbrella that ends": lambda: centres("0.5*k*(distance(g1,g2)-at)^2*step(2-distance(g1,g2))"),
    "field in a part of the box": lambda: outside("-(fx*x+fy*y+fz*z)*step(2-z)", fx=0.0, fy=0.0, fz=5.0),
    "pull in a slab": lambda: outside("-(fx*x+fy*y+fz*z)*step(1.5-x)", fx=5.0, fy=0.0, fz=0.0),
    "restraint capped far": lambda: outside("0.5*k*min((x-x0)^2+(y-y0)^2+(z-z0)^2,25)", k=9.0, x0=0.0, y0=0.0, z0=0.0),
    "of no coordinate": lambda: outside("max(k,1e9)", k=9.0),
    "restraint that ends": lambda: outside("0.5*k*d2*step(16-d2);d2=(x-x0)^2+(y-y0)^2+(z-z0)^2",
                                           k=9.0, x0=0.0, y0=0.0, z0=0.0),
}


def system_of(force):
    system = openmm.System()
    for _ in range(4):
        system.addParticle(20.0)
    system.addForce(force)
    return system


@pytest.mark.parametrize("x", [NEAR, FAR], ids=["near", "far"])
@pytest.mark.parametrize("name", TAKEN)
def test_what_is_taken_is_what_openmm_computes(name, x):
    system = system_of(TAKEN[name]())
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(x)
    state = context.getState(getEnergy=True, getForces=True)
    sim = taut.Simulation.from_openmm(system, x)
    assert sim.energies["potential"] == pytest.approx(state.getPotentialEnergy()._value, rel=1e-9)
    np.testing.assert_allclose(sim.forces, state.getForces(asNumpy=True)._value, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", REFUSED)
def test_what_only_resembles_one_is_refused(name):
    force = REFUSED[name]()
    with pytest.raises(taut.InputError, match="has the energy ") as refused:
        taut.Simulation.from_openmm(system_of(force), FAR)
    assert force.getEnergyFunction() in str(refused.value)


def test_a_constant_part_is_left_out_with_a_note():
    sim = taut.Simulation.from_openmm(system_of(outside("m*g*(z-2)", m=3.0, g=2.0)), NEAR)
    assert any("-360 kJ/mol with all atoms at the origin" in note for note in sim.notes)  # (3·2 + 6·4 + …)·(−2)


@pytest.mark.parametrize("settings", [{}, {"run.minimise": True}], ids=["as it is", "minimised"])
def test_atoms_in_one_place_are_named(settings):
    force = openmm.NonbondedForce()
    for _ in range(4):
        force.addParticle(0.3, 0.3, 0.8)
    x = NEAR.copy()
    x[2] = x[1]
    with pytest.raises(taut.InputError, match="atoms 1 and 2 are in one place"):
        taut.Simulation.from_openmm(system_of(force), x, set=settings)
