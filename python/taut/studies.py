"""Studies of constraint methods: their speed, accuracy and limits, and whether OpenMM agrees.

Each study returns a dict of tables. A table is a pandas.DataFrame, or without pandas a dict of columns, numpy arrays
of one length. With ``draw=True`` a study draws a picture with matplotlib; the dict has its figure as "figure".
"""

from __future__ import annotations

import csv
import io
import json
import tempfile
from typing import Any, Dict, Iterable, List, Mapping, Optional

import numpy as np
import numpy.typing as npt

from . import _core, inputs, parts
from .errors import InputError
from .options import CLASSES
from .progress import StudyProgress

PANELS = ("work", "drift", "order", "length", "precision")
Table = Any  #: a dict of columns, or a pandas.DataFrame


def _column(cells: List[str]) -> npt.NDArray[Any]:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells, dtype=str)


def table(columns: Mapping[str, Any]) -> Table:
    """Returns columns as a DataFrame, or without pandas as a dict of arrays."""
    try:
        import pandas
    except ImportError:
        return dict(columns)
    return pandas.DataFrame(dict(columns))


def table_of_csv(text: str) -> Table:
    """Returns the table of a CSV text with a line of names. An empty cell is nan."""
    rows = list(csv.reader(io.StringIO(text)))
    return table({name: _column([row[n] for row in rows[1:]]) for n, name in enumerate(rows[0])})


def _methods(methods: Optional[Iterable[Any]]) -> List[str]:
    if isinstance(methods, (str, type)):
        methods = [methods]
    names = list(CLASSES) if methods is None else [parts.named(method) for method in methods]
    if not names:
        raise InputError("methods: expected one or more")
    return names


def _study(run: Any, scene: inputs.Scene, methods: Optional[Iterable[Any]], settings: List[str],
           asked: Dict[str, Any]) -> Dict[str, Table]:
    names = _methods(methods)
    progress = StudyProgress()
    with tempfile.TemporaryDirectory(prefix="taut-") as folder:
        tables = run(inputs.read(scene, settings), names, asked, folder, progress)
    progress.done()
    return {name: table_of_csv(text) for name, text in tables.items()}


def _drawn(tables: Dict[str, Any], kind: str, draw: bool) -> Dict[str, Any]:
    if draw:
        from . import drawing

        tables["figure"] = getattr(drawing, kind)(tables)
    return tables


def chart(scene: inputs.Scene, methods: Optional[Iterable[Any]] = None, *, dt_fs: Optional[float] = None,
          set: Optional[Mapping[str, Any]] = None, quick: bool = False, repeats: int = 0, steps: int = 0,
          drift_steps: int = 0, panels: Iterable[str] = PANELS, draw: bool = False) -> Dict[str, Any]:
    """Charts each method's speed against its accuracy.

    - ``methods``: names, or classes derived from taut.ConstraintMethod; None takes all of taut's. An option called
      tolerance, sweeps, order, iterations, gains, ... runs through a range of values
    - ``quick``: takes few settings, repeats and steps, for a rough chart in a second to a minute
    - ``repeats``, ``steps``: number of timed runs, and of steps in each; 0 takes the study's own
    - ``drift_steps``: number of steps in runs that measure the energy's drift; 0 takes the study's own
    - ``panels``: which of the tables to make

    Returns the tables "work" (constraint time of a bond and step [ns] against bond error), "drift" (that time against
    the energy's drift), "order" (distance from an exact run against the step), "length" (cost against the length of
    chains), "precision" (of systems with pair forces), and "failures" if all panels were asked for. Raises InputError.
    """
    wanted = [panels] if isinstance(panels, str) else list(panels)
    for panel in wanted:
        if panel not in PANELS:
            raise InputError(f"panels: {panel!r}, expected some of {', '.join(PANELS)}")
    wanted += ["work"] if "drift" in wanted else []  # its costs are of that panel
    asked = {"quick": quick, "repeats": repeats, "steps": steps, "drift_steps": drift_steps, "panels": wanted}
    return _drawn(_study(_core.chart, scene, methods, inputs.overrides(set, None, dt_fs), asked), "chart", draw)


