"""Biases that a System already has, CustomCentroidBondForce and CustomCVForce, are the same numbers in taut."""

import numpy as np
import pytest

import taut

openmm = pytest.importorskip("openmm", reason="needs OpenMM from PyPI: pip install openmm")
unit = pytest.importorskip("openmm.unit")
ATOMS = 16


def chain(periodic):
    """A chain of springs, in a box or without one, and where its atoms are."""
    system = openmm.System()
    for a in range(ATOMS):
        system.addParticle(10 + a)
    springs = openmm.HarmonicBondForce()
    for a in range(1, ATOMS):
        springs.addBond(a - 1, a, 0.15, 5e4)
    springs.setUsesPeriodicBoundaryConditions(periodic)
    system.addForce(springs)
    system.setDefaultPeriodicBoxVectors(*np.diag([4.0, 4.5, 5.0]))
    a = np.arange(ATOMS)[:, None]
    return system, 0.13 * np.hstack([np.cos(a), np.sin(1.3 * a) + 0.2 * a, np.sin(0.7 * a) * 0.5])


def centroid(energy, groups, parameters=(), weights=None, periodic=False, name=None, **of_all):
    force = openmm.CustomCentroidBondForce(len(groups), energy)
    for key, value in of_all.items():
        force.addGlobalParameter(key, value)
    for key, _ in parameters:
        force.addPerBondParameter(key)
    for group in groups:
        force.addGroup(group, *(weights or {}).get(tuple(group), []))
    force.addBond(range(len(groups)), [value for _, value in parameters])
    force.setUsesPeriodicBoundaryConditions(periodic)
    if name:
        force.setName(name)
    return force


def of_one_variable(energy, variable, **of_all):
    force = openmm.CustomCVForce(energy)
    force.addCollectiveVariable("cv", variable)
    for key, value in of_all.items():
        force.addGlobalParameter(key, value)
    return force


def on_atoms(kind, add, *atoms):
    force = getattr(openmm, kind)("r" if kind == "CustomBondForce" else "theta")
    getattr(force, add)(*atoms, [])
    return force


TWO, THREE, FOUR = [[0, 1, 2], [9, 12]], [[0, 1, 2], [5, 6], [9, 12]], [[0, 1], [4, 5, 6], [9], [12, 15]]
WOUND = "0.5*k*min(d,2*3.14159265-d)^2; d=abs(dihedral(g1,g2,g3,g4)-phi)"
BIASES = {
    "umbrella": lambda p: centroid("0.5*k*(distance(g1,g2)-r0)^2", TWO, [("k", 400), ("r0", 0.3)], periodic=p),
    "literal walls": lambda p: centroid("150*(max(0,1.2-d)^2+max(0,d-1.4)^2); d=distance(g1,g2)", TWO, periodic=p),
    "weights of its own": lambda p: centroid("k*(distance(g1,g2)-r0)^2", TWO, k=200.0, r0=0.1, periodic=p,
                                             weights={(0, 1, 2): [[1.0, 1.0, 3.0]]}),
    "torsion": lambda p: centroid(WOUND, FOUR, [("phi", -2.5)], k=50.0, periodic=p),
    "variable of an angle": lambda p: of_one_variable("k*(cv-at)^2",
                                                      on_atoms("CustomAngleForce", "addAngle", 0, 6, 9), k=50.0, at=2.5),
    "variable of centres": lambda p: of_one_variable("-F*cv", centroid("distance(g1,g2)", TWO, periodic=p), F=20.0),
}


def reference(system, sim):
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(sim.positions)
    state = context.getState(getEnergy=True, getForces=True)
    return state.getPotentialEnergy()._value, state.getForces(asNumpy=True)._value


@pytest.mark.parametrize("periodic", [False, True], ids=["no box", "box"])
@pytest.mark.parametrize("name", BIASES)
def test_a_systems_own_bias(name, periodic):
    system, x = chain(periodic)
    plain = taut.Simulation.from_openmm(system, x, dt_fs=1).energies["potential"]
    system.addForce(BIASES[name](periodic))
    sim = taut.Simulation.from_openmm(system, x, dt_fs=1)
    assert abs(sim.energies["potential"] - plain) > 0.1, "the bias does not act here"
    energy, forces = reference(system, sim)
    exact = 1e-7 if name == "torsion" else 1e-9  # its π has eight digits
    assert sim.energies["potential"] == pytest.approx(energy, rel=exact)
    assert abs(sim.forces - forces).max() < 1e-6 * abs(forces).max()
    again, state = sim.to_openmm()
    assert reference(again, sim)[0] == pytest.approx(energy, rel=1e-7)
    assert taut.Simulation.from_openmm(again, state, dt_fs=1).energies["potential"] == pytest.approx(energy, rel=1e-7)


