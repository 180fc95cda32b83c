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
    """

    step: Optional[int] = None  #: the step that failed
    time_ps: Optional[float] = None  #: [ps]
    cause: Optional[str] = None  #: the method's or the force's words
    advice: Optional[str] = None  #: what to try
    bond: Optional[int] = None  #: index of the bond to blame; None if there is none
    atoms: Optional[Tuple[int, int]] = None  #: its atoms
    length_nm: Optional[float] = None  #: its length after that step [nm]
    length_before_nm: Optional[float] = None  #: and before [nm]
    target_nm: Optional[float] = None  #: what it is held at [nm]
    largest_force_kj_mol_nm: Optional[float] = None  #: [kJ/mol/nm]
    atom: Optional[int] = None  #: the atom it acts on
    positions: Optional[np.ndarray] = None  #: the last good state, (n, 3) [nm]
    velocities: Optional[np.ndarray] = None  #: (n, 3) [nm/ps]
