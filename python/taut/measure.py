"""What ``taut measure`` measures, as functions on numpy arrays.

    >>> log = sim.log                                  # or columns of a log.csv
    >>> first = taut.measure.equilibration(log["potential_kj_mol"])
    >>> taut.measure.mean(log["temperature_k"][first:])
    Estimate(value=300.4, error=0.8)
    >>> taut.measure.viscosity(log.pressure_tensor, time_ps=log["time_ps"], volume_nm3=6.5, temperature_k=300).viscosity

Give ``time_ps`` where samples may be unevenly spaced, as those of a run that was resumed with another ``log_every``: means
then weigh time, and correlations and displacements take the longest evenly spaced part, whose numbers are ``used``.
Errors are standard errors; they are nan where there are too few samples to tell. What cannot be measured raises
InputError, which says why. The rules are those of the page docs/measure.md.
"""

from typing import Any, List, NamedTuple, Optional, Sequence

import numpy as np
import numpy.typing as npt

from . import _core
from .errors import InputError

__all__ = ["Chains", "Diffusion", "Estimate", "Viscosity", "ZeroStep", "at_zero_step", "chains", "diffusion",
           "equilibration", "mean", "size_correction", "viscosity"]

Reals = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int64]


class Estimate(NamedTuple):
    """A value and its standard error; the error is nan where there are too few samples."""

    value: float
    error: float

    def __str__(self) -> str:
        return f"{self.value:.4g} ± {self.error:.2g}"


class Viscosity(NamedTuple):
    """A shear viscosity [mPa s], and what it was read from: columns of values and errors."""

    viscosity: Estimate
    cut_ps: float  # the time at which the integral is read
    time_ps: Reals  # (lags,)
    correlation: Reals  # (lags, 2), over its value at 0
    integral: Reals  # (lags, 2) [mPa s]
    used: Integers  # the rows it is of


class Diffusion(NamedTuple):
    """A diffusion constant [nm²/ps], and the mean square displacement it is the slope of."""

    diffusion: Estimate
    exponent: float  # the displacement grows as t to this power: 1 where it is diffusion
    time_ps: Reals  # (lags,)
    squared_nm2: Reals  # (lags, 2): values and errors
    used: Integers  # the frames it is of


class ZeroStep(NamedTuple):
    """What means at several steps come to at none, by the line y = value + slope·h² through them."""

    value: Estimate
    slope: Estimate  # per fs²
    chi_square: float  # of the points about the line
    degrees_of_freedom: int  # points less two; 0: two points cannot tell whether they lie on a line
    chance: float  # that points on a line lie so far off it, or farther; below 0.01 leave the longest step out


class Chains(NamedTuple):
    """Size of chains [nm²], and the time in which ⟨R(0)·R(t)⟩/⟨R²⟩ falls to 1/e; None where it does not fall."""

    end_to_end_squared: Estimate
    gyration_squared: Estimate
    relaxation_ps: Optional[Estimate]
    time_ps: Reals  # (lags,)
    correlation: Reals  # (lags, 2): values and errors
    used: Integers  # the frames that the relaxation is of


def _estimate(pair: Sequence[float]) -> Estimate:
    return Estimate(pair[0], pair[1] if pair[1] > 0 else float("nan"))


def _numbers(name: str, given: Any, *shape: int) -> Reals:
    """The array, of so many axes, where -1 stands for any length."""
    array = np.ascontiguousarray(given, dtype=float)
    fits = array.ndim == len(shape) and all(want in (-1, got) for want, got in zip(shape, array.shape))
    if not fits:
        wanted = ", ".join("n" if want < 0 else str(want) for want in shape)
        raise InputError(f"{name}: expected an array of shape ({wanted}{',' if len(shape) == 1 else ''}), "
                         f"got {array.shape}")
    if not np.isfinite(array).all():
        raise InputError(f"{name}: expected finite numbers")
    return array


