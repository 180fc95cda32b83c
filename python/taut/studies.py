"""Studies: which method, at which setting, at what cost, and does it agree with OpenMM.

Each returns a dict of tables; a table is a dict of columns, numpy arrays of one length (a pandas.DataFrame where
pandas is installed). With ``draw=True`` each shows a picture, by matplotlib; its figure is under "figure".
"""

from __future__ import annotations

import csv
import io
import json
import sys
import tempfile
from typing import Any, Dict, Iterable, List, Mapping, Optional

import numpy as np

from . import _core, inputs, parts
from .errors import InputError
from .options import CLASSES

PANELS = ("work", "drift", "order", "length", "precision")
Table = Any  #: a dict of columns, or a pandas.DataFrame


def _column(cells: List[str]) -> np.ndarray:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells, dtype=str)


def table(columns: Mapping[str, Any]) -> Table:
    """A DataFrame where pandas is installed, else a dict of arrays."""
    try:
        import pandas
    except ImportError:
        return dict(columns)
    return pandas.DataFrame(dict(columns))


def table_of_csv(text: str) -> Table:
    rows = list(csv.reader(io.StringIO(text)))
    return table({name: _column([row[n] for row in rows[1:]]) for n, name in enumerate(rows[0])})


class Progress:
    """One line, rewritten, on a terminal or in a notebook."""

    def __init__(self) -> None:
        self.shown = sys.stderr.isatty() or "ipykernel" in sys.modules

    def __call__(self, *what: Any) -> None:
        line = what[0] if len(what) == 1 else f"{what[0]} of {what[1]} trials"
        if self.shown:
            sys.stderr.write(f"\r{line:<60}")
            sys.stderr.flush()

    def done(self) -> None:
        if self.shown:
            sys.stderr.write("\r" + " " * 60 + "\r")


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
    progress = Progress()
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
    """Each method's speed against its accuracy.

    methods      names, or classes derived from taut.ConstraintMethod; None: all of taut's. An option of theirs that
                 is called tolerance, sweeps, order, iterations, gains, ... is taken through a range of values
    quick        rough: few settings, repeats and steps, in a second or a minute
    repeats      of all that is timed; steps: of a timed run; drift_steps: of one whose energy is watched. 0: the usual

    Tables: "work" (constraint time a bond and step [ns] against bond error), "drift", "order" (distance from an exact
    run against the step), "length" (cost against the length of chains), "precision" (with pair forces); where all of
    them were asked for, "failures".
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
    """Where methods fail, and how.

    Tables: "plane" (Baumgarte over the plane of its gains: steps survived, drift), "limits" (of one bond, βh against
    αh), "steps" (the largest stable step of each method [fs]). plane=False leaves the plane out.
    """
    asked = {"quick": quick, "steps": steps, "plane": plane}
    return _drawn(_study(_core.stability, scene, methods, inputs.overrides(set, None, dt_fs), asked), "stability", draw)


def calibrate(scene: inputs.Scene, *, against: Any = "rattle", tolerance: float = 1e-10, sweeps: int = 0,
              copies: str = "mean", damping: str = "centred", passes: int = 2, dt_fs: Optional[float] = None,
              set: Optional[Mapping[str, Any]] = None, draw: bool = False) -> Dict[str, Any]:
    """The gains with which Baumgarte reduces an error a step as a reference method does.

    against   rattle, shake or newton, at `tolerance`, or with so many `sweeps` in place of it; or a class of your own
              derived from taut.ConstraintMethod
    copies    mean, first or slowest: what of an error's course gains copy where steps are not alike
    damping   discrete, centred, implicit or lagged; passes: solves a step of Baumgarte's

    "alpha_per_ps", "beta_per_ps" [1/ps]; predicted and measured reductions and floors; "courses": a table of an error's
    course, rms σ/d² step by step; "settings": what to give Simulation(set=...); "disagreement": empty, or why not.
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
    """Holds a scene's runs against OpenMM's (the OpenMM that taut was built with).

    methods  names, "baumgarte:dead-beat" for one of its gains; None: the usual ones

    All figures and "verdicts" as crosscheck.json has them; "samples": a table of every sample of every run;
    "distances": g(r) of liquid water.
    """
    names = [] if methods is None else [m if isinstance(m, str) else parts.named(m) for m in methods]
    progress = Progress()
    said = inputs.overrides({"run.steps": steps, **(set or {})}, None, dt_fs)
    found = dict(_core.crosscheck(inputs.read(scene, said), names,
                                  {"platform": platform, "speed_seconds": speed_seconds}, progress))
    progress.done()
    result: Dict[str, Any] = json.loads(found.pop("json"))
    result.update({name: table_of_csv(text) for name, text in found.items()})
    return _drawn(result, "crosscheck", draw)