def test_more_biases_are_added_and_each_has_its_columns():
    system, x = chain(False)
    system.addForce(centroid("0.5*k*(distance(g1,g2)-r0)^2", TWO, [("k", 400), ("r0", 0.3)], name="site"))
    system.addForce(centroid("0.5*k*(angle(g1,g2,g3)-theta0)^2", THREE, theta0=1.0, k=200.0))
    system.addForce(of_one_variable("-F*cv", on_atoms("CustomBondForce", "addBond", 0, 9), F=20.0))
    alone = taut.Simulation.from_openmm(system, x, dt_fs=1)
    sim = taut.Simulation.from_openmm(system, x, dt_fs=1, biases=[taut.Distance(0, 15, at_nm=1, k_kj_mol_nm2=200)])
    assert sim.energies["bias"] > alone.energies["bias"] + 1
    sim.run(20, every=10)
    found = [name for name in sim.log if name.startswith("bias_") and "force" not in name]
    assert found == ["bias_site_nm", "bias_1_deg", "bias_cv_nm", "bias_3_nm"]
    ends = np.linalg.norm(sim.positions[15] - sim.positions[0])
    assert sim.log["bias_3_nm"][-1] == pytest.approx(ends, rel=1e-9)
    copy = taut.Simulation.resume(sim.checkpoint())
    for one in (sim, copy):
        one.run(20)
    assert np.array_equal(sim.positions, copy.positions)


def test_a_parameter_of_the_state_counts():
    system, x = chain(False)
    system.addForce(centroid("0.5*k*(distance(g1,g2)-r0)^2", TWO, r0=0.3, k=400.0))
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(x)
    context.setParameter("r0", 1.2)
    state = context.getState(getPositions=True, getEnergy=True, getParameters=True)
    sim = taut.Simulation.from_openmm(system, state, dt_fs=1)
    assert sim.energies["potential"] == pytest.approx(state.getPotentialEnergy()._value, rel=1e-9)


def without_mass_or_weight():
    return centroid("0.5*k*(distance(g1,g2)-r0)^2", TWO, k=1.0, r0=0.3, weights={(9, 12): [[1.0, -1.0]]})


REFUSED = {
    "no law": (lambda: centroid("k*distance(g1,g2)^3", TWO, k=1.0), r"force 1: CustomCentroidBondForce: has the energy "
               r"k\*distance\(g1,g2\)\^3.*: taut knows harmonic restraints, walls and constant pulls"),
    "weights that add to 0": (without_mass_or_weight, "add to 0"),
    "root mean square distance": (lambda: of_one_variable("k*cv^2", openmm.RMSDForce(chain(False)[1]), k=1.0),
                                  "RMSDForce is no collective variable taut has.*taut.Distance"),
    "a variable of two terms": (lambda: of_one_variable("k*(cv-1)^2", two_bonds(), k=1.0), "of one term, got r of 2"),
}


def two_bonds():
    force = on_atoms("CustomBondForce", "addBond", 0, 9)
    force.addBond(0, 12, [])
    return force


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_not_carried_out_is_refused_with_a_remedy(name):
    make, words = REFUSED[name]
    system, x = chain(False)
    system.addForce(make())
    with pytest.raises(taut.InputError, match=words):
        taut.Simulation.from_openmm(system, x, dt_fs=1)


def test_a_group_broken_across_the_box_is_refused():
    system, x = chain(True)
    system.addForce(centroid("0.5*k*(distance(g1,g2)-r0)^2", TWO, k=400.0, r0=0.3, periodic=True))
    broken = x.copy()
    broken[:2] += [4.0, 0, 0]
    with pytest.raises(taut.InputError, match="atoms 2 and 0 in molecules that are broken across the box"):
        taut.Simulation.from_openmm(system, broken, dt_fs=1)
    moved = taut.Simulation.from_openmm(system, x + [4.0, 0, 0], dt_fs=1)
    assert moved.energies["potential"] == pytest.approx(reference(system, moved)[0], rel=1e-9)