def _positive(**given: float) -> None:
    for name, value in given.items():
        if not value > 0:
            raise InputError(f"{name}: expected a number above 0, got {value}")


def _times(count: int, interval_ps: Optional[float], time_ps: Optional[npt.ArrayLike]) -> List[float]:
    if (interval_ps is None) == (time_ps is None):
        raise InputError("interval_ps, time_ps: expected one of them, the time between samples or that of each")
    if interval_ps is not None:
        _positive(interval_ps=interval_ps)
        return [interval_ps * n for n in range(count)]
    times = _numbers("time_ps", time_ps, count)
    early = np.flatnonzero(np.diff(times) <= 0)
    if early.size:
        raise InputError(f"time_ps: expected ascending times, but [{early[0] + 1}] is not later than [{early[0]}]")
    return [float(t) for t in times]


def mean(series: npt.ArrayLike, *, time_ps: Optional[npt.ArrayLike] = None) -> Estimate:
    """Returns the mean of a correlated series, and its error by the statistical inefficiency (Chodera et al. 2007,
    doi:10.1021/ct0502864)."""
    numbers = _numbers("series", series, -1)
    if numbers.size == 0:
        raise InputError("series: there are no numbers")
    return _estimate(_core.measure_mean(numbers.tolist(), _times(numbers.size, None if time_ps is not None else 1.0,
                                                                 time_ps)))


def at_zero_step(dt_fs: npt.ArrayLike, means: npt.ArrayLike, errors: npt.ArrayLike) -> ZeroStep:
    """Returns the means at several lengths of step extrapolated to none, in the step's square, each weighing as
    1/error². ``taut scan --vary run.dt_fs=2,4,5 --seeds 4`` prints the same of all that it measures."""
    steps, values, sigmas = (_numbers(name, given, -1) for name, given in
                             (("dt_fs", dt_fs), ("means", means), ("errors", errors)))
    if not steps.size == values.size == sigmas.size:
        raise InputError(f"dt_fs, means, errors: expected as many of each, got {steps.size}, {values.size}, {sigmas.size}")
    if not (steps > 0).all() or not (sigmas > 0).all() or len(set(steps.tolist())) < 2:
        raise InputError("dt_fs, errors: expected numbers above 0, and two lengths of step or more")
    found = _core.measure_zero_step(steps.tolist(), values.tolist(), sigmas.tolist())
    if found is None:
        raise InputError("dt_fs, means, errors: no line goes through them")
    value, slope, chi_square, free, chance = found
    return ZeroStep(Estimate(*value), Estimate(*slope), chi_square, free, chance)


def equilibration(series: npt.ArrayLike, *, time_ps: Optional[npt.ArrayLike] = None) -> int:
    """Returns the index from which on most independent samples remain (Chodera 2016, doi:10.1021/acs.jctc.5b00784)."""
    numbers = _numbers("series", series, -1)
    times = _times(numbers.size, None if time_ps is not None else 1.0, time_ps)
    return _core.measure_equilibration(numbers.tolist(), times)


