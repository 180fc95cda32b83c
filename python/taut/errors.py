"""taut's exceptions. Their messages are those of the command ``taut``."""

from __future__ import annotations

import difflib
from typing import Any, Iterable, Optional, Tuple

import numpy as np
import numpy.typing as npt


class InputError(ValueError):
    """The input is wrong. The message says in one line which key or argument, what was expected, and what to do."""


class OutsideError(OSError):
    """A folder cannot be written, the disk is full, or a file is gone."""


class SimulationFailure(RuntimeError):
    """The simulation failed: a method did not converge, a bond broke, or numbers became infinite.

    The simulation is then in the state of one step before, and can be looked at. These attributes describe a failed
    step; they are None if the start failed:

    - ``step``, ``time_ps``: the step that failed, its time [ps]
    - ``cause``, ``advice``: why it failed, and what to try
    - ``bond``, ``atoms``: index of the bond to blame and its two atoms; None if no bond is
    - ``length_before_nm``, ``length_nm``: the bond's length before and after that step [nm]
    - ``target_nm``: the length that the bond is held at [nm]
    - ``largest_force_kj_mol_nm``, ``atom``: the largest force [kJ/mol/nm], and the atom that it acts on
    - ``positions``, ``velocities``: the last good state, (n, 3) [nm], [nm/ps]
    """

    step: Optional[int] = None
    time_ps: Optional[float] = None
    cause: Optional[str] = None
    advice: Optional[str] = None
    bond: Optional[int] = None
    atoms: Optional[Tuple[int, int]] = None
    length_nm: Optional[float] = None
    length_before_nm: Optional[float] = None
    target_nm: Optional[float] = None
    largest_force_kj_mol_nm: Optional[float] = None
    atom: Optional[int] = None
    positions: Optional[npt.NDArray[Any]] = None
    velocities: Optional[npt.NDArray[Any]] = None


def suggest(name: str, known: Iterable[str], likeness: float = 0.75) -> str:
    """Returns "; did you mean X?" for the known name that is nearest to a wrong one, or "" if none is near."""
    nearest = difflib.get_close_matches(name, list(known), 1, likeness)
    return f"; did you mean {nearest[0]}?" if nearest else ""
