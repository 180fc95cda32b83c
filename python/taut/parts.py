"""The bases of constraint methods and forces that are written in Python."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Set, Union

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InputError, suggest


@dataclass(frozen=True)
class System:
    """Holds what does not change during a run. Its arrays cannot be written to; you may keep them.

    - ``masses``: (n,) [u]; 0 for an anchored atom
    - ``inverse_masses``: (n,) [1/u]; 0 for an anchored atom
    - ``bonds``: the two atoms of each rigid bond, (m, 2)
    - ``lengths``: the length that each rigid bond is held at, (m,) [nm]
    """

    masses: npt.NDArray[Any]
    inverse_masses: npt.NDArray[Any]
    bonds: npt.NDArray[Any]
    lengths: npt.NDArray[Any]

    @cached_property
    def groups(self) -> List[npt.NDArray[Any]]:
        """Indices of all bonds in groups. No two bonds of a group share an atom, so numpy can move them at once."""
        taken: Dict[int, Set[int]] = {}  # by the bonds of an atom
        of_bond = []
        for i, j in self.bonds.tolist():
            of = taken.setdefault(i, set()), taken.setdefault(j, set())
            of_bond.append(next(group for group in count() if group not in of[0] | of[1]))
            for groups in of:
                groups.add(of_bond[-1])
        return [np.flatnonzero(np.array(of_bond) == group) for group in range(max(of_bond, default=-1) + 1)]


class State:
    """Holds what a stage may change, in place or by assigning other arrays of the same shape.

    - ``positions``: (n, 3) [nm], unwrapped
    - ``velocities``: (n, 3) [nm/ps]
    - ``forces``: (n, 3) [kJ/mol/nm]
    - ``time_ps``: the time at the end of the step, in every stage [ps]; a change has no effect

    The arrays are the engine's own memory, which a stage may use only until it returns. A stage that keeps an array or
    a view of one (``self.before = state.positions[3:]``) fails with a BufferError; keep a copy.
    """

    positions: npt.NDArray[Any]
    velocities: npt.NDArray[Any]
    forces: npt.NDArray[Any]
    time_ps: float

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            raise AttributeError(f"state.{name}: a state has positions, velocities and forces, during a stage alone")


@dataclass(frozen=True)
class Push:
    """Says how the forces move the atoms to the positions of the next forces.

    The velocities become v + kick/m (f + noise), and the positions x + h times that. Between two steps v is the
    half-step velocity. At the start it is the full-step velocity, and the forces act for half a step.

    - ``h``: length of the next step [ps]
    - ``kick``: how long the forces act: h, and h/2 at the start [ps]
    - ``noise``: the random force of a Langevin thermostat, (n, 3) [kJ/mol/nm], or None; ``state.forces`` does not
      include it
    """

    h: float
    kick: float
    noise: Optional[npt.NDArray[Any]] = None

    @property
    def starts(self) -> bool:
        """True before the first step."""
        return self.kick < self.h

    @property
    def last_h(self) -> float:
        """Length of the step that ended here: h, and 0 at the start [ps]."""
        return 2 * self.kick - self.h


@dataclass
class NotConverged:
    """A stage returns this if it gave up. The step then fails, and the message names `bond` (-1: none)."""

    iterations: int = 0
    bond: int = -1


#: What a stage returns: None, its number of iterations, or NotConverged.
Answer = Union[None, int, NotConverged]


class ConstraintMethod:
    """Base of a constraint method. Derive from it and write the stages it acts in; those of the base do nothing.

    A step of length h [ps] of velocity Verlet is::

        v += h/2 · f/m;  x += h v
        project_positions          # SHAKE, RATTLE: x − h v are the positions before
        f = F(x)
        add_forces                 # Baumgarte: f += Jᵀλ; v is the half-step velocity
        v += h/2 · f/m
        project_velocities         # RATTLE: v is the full-step velocity

    The arguments of the class are the method's options. Each needs a default that is a number, True, False or a text,
    and is kept under its own name, as ``@dataclass`` does. Each simulation makes an instance of its own. After an
    exception in a stage, also KeyboardInterrupt, taut takes the step back, with the attributes that ``kept`` names,
    and the simulation can continue.

    - ``promised_error``: the relative bond error that the method answers for; a run says if it was larger
    - ``holds``: "all" if the method holds lengths and velocities; "positions" if velocities may have a part along the
      bonds, as SHAKE's do
    - ``kept``: names of attributes, arrays or floats, that it takes from one step to the next; checkpoints keep them.
      ``prepare`` must set them, in their final shape

    A class with a method whose name is nearly that of a stage (``project_position``) is refused with a TypeError.
    """

    promised_error: float = float("inf")
    holds: str = "all"
    kept: Sequence[str] = ()

    def __init_subclass__(cls, **named: Any) -> None:
        super().__init_subclass__(**named)
        known = ("prepare", "project_positions", "add_forces", "project_velocities", "setting", "promised_error",
                 "holds", "kept")
        for name in vars(cls):
            nearest = suggest(name, [meant for meant in known if meant not in vars(cls)], 0.85)
            if nearest and name not in known and not name.startswith("_"):
                raise TypeError(f"{cls.__name__}.{name}: a constraint method has no {name}{nearest}")

    def prepare(self, system: System, h: float) -> None:
        """Called before the first step. Steps have the length h [ps]."""

    def project_positions(self, system: System, h: float, state: State) -> Answer:
        """May move the positions, and change the velocities by the moves over h."""

    def add_forces(self, system: System, push: Push, state: State) -> Answer:
        """May add forces that hold the bonds. Called once before the first step, too (``push.starts``)."""

    def project_velocities(self, system: System, h: float, state: State) -> Answer:
        """May remove the part of the velocities that lies along the bonds."""

    def setting(self) -> str:
        """Returns the options in one line, for reports."""
        return ", ".join(f"{key} = {getattr(self, key)}" for key in options_of(type(self)))


class Force:
    """Base of a force written in Python, such as a bias or a wall. Derive from it and write ``add``.

    It is an external force: the pressure does not include it, and the momentum is not conserved.
    """

    def add(self, positions: npt.NDArray[Any], forces: npt.NDArray[Any]) -> float:
        """Adds this force to `forces`, (n, 3) [kJ/mol/nm], zero at the call, and returns its energy [kJ/mol].

        `positions`, (n, 3) [nm], are unwrapped and cannot be written to. Both arrays are the engine's own memory;
        keep copies. taut calls this once a step, and more often under a Monte Carlo barostat, in a minimisation, and
        after positions were written to. After an exception, also KeyboardInterrupt, taut takes the step back, and
        the simulation can continue.
        """
        raise NotImplementedError(f"{type(self).__name__}.add is not written")


def options_of(method: type) -> Dict[str, Any]:
    """Returns the options of a method written in Python, with their defaults. Raises InputError without a default."""
    options = {}
    for name, parameter in list(inspect.signature(method).parameters.items()):
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        if not isinstance(parameter.default, (bool, int, float, str)):
            raise InputError(f"{method.__name__}: its argument {name} is an option, and needs a default that is a "
                             "number, True, False or a text")
        options[name] = parameter.default
    return options


REGISTERED: Dict[str, type] = {}  #: methods written in Python, by name


def register(method: type) -> str:
    """Adds a class derived from ConstraintMethod to the list of methods, and returns its name."""
    summary = (inspect.getdoc(method) or "").split("\n")[0]
    _core.add_method(method, method.__name__, summary, options_of(method))
    REGISTERED[method.__name__] = method
    return method.__name__


def is_method(thing: Any) -> bool:
    """True for a class derived from ConstraintMethod, and for an instance of one."""
    return isinstance(thing, ConstraintMethod) or (isinstance(thing, type) and issubclass(thing, ConstraintMethod))


def settings_of(method: Union[type, ConstraintMethod]) -> Dict[str, Any]:
    """Returns the settings that choose a method written in Python."""
    kind = method if isinstance(method, type) else type(method)
    settings: Dict[str, Any] = {"method.name": register(kind)}
    if not isinstance(method, type):
        for key in options_of(kind):
            if not hasattr(method, key):
                raise InputError(f"{kind.__name__}: its option {key} is not kept under that name: self.{key} = {key}")
            settings[f"method.{key}"] = getattr(method, key)
    return settings


def named(method: Any) -> str:
    """Returns a method's name in a study, from a name or from a class derived from ConstraintMethod."""
    if isinstance(method, str):
        return method
    if isinstance(method, type) and issubclass(method, ConstraintMethod):
        return register(method)
    raise InputError(f"methods: expected names, or classes derived from taut.ConstraintMethod, got {method!r}")