def viscosity(pressure_tensor: npt.ArrayLike, *, volume_nm3: float, temperature_k: float,
              interval_ps: Optional[float] = None, time_ps: Optional[npt.ArrayLike] = None) -> Viscosity:
    """Returns the shear viscosity of a liquid at rest by Green and Kubo.

    - ``pressure_tensor``: rows as (n, 3, 3) or (n, 6), xx, yy, zz, xy, xz, yz [bar], as ``sim.log.pressure_tensor``
    - ``interval_ps`` or ``time_ps``: the time between two rows, or that of each
    """
    _positive(volume_nm3=volume_nm3, temperature_k=temperature_k)
    tensor = np.asarray(pressure_tensor, dtype=float)
    if tensor.ndim == 3:
        full = _numbers("pressure_tensor", tensor, -1, 3, 3)
        full = (full + full.transpose(0, 2, 1)) / 2
        tensor = full[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
    rows = _numbers("pressure_tensor", tensor, -1, 6)
    found = _core.measure_viscosity(rows, _times(len(rows), interval_ps, time_ps), volume_nm3, temperature_k)
    if found["flaw"]:
        raise InputError(f"no viscosity: {found['flaw']}")
    return Viscosity(_estimate(found["value"]), found["cut"], np.array(found["t"]), np.array(found["correlation"]),
                     np.array(found["integral"]), np.array(found["used"]))


def diffusion(positions: npt.ArrayLike, *, interval_ps: Optional[float] = None,
              time_ps: Optional[npt.ArrayLike] = None, masses: Optional[npt.ArrayLike] = None,
              molecules: Optional[npt.ArrayLike] = None) -> Diffusion:
    """Returns the diffusion constant of molecules' centres by the slope of their mean square displacement.

    - ``positions``: (frames, atoms, 3) [nm], not wrapped into the box
    - ``interval_ps`` or ``time_ps``: the time between two frames, or that of each
    - ``masses``: (atoms,); None: all alike
    - ``molecules``: (atoms,), the number of each atom's molecule from 0; None: each atom for itself
    """
    frames = _numbers("positions", positions, -1, -1, 3)
    times, count = _times(len(frames), interval_ps, time_ps), frames.shape[1]
    weights = np.ones(count) if masses is None else _numbers("masses", masses, count)
    of = np.arange(count) if molecules is None else np.asarray(molecules)
    if of.shape != (count,) or not np.issubdtype(of.dtype, np.integer) or count == 0 or of.min() < 0:
        raise InputError(f"molecules: expected {count} whole numbers of 0 or more, one for each atom")
    found = _core.measure_displacement(frames, times, weights.tolist(), of.tolist())
    if not found["t"]:
        raise InputError(f"positions: {len(found['used'])} evenly spaced frames are too few, it takes 40")
    return Diffusion(_estimate(found["diffusion"]), found["exponent"], np.array(found["t"]),
                     np.array(found["squared"]), np.array(found["used"]))


def size_correction(*, temperature_k: float, viscosity_mpa_s: float, edge_nm: float) -> float:
    """Returns what diffusion in a cubic periodic box lacks to that in an endless liquid [nm²/ps] (Yeh and Hummer 2004,
    doi:10.1021/jp0477147)."""
    _positive(temperature_k=temperature_k, viscosity_mpa_s=viscosity_mpa_s, edge_nm=edge_nm)
    return _core.measure_size_correction(temperature_k, viscosity_mpa_s, edge_nm)


def chains(positions: npt.ArrayLike, atoms: Sequence[Sequence[int]], *, interval_ps: Optional[float] = None,
           time_ps: Optional[npt.ArrayLike] = None) -> Chains:
    """Returns ⟨R²⟩, ⟨R_g²⟩ and the relaxation of unbranched chains.

    - ``positions``: (frames, atoms, 3) [nm], not wrapped into the box
    - ``atoms``: the atoms of each chain, from one end to the other; ``np.arange(n).reshape(-1, 20)`` for chains of 20
    - ``interval_ps`` or ``time_ps``: the time between two frames, or that of each
    """
    frames = _numbers("positions", positions, -1, -1, 3)
    times = _times(len(frames), interval_ps, time_ps)
    lists: List[List[int]] = [[int(a) for a in chain] for chain in atoms]
    if not lists or len(frames) == 0:
        raise InputError("atoms and positions: expected at least one chain and one frame")
    for chain in lists:
        if len(chain) < 2 or min(chain) < 0 or max(chain) >= frames.shape[1]:
            raise InputError(f"atoms: expected chains of two atoms or more, from 0 to {frames.shape[1] - 1}, got {chain}")
    found = _core.measure_chains(frames, times, lists)
    relaxation = None if found["flaw"] else _estimate(found["relaxation"])
    return Chains(_estimate(found["end_to_end_squared"]), _estimate(found["gyration_squared"]), relaxation,
                  np.array(found["t"]), np.array(found["correlation"]), np.array(found["used"]))
