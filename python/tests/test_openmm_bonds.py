"""taut.openmm.Integrator(bonds=…): rigid bonds that are the integrator's, and no constraints of the System."""

import copy
import math
import pickle

import numpy as np
import pytest
from openmm_host import bond_error, openmm, platform, positions, refusal, total_energy, velocities

import taut.openmm

app, unit = pytest.importorskip("openmm.app"), pytest.importorskip("openmm.unit")
PLATFORMS = ["Reference", "CPU"]
if "OpenCL" in taut.openmm.platforms() and platform("OpenCL").getDevices():
    PLATFORMS.append("OpenCL")
R = 8.31446261815324e-3  # kJ/mol/K


def cholesterols(count=4):
    """Martini 2's frame (doi:10.1021/ja507832e), two nearly flat triangles hinged on an edge, beside each other."""
    system, x, corners = openmm.System(), [], {}
    for to, (a, b), side in ((2, (0.4904, 0.6019), 1), (3, (0.7237, 0.5376), -1)):
        along = (a * a - b * b + 0.2719**2) / (2 * 0.2719)
        corners[to] = [along, side * math.sqrt(a * a - along * along), 0]
    flat = openmm.CustomTorsionForce("25*min(d,6.283185307-d)^2; d=abs(theta+3.136357)")
    beads = openmm.NonbondedForce()
    beads.setNonbondedMethod(beads.CutoffPeriodic), beads.setCutoffDistance(1.2)
    system.setDefaultPeriodicBoxVectors(*(4 * np.eye(3)))
    for n in range(count):
        o = len(x)
        x += [np.array(at) + [0, 0, 0.7 * n] for at in ([0, 0, 0], [0.2719, 0, 0], corners[2], corners[3])]
        for mass in (38.69, 159.65, 77.22, 39.44):
            system.addParticle(mass), beads.addParticle(0, 0.43, 2.6)
        for i, j, d in ((0, 2, 0.4904), (1, 2, 0.6019), (0, 3, 0.7237), (1, 3, 0.5376), (0, 1, 0.2719)):
            system.addConstraint(o + i, o + j, d), beads.addException(o + i, o + j, 0, 0.3, 0)
        beads.addException(o + 2, o + 3, 0, 0.3, 0)
        flat.addTorsion(o + 2, o, o + 1, o + 3, [])
    system.addForce(flat), system.addForce(beads)
    return system, np.array(x)


def chain_topology(atoms):
    topology = app.Topology()
    chain = topology.addChain()
    for n in range(atoms):
        topology.addAtom(f"B{n}", None, topology.addResidue("CHOL", chain)) if n % 4 == 0 else \
            topology.addAtom(f"B{n}", None, list(topology.residues())[-1])
    return topology


def context_of(system, integrator, on, x):
    properties = {"Precision": "mixed"} if on == "OpenCL" else {}
    context = openmm.Context(system, integrator, platform(on), properties)
    context.setPositions(x)
    return context


def test_bonds_leave_the_system():
    system, _ = cholesterols(1)
    bonds = taut.openmm.rigid_bonds(system)
    assert system.getNumConstraints() == 0
    assert bonds[0] == (0, 2, 0.4904) and len(bonds) == 5
    made = taut.openmm.Integrator(0.02, bonds=bonds)
    text = openmm.XmlSerializer.serialize(made)
    assert text.count("<Bond ") == 5
    for same in (openmm.XmlSerializer.deserialize(text), copy.copy(made), pickle.loads(pickle.dumps(made))):
        assert openmm.XmlSerializer.serialize(same) == text


@pytest.mark.parametrize("on", PLATFORMS)
def test_the_same_motion_as_with_constraints(on):
    """Before and after: the System's constraints, and the same bonds in the integrator."""
    ends = []
    for take in (False, True):
        system, x = cholesterols()
        bonds = taut.openmm.rigid_bonds(system) if take else []
        context = context_of(system, taut.openmm.Integrator(0.02, bonds=bonds), on, x)
        context.setVelocities(0.1 * np.random.default_rng(3).normal(size=x.shape))
        context.getIntegrator().step(50)
        ends.append(positions(context))
    assert abs(ends[0] - ends[1]).max() < (1e-8 if on == "Reference" else 1e-5)
    assert abs(ends[0] - x).max() > 0.01


def test_the_frame_of_martinis_cholesterol():
    """At 20 fs, where OpenMM's own constraints end in NaN (issue 3603)."""
    system, x = cholesterols(1)
    bonds = taut.openmm.rigid_bonds(copy.deepcopy(system))
    context = context_of(system, taut.openmm.Integrator(0.02), "Reference", x)
    context.setVelocitiesToTemperature(300, 2)
    before = total_energy(context)
    for _ in range(20):
        context.getIntegrator().step(50)
        assert bond_error(bonds, positions(context)) < 1e-6
        assert total_energy(context) == pytest.approx(before, abs=0.02 * before)


@pytest.mark.parametrize("on", PLATFORMS)
def test_openmms_own_calls_project_onto_the_bonds(on):
    system, x = cholesterols()
    bonds = taut.openmm.rigid_bonds(system)
    context = context_of(system, taut.openmm.Integrator(0.02, bonds=bonds), on,
                         x + 0.01 * np.random.default_rng(1).normal(size=x.shape))
    assert bond_error(bonds, positions(context)) > 1e-3
    context.applyConstraints(1e-5)
    x = positions(context)
    assert bond_error(bonds, x) < 1e-6
    context.setVelocitiesToTemperature(300, 5)
    v = velocities(context)
    assert max(abs((x[j] - x[i]) @ (v[j] - v[i])) for i, j, _ in bonds) < 1e-6


