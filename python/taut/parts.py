"""Parts of a simulation written in Python: constraint methods and forces."""

from __future__ import annotations

import inspect
from dataclasses import dataclass
from functools import cached_property
from itertools import count
from typing import TYPE_CHECKING, Any, Dict, List, Optional, Sequence, Set, Union

import numpy as np

from . import _core
from .errors import InputError


@dataclass(frozen=True)
class System:
    """What does not change during a run. Its arrays cannot be written to, and may be kept.

    masses          (n,) [u]; 0 for an anchored atom
    inverse_masses  (n,) [1/u]; 0 for an anchored atom
    bonds           (m, 2) the two atoms of each rigid bond
    lengths         (m,) what each is held at [nm]
    """

    masses: np.ndarray
    inverse_masses: np.ndarray
    bonds: np.ndarray
    lengths: np.ndarray

    @cached_property
    def groups(self) -> List[np.ndarray]:
        """All bonds, in groups of which no two share an atom: numpy can change those of one group at once."""
        taken: Dict[int, Set[int]] = {}  # by the bonds of an atom
        of_bond = []
        for i, j in self.bonds.tolist():
            of = taken.setdefault(i, set()), taken.setdefault(j, set())
            of_bond.append(next(group for group in count() if group not in of[0] | of[1]))
            for groups in of:
                groups.add(of_bond[-1])
        return [np.flatnonzero(np.array(of_bond) == group) for group in range(max(of_bond, default=-1) + 1)]


class State:
    """What a stage may change, in place or by giving it other arrays of the same shape.

    positions   (n, 3) [nm], never wrapped
    velocities  (n, 3) [nm/ps]
    forces      (n, 3) [kJ/mol/nm]
    time_ps     [ps], to be read alone

    The arrays are the engine's own numbers, and there for the length of a stage alone. A stage that keeps one, or a
    view of one (``self.before = state.positions[3:]``), fails with a BufferError: keep a copy.
    """

    positions: np.ndarray
    velocities: np.ndarray
    forces: np.ndarray
    time_ps: float

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            raise AttributeError(f"state.{name}: a state has positions, velocities and forces, during a stage alone")


@dataclass(frozen=True)
class Push:
    """How the forces move the atoms to where forces act next.

    The velocities come to v + kick/m (f + noise), and the positions to x + h times that. Between two steps v is the
    half-step velocity. At the start it is the full-step velocity, and the forces act for half a step.

    h      length of the step to come [ps]
    kick   how long the forces act: h, and h/2 at the start [ps]
    noise  the random force of a Langevin thermostat, which is no part of ``state.forces``: (n, 3) [kJ/mol/nm], or None
    """

    h: float
    kick: float
    noise: Optional[np.ndarray] = None

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
    """What a stage returns that gave up: the step fails, and `bond` is to blame."""

    iterations: int = 0
    bond: int = -1


#: What a stage returns: nothing, how many iterations it took, or that it gave up.
Answer = Union[None, int, NotConverged]


class ConstraintMethod:
    """An algorithm that holds bonds. Derive from it and write the stages it acts in; all are empty here.

    A step of length h [ps] of velocity Verlet is::

        v += h/2 · f/m;  x += h v
        project_positions          # SHAKE, RATTLE: x − h v are the positions before
        f = F(x)
        add_forces                 # Baumgarte: f += Jᵀλ; v is the half-step velocity
        v += h/2 · f/m
        project_velocities         # RATTLE: v is the full-step velocity

    Its options are the arguments of its class, each with a default that is a number, a truth value or a text, and
    kept under its own name, as by ``@dataclass``. Each simulation makes an instance of its own. An exception in a
    stage, KeyboardInterrupt too, takes the step back, with the attributes that are ``kept``: the simulation is as it
    was before, and can go on.

    promised_error  the relative bond error it answers for: a run says if it was worse
    holds           "all": lengths and velocities; "positions": velocities keep a part along the bonds (SHAKE's do)
    kept            names of the attributes, arrays or floats, that it takes from one step to the next: checkpoints
                    keep them. They are there, in their shape, from prepare() on
    """

    promised_error: float = float("inf")
    holds: str = "all"
    kept: Sequence[str] = ()

    def prepare(self, system: System, h: float) -> None:
        """Before the first step of length h [ps]."""

    def project_positions(self, system: System, h: float, state: State) -> Answer:
        """May move the positions, and change the velocities by the same over h."""

    def add_forces(self, system: System, push: Push, state: State) -> Answer:
        """May add what holds the bonds to the forces. Called once before the first step, too (``push.starts``)."""

    def project_velocities(self, system: System, h: float, state: State) -> Answer:
        """May take what lies along the bonds out of the velocities."""

    def setting(self) -> str:
        """The options in one line, for reports."""
        return ", ".join(f"{key} = {getattr(self, key)}" for key in options_of(type(self)))


class Force:
    """A force written in Python: a bias, a wall. Derive from it and write `add`.

    It counts as a field from outside: it has no part in the pressure, and momentum is not conserved.
    """

    def add(self, positions: np.ndarray, forces: np.ndarray) -> float:
        """Adds to `forces`, which come as zeros, (n, 3) [kJ/mol/nm], at `positions`, (n, 3) [nm], never wrapped.

        Returns the energy [kJ/mol]. Called once a step, more often under a Monte Carlo barostat, in a minimisation and
        where positions were written to. Both arrays are the engine's own, as those of a State; positions cannot be
        written to. Who keeps one keeps a copy. What it throws, KeyboardInterrupt too, takes the step back: the
        simulation is as it was before, and can go on.
        """
        raise NotImplementedError(f"{type(self).__name__}.add is not written")


def options_of(method: type) -> Dict[str, Any]:
    """The options of a method written in Python, with their defaults."""
    options = {}
    for name, parameter in list(inspect.signature(method).parameters.items()):
        if parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
            continue
        if not isinstance(parameter.default, (bool, int, float, str)):
            raise InputError(f"{method.__name__}: its argument {name} is an option, and needs a default that is a "
                             "number, a truth value or a text")
        options[name] = parameter.default
    return options


REGISTERED: Dict[str, type] = {}  #: methods written in Python, by name


def register(method: type) -> str:
    """Puts a class derived from ConstraintMethod on the list of methods; returns its name."""
    summary = (inspect.getdoc(method) or "").split("\n")[0]
    _core.add_method(method, method.__name__, summary, options_of(method))
    REGISTERED[method.__name__] = method
    return method.__name__


def is_method(thing: Any) -> bool:
    """Whether it is a class derived from ConstraintMethod, or an instance of one."""
    return isinstance(thing, ConstraintMethod) or (isinstance(thing, type) and issubclass(thing, ConstraintMethod))


def settings_of(method: Union[type, ConstraintMethod]) -> Dict[str, Any]:
    """The keys of a scene that choose it."""
    kind = method if isinstance(method, type) else type(method)
    settings: Dict[str, Any] = {"method.name": register(kind)}
    if not isinstance(method, type):
        for key in options_of(kind):
            if not hasattr(method, key):
                raise InputError(f"{kind.__name__}: its option {key} is not kept under that name: self.{key} = {key}")
            settings[f"method.{key}"] = getattr(method, key)
    return settings


def named(method: Any) -> str:
    """The name that a method goes by in a study: a name, or a class derived from ConstraintMethod."""
    if isinstance(method, str):
        return method
    if isinstance(method, type) and issubclass(method, ConstraintMethod):
        return register(method)
    raise InputError(f"methods: expected names, or classes derived from taut.ConstraintMethod, got {method!r}")
