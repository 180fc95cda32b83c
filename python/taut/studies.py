"""Studies of constraint methods: their speed, accuracy and limits, and whether OpenMM agrees.

Each study takes methods as words, "rattle" or "rattle:sweeps=4", as classes or as objects, and ``seeds``: their number,
or a list of them. It then runs once for each, and returns means over them with standard errors, ``NAME_error`` beside
``NAME``.

Each study returns a dict of tables. A table is a pandas.DataFrame, or without pandas a dict of columns, numpy arrays
of one length. With ``draw=True``, or ``draw=85`` or ``170``, a study draws its pictures with matplotlib, so many mm wide; the
dict has them as "figures", by the names of their tables. ``taut.pictures.save`` writes one for print.
"""

from __future__ import annotations

import contextlib
import json
import shutil
import tempfile
import warnings
from pathlib import Path
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Optional, Union

import numpy as np

from . import _core, inputs, parts, pictures
from .errors import InputError, SimulationFailure
from .options import CLASSES, Options
from .over_seeds import Columns, Seeds, mean_and_error, over_seeds, settings_of_seeds
from .progress import StudyProgress

PANELS = ("work", "drift", "order", "length", "precision")
Table = Any  #: a dict of columns, or a pandas.DataFrame
Draw = Union[bool, int]  #: whether to draw; 85 or 170, so many mm wide


def table(columns: Mapping[str, Any]) -> Table:
    """Returns columns as a DataFrame, or without pandas as a dict of arrays."""
    try:
        import pandas
    except ImportError:
        return dict(columns)
    return pandas.DataFrame(dict(columns))


def _word(settings: Mapping[str, Any]) -> str:
    """Returns a method with its settings in a word: "rattle:sweeps=4"."""
    options = [f"{key[len('method.'):]}={value if isinstance(value, str) else inputs.toml(value, key)}"
               for key, value in settings.items() if key != "method.name" and value is not None]
    return ":".join([settings["method.name"]] + [",".join(options)] * bool(options))


def _name(method: Any) -> str:
    """Returns a method in a word, as the command takes it, with the options of an object: "shake:tolerance=1e-06"."""
    if isinstance(method, type) and issubclass(method, Options):
        return str(method.method)
    if isinstance(method, Options):
        return _word(method.settings())
    if isinstance(method, parts.ConstraintMethod):
        return _word(parts.settings_of(method))
    return parts.named(method)


def _names(methods: Optional[Iterable[Any]], usual: List[str]) -> List[str]:
    if isinstance(methods, (str, type, Options, parts.ConstraintMethod)):
        methods = [methods]
    names = usual if methods is None else [_name(method) for method in methods]
    if not names and methods is not None:
        raise InputError("methods: expected one or more")
    return names


def _joined(tables: List[Dict[str, Columns]], seeds: List[int]) -> Dict[str, Table]:
    """Returns every table over the seeds that have it."""
    joined = {}
    for name in dict.fromkeys(name for of_seed in tables for name in of_seed):
        has = [n for n, of_seed in enumerate(tables) if name in of_seed]
        joined[name] = table(over_seeds([tables[n][name] for n in has], [seeds[n] for n in has]))
    return joined


@contextlib.contextmanager
def _folder_of_trials() -> Iterator[Path]:
    """A folder for the trials of a study. It stays if the study is cut off after the first of them."""
    folder, done = Path(tempfile.mkdtemp(prefix="taut-")), 0
    try:
        yield folder
    except BaseException:
        done = sum(len(ledger.read_text().splitlines()) - 1 for ledger in folder.glob("*/ledger.tsv"))
        if done:
            warnings.warn("the study was cut off; a ledger.tsv has a line for each trial, and the folder can be deleted: "
                          f"its {done} finished trials are kept in {folder}", stacklevel=4)
        raise
    finally:
        if not done:
            shutil.rmtree(folder, ignore_errors=True)


def _study(run: Any, scene: inputs.Scene, methods: Optional[Iterable[Any]], settings: List[Dict[str, Any]],
           asked: Dict[str, Any], dt_fs: Optional[float]) -> Dict[str, Table]:
    progress, tables = StudyProgress(), []
    with _folder_of_trials() as folder:
        for n, of_seed in enumerate(settings):
            read = inputs.read(scene, inputs.overrides(of_seed, None, dt_fs))
            names, its_own = _names(methods, list(CLASSES)), folder / str(n)
            its_own.mkdir()
            tables.append(run(read, names, asked, str(its_own), progress))
        progress.done()
        return _joined([{name: pictures.table_of(text) for name, text in of_seed.items()} for of_seed in tables],
                       [of_seed.get("run.seed", 0) for of_seed in settings])


