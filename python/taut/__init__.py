"""Molecular dynamics of rigid bonds, and every serious way of holding them.

    >>> import taut
    >>> sim = taut.Simulation("water", method="feedforward", dt_fs=2)
    >>> sim.run(1000, every=100, callback=print)
    >>> sim.positions, sim.velocities      # numpy, (n, 3), live
    >>> sim.log["temperature_k"], sim.summary

taut.scenes(), taut.methods()      what there is: name to what it is
taut.Simulation                    a scene, a dict, or OpenMM's objects made to run
taut.Baumgarte, taut.Rattle, ...   a method's options
taut.ConstraintMethod, taut.Force  methods and forces of your own
taut.verify                        whether a method does what every method must
taut.chart, taut.stability         methods' speed against accuracy, and where they fail
taut.calibrate, taut.crosscheck    Baumgarte's gains; whether OpenMM agrees

help(taut.Simulation), help(taut.Baumgarte), ... say more.

Units: nm, ps, u, kJ/mol, K; steps in fs. Errors: InputError (a ValueError), SimulationFailure, OutsideError.
"""

import numpy

from . import _core

if int(numpy.__version__.split(".")[0]) >= 2 and not _core.knows_numpy_2:
    raise ImportError("taut was built with a pybind11 that does not know numpy 2: build it where this numpy is, "
                      "pip install .")

from . import options
from ._core import Row, scenes, threads, use_threads
from .errors import InputError, OutsideError, SimulationFailure
from .options import *  # noqa: F401,F403
from .parts import ConstraintMethod, Force, NotConverged, Push, State, System, register
from .simulation import Simulation
from .studies import calibrate, chart, crosscheck, stability
from .verifying import verify

__version__ = "0.1"
__all__ = ["ConstraintMethod", "Force", "InputError", "NotConverged", "OutsideError", "Push", "Row",
           "Simulation", "SimulationFailure", "State", "System", "calibrate", "chart", "crosscheck", "register", "scenes",
           "stability", "threads", "use_threads", "verify"]
__all__ += options.__all__

for _name in __all__:  # all is of taut, wherever it is written: so help has it
    globals()[_name].__module__ = __name__