# pocl 3.1's minimizer crashes with any integrator; the CPU platform's has forces in single precision and threads in any
# order, and of 60 runs ended at 0.6 to 8 kJ/mol/nm.
@pytest.mark.parametrize("on, left", [("Reference", 2), ("CPU", 40)])
def test_minimizes(on, left):
    system, x = cholesterols()
    crowded = x * [1, 1, 0.6] + 0.01 * np.random.default_rng(4).normal(size=x.shape)
    bonds = taut.openmm.rigid_bonds(system)
    context = context_of(system, taut.openmm.Integrator(0.02, bonds=bonds), on, crowded)
    masses = np.array([system.getParticleMass(n)._value for n in range(len(x))])[:, None]

    def slope():
        """The rms force that bonds do not take [kJ/mol/nm]."""
        context.setVelocities(context.getState(forces=True).getForces(asNumpy=True)._value / masses)
        context.applyVelocityConstraints(1e-8)
        return math.sqrt((masses * velocities(context) ** 2 * masses).sum() / x.size)

    context.applyConstraints(1e-8)
    before = slope()
    openmm.LocalEnergyMinimizer.minimize(context, 1)
    assert before > 200 and slope() < left
    assert context.getState(energy=True).getPotentialEnergy()._value < -20
    assert bond_error(bonds, positions(context)) < 1e-6
    context.setVelocitiesToTemperature(300, 1)
    context.getIntegrator().step(2000)
    assert bond_error(bonds, positions(context)) < 1e-5


@pytest.mark.parametrize("on", PLATFORMS)
def test_reporters_have_the_temperature(on, tmp_path):
    system, x = cholesterols()
    system.addForce(openmm.CMMotionRemover())
    bonds = taut.openmm.rigid_bonds(system)
    integrator = taut.openmm.Integrator(0.02, bonds=bonds, temperature=300, friction=5, seed=2)
    properties = {"Precision": "mixed"} if on == "OpenCL" else {}
    run = app.Simulation(chain_topology(len(x)), system, integrator, platform(on), properties)
    run.context.setPositions(x)
    run.context.setVelocitiesToTemperature(300, 1)
    run.reporters.append(app.StateDataReporter(str(tmp_path / "log"), 20, step=True, temperature=True, kineticEnergy=True))
    run.step(4000)
    log = np.genfromtxt(tmp_path / "log", delimiter=",")
    freedoms = 3 * len(x) - len(bonds) - 3
    assert log[:, 2] == pytest.approx(2 * log[:, 1] / R / freedoms, rel=1e-9)
    assert log[20:, 2].mean() == pytest.approx(300, abs=4 * 300 * math.sqrt(2 / freedoms / 60))
    assert bond_error(bonds, positions(run.context)) < 1e-5


def test_barostats_move_molecules_whole():
    system, x = cholesterols()
    bonds = taut.openmm.rigid_bonds(system)
    system.addForce(openmm.MonteCarloBarostat(1, 300, 5))
    context = context_of(system, taut.openmm.Integrator(0.02, bonds=bonds, temperature=300, friction=5, seed=2), "CPU", x)
    context.setVelocitiesToTemperature(300, 1)
    boxes = {context.getState().getPeriodicBoxVolume()._value}
    for _ in range(20):
        context.getIntegrator().step(5)
        boxes.add(context.getState().getPeriodicBoxVolume()._value)
        assert bond_error(bonds, positions(context)) < 1e-5
    assert len(boxes) > 2


def test_a_flexible_system_keeps_its_springs():
    """Bonds of a System that has springs for them already: nothing has to be changed in it."""
    system = openmm.System()
    springs = openmm.HarmonicBondForce()
    for mass in (12, 12, 12):
        system.addParticle(mass)
    springs.addBond(0, 1, 0.15, 3e5), springs.addBond(1, 2, 0.15, 3e5)
    system.addForce(springs)
    context = context_of(system, taut.openmm.Integrator(0.002, bonds=[(0, 1, 1.5 * unit.angstrom), (1, 2, 0.15)]),
                         "Reference", [[0, 0, 0], [0.16, 0, 0], [0.16, 0.14, 0]])
    context.getIntegrator().step(10)
    assert bond_error([(0, 1, 0.15), (1, 2, 0.15)], positions(context)) < 1e-7


def test_refusals():
    def made_with(system, bonds):
        return refusal(openmm.Context, system, taut.openmm.Integrator(0.02, bonds=bonds), platform("Reference"))

    system = openmm.System()
    for mass in (1, 1, 0, 1):
        system.addParticle(mass)
    system.setVirtualSite(2, openmm.TwoParticleAverageSite(0, 1, 0.5, 0.5))
    system.addConstraint(0, 1, 0.1)
    assert "4 is not an atom of the System" in made_with(system, [(0, 4, 0.1)])
    assert "2 is a virtual site" in made_with(system, [(0, 2, 0.1)])
    assert "joins molecules that no force joins" in made_with(system, [(1, 3, 0.1)])
    for wrong in ((0, 1, 0.1), (1, 0, 0.1)):
        assert "two bonds on the same pair" in made_with(system, [wrong])
    assert "expected more than 0" in made_with(system, [(0, 3, -0.1)])
    linked = openmm.System()
    for mass in (1, 1, 1, 1, 0, 0):
        linked.addParticle(mass)
    for site in (4, 5):
        linked.setVirtualSite(site, openmm.TwoParticleAverageSite(2 * site - 8, 2 * site - 7, 0.5, 0.5))
    linked.addConstraint(4, 5, 0.3)  # which OpenMM's own integrators leave out
    assert "4 is a virtual site" in made_with(linked, [])
