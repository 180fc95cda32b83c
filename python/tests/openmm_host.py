"""What the tests of the plug-in for OpenMM share. They are skipped where OpenMM or the plug-in is not there."""

import numpy as np
import pytest

openmm = pytest.importorskip("openmm", reason="needs OpenMM from PyPI: pip install openmm")
import taut.openmm  # noqa: E402

try:
    taut.openmm.load()
except ImportError as missing:
    pytest.skip(str(missing), allow_module_level=True)


def platform(name):
    return openmm.Platform.getPlatformByName(name)


def positions(context):
    return context.getState(positions=True).getPositions(asNumpy=True)._value


def velocities(context):
    return context.getState(velocities=True).getVelocities(asNumpy=True)._value


def total_energy(context):
    state = context.getState(energy=True)
    return (state.getPotentialEnergy() + state.getKineticEnergy())._value


def constraints(system):
    """The rigid bonds of a System: two atoms and a length [nm] each."""
    of_each = map(system.getConstraintParameters, range(system.getNumConstraints()))
    return [(i, j, d._value) for i, j, d in of_each]


def bond_error(bonds, x):
    """The largest relative error of the bonds' lengths."""
    return max(abs(np.linalg.norm(x[j] - x[i]) / d - 1) for i, j, d in bonds)


def refusal(call, *args, **named):
    with pytest.raises(openmm.OpenMMException) as caught:
        call(*args, **named)
    return str(caught.value)