def stability(scene: inputs.Scene, methods: Optional[Iterable[Any]] = None, *, dt_fs: Optional[float] = None,
              set: Optional[Mapping[str, Any]] = None, quick: bool = False, steps: int = 0, plane: bool = True,
              draw: bool = False) -> Dict[str, Any]:
    """Finds where methods fail.

    - ``steps``: number of steps that a stable run lasts; 0 takes the study's own
    - ``plane``: runs Baumgarte over a plane of α and β

    Returns the tables "plane" (steps survived and drift over α and β), "limits" (the theory's limit of β h against
    α h for a single bond) and "steps" (the largest stable step of each method [fs]). Raises InputError.
    """
    asked = {"quick": quick, "steps": steps, "plane": plane}
    return _drawn(_study(_core.stability, scene, methods, inputs.overrides(set, None, dt_fs), asked), "stability", draw)


def calibrate(scene: inputs.Scene, *, against: Any = "rattle", tolerance: float = 1e-10, sweeps: int = 0,
              copies: str = "mean", damping: str = "centred", passes: int = 2, dt_fs: Optional[float] = None,
              set: Optional[Mapping[str, Any]] = None, draw: bool = False) -> Dict[str, Any]:
    """Finds the α and β with which Baumgarte reduces a bond's error per step as a reference method does.

    - ``against``: "rattle", "shake" or "newton", or a class of your own derived from taut.ConstraintMethod
    - ``tolerance``, ``sweeps``: the reference's tolerance, or in its place a fixed number of sweeps
    - ``copies``: "mean", "first" or "slowest", the reduction to copy if it differs from step to step
    - ``damping``, ``passes``: Baumgarte's form ("discrete", "centred", "implicit" or "lagged"), and its linear
      solves a step

    Returns "alpha_per_ps" and "beta_per_ps" [1/ps]; predicted and measured reductions and residuals; "courses", a table
    of the error after each step (rms of σ/d²); "settings" for ``Simulation(set=...)``; and "disagreement", empty if
    theory and measurement agree. Raises InputError.
    """
    asked = {"against": parts.named(against), "tolerance": tolerance, "sweeps": sweeps, "copies": copies,
             "damping": damping, "passes": passes}
    result: Dict[str, Any] = dict(_core.calibrate(inputs.read(scene, inputs.overrides(set, None, dt_fs)), asked))
    reference, baumgarte = result.pop("reference"), result.pop("baumgarte")
    result["courses"] = table({"step": np.arange(len(reference["stretch"])), "reference": reference["stretch"],
                               "baumgarte": baumgarte["stretch"]})
    result["settings"] = {"method.name": "baumgarte",
                          **{f"method.{key}": result[key] for key in ("gains", "damping", "reduction", "passes")}}
    return _drawn(result, "calibration", draw)


def crosscheck(scene: inputs.Scene, methods: Optional[Iterable[str]] = None, *, steps: int = 200,
               dt_fs: Optional[float] = None, set: Optional[Mapping[str, Any]] = None, platform: str = "Reference",
               speed_seconds: float = 0.0, draw: bool = False) -> Dict[str, Any]:
    """Compares a scene's runs with those of OpenMM, the version that taut was built with.

    - ``methods``: names, with gains as in "baumgarte:dead-beat"; None takes the study's own
    - ``platform``: OpenMM's platform
    - ``speed_seconds``: how long to measure speeds; 0 measures none

    Returns the figures and "verdicts" of crosscheck.json, the table "samples" of every sample of every run, and for
    liquid water "distances", its radial distribution. Raises InputError.
    """
    names = [] if methods is None else [m if isinstance(m, str) else parts.named(m) for m in methods]
    progress = StudyProgress()
    said = inputs.overrides({"run.steps": steps, **(set or {})}, None, dt_fs)
    found = dict(_core.crosscheck(inputs.read(scene, said), names,
                                  {"platform": platform, "speed_seconds": speed_seconds}, progress))
    progress.done()
    result: Dict[str, Any] = json.loads(found.pop("json"))
    result.update({name: table_of_csv(text) for name, text in found.items()})
    return _drawn(result, "crosscheck", draw)
