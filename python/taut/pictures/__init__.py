"""The pictures of taut, drawn by matplotlib from tables, for print: 85 or 170 mm wide, with letters of 7 and 8 points.

``import taut`` and the command draw by this one package, the command by ``__main__.py``. ``draw`` returns a figure,
``save`` writes it: ``taut.pictures.save(sim.plot(size=85), "run", "pdf,svg")``.
"""

from __future__ import annotations

from typing import Any, Mapping, Union

from . import beside, charts, limits, measured, runs
from .runs import log_tables
from .style import WIDTHS_MM, NothingToDraw, Refused, Table, pyplot, save, styled, table_of

__all__ = ["KINDS", "NothingToDraw", "Refused", "draw", "expect_matplotlib", "log_tables", "save", "table_of"]

#: what draws which table
KINDS = {"work": charts.work, "drift": charts.drift, "order": charts.order, "length": charts.length,
         "precision": charts.precision, "plane": limits.plane, "steps": limits.steps, "crosscheck": beside.crosscheck,
         "samples": beside.crosscheck,
         "courses": beside.courses, "run": runs.run, "scan": measured.scan, "each_run": measured.each_run,
         "equilibration": measured.equilibration, "distances": measured.distances, "displacement": measured.displacement,
         "relaxation": measured.relaxation, "viscosity": measured.viscosity, "loads": measured.loads,
         "loads_in_time": measured.loads_in_time, "mean_force": measured.mean_force}


def expect_matplotlib(draw: Union[int, bool]) -> None:
    """Raises ImportError before anything is run whose picture could not be drawn."""
    if draw:
        pyplot()


def draw(kind: str, tables: Mapping[str, Table], size: Union[int, bool] = 170, title: str = "") -> Any:
    """Returns matplotlib's figure of a table.

    - ``kind``: "work", "drift", "order", "length", "precision", "plane", "steps", "crosscheck", "courses", "run",
      "scan", "each_run", "equilibration", "distances", "displacement", "relaxation", "viscosity", "loads",
      "loads_in_time" or "mean_force"
    - ``tables``: the table of that name, and those that belong to it ("limits" to "plane")
    - ``size``: its width [mm], 85 or 170; True is 170
    """
    if (size := 170 if size is True else size) not in WIDTHS_MM:
        raise ValueError(f"size: {size!r}, expected 85 or 170 [mm]")
    with styled():
        return KINDS[kind](tables, size, title)