def _drawn(tables: Dict[str, Any], draw: Draw, title: str = "") -> Dict[str, Any]:
    """Adds the pictures of the tables that have one. A picture that fails takes no table with it."""
    if not draw:
        return tables
    figures = tables["figures"] = {}
    for name in [name for name in tables if name in pictures.KINDS and hasattr(tables[name], "keys")]:
        try:
            figures[name] = pictures.draw(name, tables, draw, title)
        except Exception as error:
            warnings.warn(f"no picture of {name}: {str(error) or 'nothing to draw'}", stacklevel=3)
    return tables


def chart(scene: inputs.Scene, methods: Optional[Iterable[Any]] = None, *, dt_fs: Optional[float] = None,
          set: Optional[Mapping[str, Any]] = None, quick: bool = False, repeats: int = 0, steps: int = 0,
          drift_steps: int = 0, panels: Iterable[str] = PANELS, seeds: Seeds = None,
          draw: Draw = False) -> Dict[str, Any]:
    """Charts each method's speed against its accuracy.

    - ``methods``: words, classes (``taut.Shake``, or your own derived from taut.ConstraintMethod) or objects
      (``taut.Shake(tolerance=1e-6)``); None takes all of taut's. An option called tolerance, sweeps, order,
      iterations, gains, ... of a name or a class runs through a range of values; a word with settings, or an object, is
      one point
    - ``quick``: takes few settings, repeats and steps, for a rough chart in a second to a minute
    - ``repeats``, ``steps``: number of timed runs, and of steps in each; 0 takes the study's own
    - ``drift_steps``: number of steps in runs that measure the energy's drift and the bonds' errors, after a quarter as
      many; 0 takes the study's own
    - ``panels``: which of the tables to make
    - ``seeds``: number or list of ``run.seed``; tables then have means over them and their errors

    Returns the tables "work" (constraint time of a bond and step [ns] against bond error), "drift" (that time against
    the energy's drift), "order" (distance from an exact run against the step), "length" (cost against the length of
    chains), "precision" (of systems with pair forces), and "failures" of them all. Raises InputError.
    """
    pictures.expect_matplotlib(draw)
    wanted = [panels] if isinstance(panels, str) else list(panels)
    for panel in wanted:
        if panel not in PANELS:
            raise InputError(f"panels: {panel!r}, expected some of {', '.join(PANELS)}")
    asked = {"quick": quick, "repeats": repeats, "steps": steps, "drift_steps": drift_steps, "panels": wanted}
    return _drawn(_study(_core.chart, scene, methods, settings_of_seeds(seeds, set), asked, dt_fs), draw)


def stability(scene: inputs.Scene, methods: Optional[Iterable[Any]] = None, *, dt_fs: Optional[float] = None,
              set: Optional[Mapping[str, Any]] = None, quick: bool = False, steps: int = 0, plane: bool = True,
              bond_error: float = 0.1, energy_error: float = 1.0, seeds: Seeds = None,
              draw: Draw = False) -> Dict[str, Any]:
    """Finds where methods fail.

    - ``methods``: names, classes or objects such as ``taut.Shake(tolerance=1e-6)``; None takes all of taut's
    - ``steps``: number of steps that a stable run lasts; 0 takes the study's own
    - ``plane``: runs Baumgarte over a plane of α and β
    - ``bond_error``, ``energy_error``: a run has failed where a bond's relative error, or the energy's change over
      the largest kinetic energy, is above this
    - ``seeds``: number or list of ``run.seed``; tables then have means over them and their errors

    Returns the tables "plane" (steps survived and drift over α and β), "limits" (the theory's limit of β h against
    α h for a single bond) and "steps" (the largest step of each method that runs, and that keeps the energy [fs]).
    Raises InputError.
    """
    pictures.expect_matplotlib(draw)
    asked = {"quick": quick, "steps": steps, "plane": plane, **_errors(bond_error=bond_error, energy_error=energy_error)}
    return _drawn(_study(_core.stability, scene, methods, settings_of_seeds(seeds, set), asked, dt_fs), draw)


def _errors(**given: float) -> Dict[str, float]:
    """Returns errors that a study takes. Raises InputError that names one that is not above 0."""
    for name, error in given.items():
        if not error > 0:
            raise InputError(f"{name}: {error!r}, expected more than 0")
    return given


