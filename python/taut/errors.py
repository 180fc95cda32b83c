"""What goes wrong, as exceptions. Their words are those of the command ``taut``."""

from __future__ import annotations

from typing import Optional, Tuple

import numpy as np


class InputError(ValueError):
    """The input is wrong: one line that says which key or argument, what was expected, and what to do."""


class OutsideError(OSError):
    """Something outside: a folder that cannot be written, a full disk, a file that is gone."""


class SimulationFailure(RuntimeError):
    """The simulation failed: no convergence, a bond broke, numbers ran away.

    The simulation is then as it was one step before, and can be looked at. Where a step is to blame, and not the
    start, the exception knows more; otherwise these are None.

    step, time_ps            the step that failed, its time [ps]
    cause, advice            the method's or the force's words; what to try
    bond, atoms              index of the bond to blame and its atoms; None if there is none
    length_nm                its length after that step [nm]
    length_before_nm         and before [nm]
    target_nm                what it is held at [nm]
    largest_force_kj_mol_nm  [kJ/mol/nm]
    atom                     the atom it acts on
    positions, velocities    the last good state, (n, 3) [nm], [nm/ps]
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
    positions: Optional[np.ndarray] = None
    velocities: Optional[np.ndarray] = None
