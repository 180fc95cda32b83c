"""TautIntegrator on OpenMM's OpenCL platform beside its Reference platform, in all precisions."""

import math
import subprocess
import sys

import numpy as np
import pytest
from openmm_host import bond_error, constraints, openmm, platform, positions, refusal, velocities

import taut.openmm

if "OpenCL" not in taut.openmm.platforms() or not platform("OpenCL").getDevices():
    pytest.skip("needs an OpenCL device and the plug-in's part for it (pocl-opencl-icd, ocl-icd-opencl-dev)",
                allow_module_level=True)

PRECISIONS = ["single", "mixed", "double"]


class Mixture:
    """Molecules of several shapes, tied to their neighbours by springs: forces that OpenCL has to its precision."""

    def __init__(self):
        self.system, self.x = openmm.System(), []
        self.springs = openmm.HarmonicBondForce()
        rng = np.random.default_rng(1)
        for n in range(18):
            at = 0.6 * np.array([n % 3, n // 3 % 3, n // 9]) + rng.uniform(-0.05, 0.05, 3)
            [self.water, self.methyl, self.chain][n % 3](at, rng)
        self.springs.setForceGroup(1)
        self.system.addForce(self.springs)

    def atom(self, mass, at):
        self.x.append(at)
        return self.system.addParticle(mass)

    def bond(self, i, j):
        self.system.addConstraint(i, j, float(np.linalg.norm(np.subtract(self.x[j], self.x[i]))))

    def tie(self, i, stiffness=2000):
        if i > 12:
            far = float(np.linalg.norm(np.subtract(self.x[i], self.x[i - 12])))
            self.springs.addBond(i - 12, i, float(np.float32(0.9 * far)), stiffness)

    def water(self, at, rng):
        o, h, k = (self.atom(m, at + d) for m, d in ((15.999, [0, 0, 0]), (1.008, [0.0757, 0.0586, 0]),
                                                    (1.008, [-0.0757, 0.0586, 0])))
        for i, j in ((o, h), (o, k), (h, k)):
            self.bond(i, j)
        self.tie(o), self.tie(h)
        site = self.atom(0, at)
        self.system.setVirtualSite(site, openmm.ThreeParticleAverageSite(o, h, k, 0.75, 0.125, 0.125))
        self.tie(site)

    def methyl(self, at, rng):  # its angles rigid, too, and a free atom beside it
        c = self.atom(12.011, at)
        hs = [self.atom(1.008, at + 0.0629 * np.array(d)) for d in ([1, 1, 1], [1, -1, -1], [-1, 1, -1])]
        for h in hs:
            self.bond(c, h)
        for i, j in ((0, 1), (0, 2), (1, 2)):
            self.bond(hs[i], hs[j])
        free = self.atom(20, at - [0.1, 0.1, 0.1])
        self.springs.addBond(c, free, 0.15625, 1e4)
        self.tie(c), self.tie(hs[1])

    def chain(self, at, rng):
        before = None
        for n in range(6):
            i = self.atom(14.0 + n, at + [0.1 * n, 0.05 * (n % 2), 0.03 * (n % 3)])
            if before is not None:
                self.bond(before, i)
            before = i
            self.tie(i)

    def context(self, integrator, on, precision=None):
        made = openmm.Context(self.system, integrator, platform(on),
                              {"Precision": precision} if precision else {})
        made.setPositions(self.x)
        made.setVelocities(np.random.default_rng(2).normal(0, 0.4, (len(self.x), 3)))
        made.applyVelocityConstraints(1e-6)
        return made


class LargeClusters(Mixture):
    """Each held by a group of threads: a chain of 200 bonds, and two combs with rings."""

    def __init__(self):
        self.system, self.x = openmm.System(), []
        self.springs = openmm.HarmonicBondForce()
        self.walk([0, 0, 0], 201)
        for n in range(2):
            spine = self.walk([0, 0, 2 + n], 30)
            for k in range(0, 30, 2):
                tooth = self.atom(1.008 + n, self.x[spine[k]] + [0.02, 0.01, 0.1])
                self.bond(spine[k], tooth)
                if k % 6 == 4:
                    self.bond(tooth, spine[k + 1])  # a ring of three
        self.system.addForce(self.springs)

    def walk(self, at, atoms):  # along a helix: single precision has 1e-7 nm near the origin
        turns = [(math.cos(0.12 * k), math.sin(0.12 * k), 0.01 * k + 0.04 * (k % 3)) for k in range(atoms)]
        chain = [self.atom(14 + k % 5, np.add(at, turn)) for k, turn in enumerate(turns)]
        for i, j in zip(chain, chain[1:]):
            self.bond(i, j)
        for i, j in zip(chain, chain[3:]):
            far = np.linalg.norm(self.x[j] - self.x[i])
            self.springs.addBond(i, j, float(np.float32(0.9 * far)), 3000)
        return chain


@pytest.fixture(scope="module")
def large():
    return LargeClusters()


@pytest.fixture(scope="module")
def mixture():
    return Mixture()


# What a precision leaves of positions [nm] and velocities [nm/ps] after 20 steps of 2 fs.
NEAR = {"single": (2e-6, 2e-4), "mixed": (1e-7, 1e-5), "double": (1e-11, 1e-9)}


# A thermostat at 0 K has its friction, its jump in the tangent space, and no noise.
@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("settings", [{"method": "feedforward"}, {"method": "baumgarte"},
                                      {"method": "baumgarte", "gains": "box2d", "tolerance": 1e-10},
                                      {"method": "feedforward", "friction": 20, "temperature": 0},
                                      {"method": "baumgarte", "friction": 20, "temperature": 0}],
                         ids=lambda settings: "-".join(map(str, settings.values())))
def test_moves_as_reference_does(mixture, settings, precision):
    device = mixture.context(taut.openmm.Integrator(0.002, **settings), "OpenCL", precision)
    plain = mixture.context(taut.openmm.Integrator(0.002, **settings), "Reference")
    device.getIntegrator().step(20), plain.getIntegrator().step(20)
    x, x_plain = positions(device), positions(plain)
    assert np.abs(x_plain - mixture.x).max() > 0.01
    assert np.abs(x - x_plain).max() < NEAR[precision][0]
    assert np.abs(velocities(device) - velocities(plain)).max() < NEAR[precision][1]
    energies = [c.getState(energy=True).getKineticEnergy()._value for c in (device, plain)]
    assert energies[0] == pytest.approx(energies[1], rel=1e-4 if precision == "single" else 1e-5)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("settings", [{"method": "feedforward"}, {"method": "baumgarte"},
                                      {"method": "feedforward", "friction": 20, "temperature": 0}],
                         ids=lambda settings: "-".join(map(str, settings.values())))
def test_large_clusters_move_as_on_reference(large, settings, precision):
    test_moves_as_reference_does(large, settings, precision)
    free = large.context(taut.openmm.Integrator(0.002, **settings), "OpenCL", precision)
    free.getIntegrator().step(100)
    assert bond_error(constraints(large.system), positions(free)) < (1e-5 if precision == "single" else 1e-6)


def test_thermostat_gives_its_temperature(mixture):
    context = mixture.context(taut.openmm.Integrator(0.002, temperature=300, friction=10, seed=5), "OpenCL", "single")
    context.getIntegrator().step(200)
    energies = []
    for _ in range(300):
        context.getIntegrator().step(5)
        energies.append(context.getState(energy=True).getKineticEnergy()._value)
    masses = [mixture.system.getParticleMass(i)._value for i in range(mixture.system.getNumParticles())]
    freedoms = 3 * sum(m > 0 for m in masses) - mixture.system.getNumConstraints()
    assert np.mean(energies) == pytest.approx(0.5 * freedoms * 8.314462618e-3 * 300, rel=0.03)


@pytest.mark.parametrize("friction", [0, 5])
def test_goes_on_from_a_checkpoint(mixture, friction):
    bath = {"friction": friction, "temperature": 300, "seed": 3} if friction else {}
    run, again = (mixture.context(taut.openmm.Integrator(0.002, **bath), "OpenCL", "mixed") for _ in range(2))
    run.getIntegrator().step(15)
    kept = run.createCheckpoint()
    run.getIntegrator().step(15)
    again.loadCheckpoint(kept)
    again.getIntegrator().step(15)
    assert np.array_equal(positions(run), positions(again))
    again.loadCheckpoint(kept)
    again.setVelocities(velocities(again) * 0)
    again.getIntegrator().step(15)
    assert np.abs(positions(run) - positions(again)).max() > 1e-3


def test_refuses_a_damaged_state(mixture):
    context = mixture.context(taut.openmm.Integrator(0.002), "OpenCL", "mixed")
    context.getIntegrator().step(5)
    state = openmm.XmlSerializer.serialize(context.getState(positions=True, integratorParameters=True))
    begin = b"device\n".hex()
    assert begin + "03000000" in state
    damaged = openmm.XmlSerializer.deserialize(state.replace(begin + "03000000", begin + "ffff0000"))
    with pytest.raises(openmm.OpenMMException, match="it counts 65535 steps of multipliers, expected 1 to 3"):
        context.setState(damaged)


# In a process of its own: what a plug-in has registered stays.
WITHOUT_THE_PART = """
import openmm, taut.openmm
taut.openmm._parts = dict
taut.openmm.load()
system = openmm.System()
system.addParticle(16), system.addParticle(1), system.addConstraint(0, 1, 0.1)
context = openmm.Context(system, taut.openmm.Integrator(0.002))
context.setPositions([[0, 0, 0], [0.1, 0, 0]])
context.getIntegrator().step(2)
print(context.getPlatform().getName())
try:
    openmm.Context(system, taut.openmm.Integrator(0.002), openmm.Platform.getPlatformByName("OpenCL"))
except openmm.OpenMMException as refused:
    print(refused)
"""


def test_without_its_part_opencl_is_refused_and_never_taken():
    ran = subprocess.run([sys.executable, "-c", WITHOUT_THE_PART], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
    taken, refused = ran.stdout.strip().splitlines()
    assert taken == "CPU" and "does not support all required kernels" in refused


def test_takes_the_states_of_other_platforms(mixture):
    device = mixture.context(taut.openmm.Integrator(0.002), "OpenCL", "double")
    plain = mixture.context(taut.openmm.Integrator(0.002), "Reference")
    everything = {"positions": True, "velocities": True, "integratorParameters": True}
    device.getIntegrator().step(10)
    kept = device.getState(**everything)
    plain.setState(kept), device.getIntegrator().step(10), plain.getIntegrator().step(10)
    assert np.abs(positions(device) - positions(plain)).max() < 1e-6
    device.setState(plain.getState(**everything))
    device.getIntegrator().step(10), plain.getIntegrator().step(10)
    assert np.abs(positions(device) - positions(plain)).max() < 1e-6
    again = mixture.context(taut.openmm.Integrator(0.002), "OpenCL", "double")
    again.setState(kept), again.getIntegrator().step(10)
    device.setState(kept), device.getIntegrator().step(10)
    assert np.array_equal(positions(device), positions(again))


def box_of_waters():
    """216 waters whose neighbours in space are none in the System, with positions near the least energy."""
    system, x, edge = openmm.System(), [], 6 * 0.31
    pairs = openmm.NonbondedForce()
    pairs.setNonbondedMethod(pairs.CutoffPeriodic), pairs.setCutoffDistance(0.8)
    system.setDefaultPeriodicBoxVectors(*(edge * np.eye(3)))
    order = np.random.default_rng(4).permutation(216)
    for n in order:
        for mass, at, charge, depth in ((15.999, [0, 0, 0], -0.834, 0.636), (1.008, [0.0757, 0.0586, 0], 0.417, 0),
                                        (1.008, [-0.0757, 0.0586, 0], 0.417, 0)):
            system.addParticle(mass), pairs.addParticle(charge, 0.315, depth)
            x.append(0.31 * np.array([n % 6, n // 6 % 6, n // 36]) + at)
        o = len(x) - 3
        for i, j, d in ((o, o + 1, 0.09572), (o, o + 2, 0.09572), (o + 1, o + 2, 0.15139)):
            system.addConstraint(i, j, d), pairs.addException(i, j, 0, 0.1, 0)
    system.addForce(pairs)
    start = openmm.Context(system, taut.openmm.Integrator(0.001), platform("CPU"))
    start.setPositions(x)
    openmm.LocalEnergyMinimizer.minimize(start, 10, 20)  # pocl cannot: its processes crash in OpenMM's minimizer
    return system, positions(start)


def water_bond_error(context):
    x = positions(context)
    return max(abs(np.linalg.norm(x[1::3] - x[::3], axis=1) / 0.09572 - 1))


def test_waters_that_the_device_reorders():
    """OpenMM sorts equal molecules on the device every 250 steps. Each keeps its own multipliers, from which baumgarte
    extrapolates; it does not iterate, so that a wrong one would show as an error of the bonds."""
    system, x = box_of_waters()
    context = openmm.Context(system, taut.openmm.Integrator(0.001, "baumgarte"),
                             platform("OpenCL"), {"Precision": "mixed"})
    context.setPositions(x)
    context.setVelocitiesToTemperature(250, 1)
    context.getIntegrator().step(200)
    errors = []
    for _ in range(70):
        context.getIntegrator().step(1)
        errors.append(water_bond_error(context))
    assert max(errors[40:]) < 3 * max(errors[:40])


def test_barostat_and_removal_of_the_momentum():
    system, x = box_of_waters()
    system.addForce(openmm.MonteCarloBarostat(2000, 300, 5)), system.addForce(openmm.CMMotionRemover(2))
    context = openmm.Context(system, taut.openmm.Integrator(0.001, temperature=300, friction=0.1),
                             platform("OpenCL"), {"Precision": "mixed"})
    context.setPositions(x)
    context.setVelocitiesToTemperature(300, 1)
    volumes = set()
    for _ in range(10):
        context.getIntegrator().step(10)
        volumes.add(context.getState().getPeriodicBoxVolume()._value)
        assert water_bond_error(context) < 1e-5
    assert len(volumes) > 3
    masses = np.array([system.getParticleMass(i)._value for i in range(system.getNumParticles())])
    momentum = masses @ velocities(context)
    assert np.linalg.norm(momentum) < 0.05 * np.sqrt(3 * sum(masses) * 8.314e-3 * 300)


def test_says_what_it_does_not_hold(mixture):
    for settings, said in (({"method": "newton"}, 'take "feedforward" or "baumgarte", or the platform CPU'),
                           ({"method": "baumgarte", "sweeps": 4}, "take sweeps=0")):
        made = taut.openmm.Integrator(0.002, **settings)
        assert said in refusal(openmm.Context, mixture.system, made, platform("OpenCL"))


def test_projects_and_stops_in_words(mixture):
    context = mixture.context(taut.openmm.Integrator(0.002), "OpenCL", "double")
    context.setPositions(np.array(mixture.x) + np.random.default_rng(3).normal(0, 2e-3, (len(mixture.x), 3)))
    context.applyConstraints(1e-3)
    assert bond_error(constraints(mixture.system), positions(context)) < 1e-12
    context.setVelocities(np.random.default_rng(3).normal(0, 200, (len(mixture.x), 3)))
    with pytest.raises(openmm.OpenMMException, match="in the cluster of atom .* take a shorter step"):
        context.getIntegrator().step(50)