def calibrate(scene: inputs.Scene, *, against: Any = "rattle", sweeps: int = 0,
              copies: str = "mean", damping: str = "discrete", size: float = 1e-6, steps: int = 2000,
              dt_fs: Optional[float] = None, set: Optional[Mapping[str, Any]] = None, seeds: Seeds = None,
              draw: Draw = False) -> Dict[str, Any]:
    """Finds the α and β with which Baumgarte reduces a bond's error per step as a reference method does.

    - ``against``: "rattle:sweeps=4", ``taut.Rattle(sweeps=4)`` and the like, of rattle, shake and newton, or a class or
      an object of your own derived from taut.ConstraintMethod
    - ``sweeps``: its fixed number of sweeps, in place of a tolerance
    - ``copies``: "mean", "first" or "slowest", the reduction to copy if it differs from step to step
    - ``damping``: the form of Baumgarte's law ("discrete", "centred", "implicit" or "lagged")
    - ``size``: the relative error that is put into every bond
    - ``steps``: number of steps of the runs that compare the methods; 0 compares none
    - ``seeds``: number or list of ``run.seed``; figures are then means over them, ``NAME_error`` their errors

    Returns "alpha_per_ps" and "beta_per_ps" [1/ps]; predicted and measured reductions and residuals; "courses", a table
    of the error after each step (rms of σ/d²); "method", that of Baumgarte in a word for ``Simulation(method=...)``;
    and "disagreement", empty if theory and measurement agree. With ``steps`` also "table", the reference, the calibrated
    and the default Baumgarte and newton side by side: reductions, bond errors at rest with their slope in time, energy
    drift, the bonds' share of it, and the bonds' time; "take", the one to take, None if none is sound; and "verdict",
    which says why; of the first seed. A seed that fails is left out with a warning. Raises InputError,
    SimulationFailure.
    """
    pictures.expect_matplotlib(draw)
    asked = {"against": _name(against), "sweeps": sweeps, "copies": copies, "damping": damping, "steps": steps,
             **_errors(size=size)}
    settings, found, seeds_of = settings_of_seeds(seeds, set), [], []
    for n, of_seed in enumerate(settings):
        read = inputs.read(scene, inputs.overrides(of_seed, None, dt_fs))
        try:
            found.append(dict(_core.calibrate(read, asked)))
        except SimulationFailure as failure:  # it takes no other seed's figures with it
            if n + 1 == len(settings) and not found:
                raise
            warnings.warn(f"seed {of_seed['run.seed']} is left out: {failure}", stacklevel=2)
        else:
            seeds_of.append(of_seed.get("run.seed", 0))
    courses = [{"step": np.arange(len(one["reference"]["stretch"])),
                "reference": one.pop("reference")["stretch"], "baumgarte": one.pop("baumgarte")["stretch"]}
               for one in found]
    result: Dict[str, Any] = found[0]
    for name in [name for name, figure in found[0].items() if isinstance(figure, float) and len(found) > 1]:
        mean, error = mean_and_error([one[name] for one in found])
        result[name], result[f"{name}_error"] = float(mean), float(error)
    result["disagreement"] = "\n".join(dict.fromkeys(one["disagreement"] for one in found if one["disagreement"]))
    result["courses"] = table(over_seeds(courses, seeds_of))
    tables = [pictures.table_of(one["table"]) for one in found if "table" in one]
    if tables:
        result["table"] = table(over_seeds(tables, seeds_of))
    return _drawn(result, draw)


def crosscheck(scene: inputs.Scene, methods: Optional[Iterable[Any]] = None, *, steps: int = 200,
               dt_fs: Optional[float] = None, set: Optional[Mapping[str, Any]] = None, platform: str = "Reference",
               precision: str = "", integrator: str = "openmm", speed_seconds: float = 0.0,
               agreement_nm: float = 1e-6, seeds: Seeds = None, draw: Draw = False) -> Dict[str, Any]:
    """Compares a scene's runs with those of OpenMM, the version that taut was built with.

    - ``methods``: words, "baumgarte:gains=dead-beat", classes or objects; None takes the study's own. Projections are held
      to 1e-12 unless they name a tolerance
    - ``platform``: OpenMM's platform; ``precision``: of a device's: "single", "mixed" or "double"
    - ``integrator``: "openmm" for OpenMM's own, "taut" for that of taut's plug-in, beside taut's run of each method
    - ``speed_seconds``: how long to measure speeds; 0 measures none
    - ``agreement_nm``: runs that are further apart than this have parted [nm]
    - ``seeds``: number or list of ``run.seed``; tables then have means over them and their errors, and "of_seeds" has
      the figures of each

    Returns the figures and "verdicts" of crosscheck.json, the table "samples" of every sample of every run, and for
    liquid water "distances", its radial distribution; "bond_lengths" has each run's error of them, its slope in time and what it is
    made of, and "verdict" a sentence. A run that broke has its "failure"; beside it nothing is judged.
    Raises InputError.
    """
    pictures.expect_matplotlib(draw)
    progress, found = StudyProgress(), []
    asked = {"platform": platform, "precision": precision, "integrator": integrator, "speed_seconds": speed_seconds,
             **_errors(agreement_nm=agreement_nm)}
    settings = settings_of_seeds(seeds, {"run.steps": steps, **(set or {})})
    for of_seed in settings:
        read = inputs.read(scene, inputs.overrides(of_seed, None, dt_fs))
        found.append(dict(_core.crosscheck(read, _names(methods, []), asked, progress)))
    progress.done()
    figures = [json.loads(one.pop("json")) for one in found]
    result: Dict[str, Any] = dict(figures[0])
    if len(figures) > 1:
        result["of_seeds"] = figures
    result.update(_joined([{name: pictures.table_of(text) for name, text in one.items()} for one in found],
                          [of_seed.get("run.seed", 0) for of_seed in settings]))
    return _drawn(result, draw)
