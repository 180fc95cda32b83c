"""Molecular dynamics with rigid bonds, and the constraint methods that hold them.

    >>> import taut
    >>> sim = taut.Simulation("water", method="feedforward", dt_fs=2)
    >>> sim.run(1000, every=100, callback=print)
    >>> sim.positions, sim.velocities      # numpy, (n, 3), live
    >>> sim.log["temperature_k"], sim.summary

taut.scenes(), taut.methods()      list the systems and the methods that come with taut
taut.Simulation                    runs a scene, a dict or OpenMM's objects
taut.Baumgarte, taut.Rattle, ...   hold the options of a method
taut.DCD, taut.CSV, taut.Call      write and call while a simulation runs
taut.Calculator                    gives its forces to ASE
taut.Distance, Angle, Torsion ...  are restraints, walls and pulls of groups of atoms
taut.ConstraintMethod, taut.Force  are the bases of methods and forces of your own
taut.verify                        checks that a method keeps lengths, momentum and direction
taut.chart, taut.stability         compare methods' speed and accuracy, and find where they fail
taut.read                          reads topologies of GROMACS and Amber by OpenMM's readers
taut.measure                       means with errors, viscosity, diffusion and chains from arrays
taut.pictures                      draws tables for print, and writes figures as PDF, SVG and PNG
taut.calibrate, taut.crosscheck    find Baumgarte's alpha and beta; compare a run with OpenMM

help(taut.Simulation), help(taut.Baumgarte), ... describe them.

Units: nm, ps, u, kJ/mol, K; steps in fs. Errors: InputError (a ValueError), SimulationFailure, OutsideError.
"""

import pathlib as _pathlib
import sysconfig as _sysconfig
import typing as _typing

import numpy

_BUILD_AGAIN = "in taut's folder, `pip install .` builds it for this environment"
try:
    from . import _core
except ImportError:
    _others = [file.name.split(".")[1] for file in _pathlib.Path(__file__).parent.glob("_core.*.so")]
    if not _others or str(_sysconfig.get_config_var("SOABI")) in _others:
        raise
    raise ImportError(f"this taut was built for {_others[0]}, and this Python is "
                      f"{_sysconfig.get_config_var('SOABI')}: {_BUILD_AGAIN}") from None
if int(numpy.__version__.split(".")[0]) >= 2 and not _core.knows_numpy_2:
    raise ImportError(f"this taut was built for numpy 1 (by pybind11 before 2.12), and numpy here is "
                      f"{numpy.__version__}: {_BUILD_AGAIN}; or take numpy<2")

from . import measure, options, pictures
from ._core import Row, scenes, threads, use_threads
from .ase_calculator import Calculator
from .biases import Angle, Bias, Distance, Gyration, Torsion
from .errors import InputError, OutsideError, SimulationFailure
from .errors import suggest as _suggest
from .options import *  # noqa: F401,F403
from .parts import ConstraintMethod, Force, NotConverged, Push, State, System, register
from .reading import read
from .reporters import CSV, DCD, H5MD, XTC, Call, Reporter
from .simulation import Minimisation, Simulation
from .studies import calibrate, chart, crosscheck, stability
from .verifying import verify

__version__ = "0.2"
__all__ = ["Angle", "Bias", "CSV", "Calculator", "Call", "ConstraintMethod", "DCD", "Distance", "Force", "Gyration", "H5MD",
           "InputError", "Minimisation", "NotConverged", "Torsion",
           "OutsideError", "Push", "Reporter", "Row", "Simulation", "SimulationFailure", "State", "System",
           "calibrate", "chart", "crosscheck", "read", "register", "scenes", "stability", "threads",
           "use_threads", "verify", "XTC"]
__all__ += options.__all__

for _name in __all__:  # help() and pickle then name them taut.X, not by the file that they stand in
    globals()[_name].__module__ = __name__

if not _typing.TYPE_CHECKING:

    def __getattr__(name):
        nearest = "" if name.startswith("_") else _suggest(name, __all__)
        raise AttributeError(f"module 'taut' has no attribute {name}{nearest}")
