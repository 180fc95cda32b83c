"""Draws a picture for each system of the study: the drift against the step, and against what a nanosecond costs. It needs the
module taut: PYTHONPATH=build/python."""
import numpy as np
from taut.pictures import save, styled
from taut.pictures.page import Page
from taut.pictures.style import groups_of, limit, looks_of

from cases import HERE, SYSTEMS
from judge import LARGEST_DRIFT_KT, cost_at, kt, mean_and_error, of, whole

FRONT = ("newton", "feedforward", "settle and lincs", "lincs strict", "lincs", "shake 1e-4")  # the README's picture
DRAWN = ("penalty", "baumgarte", "baumgarte centred", "baumgarte implicit", "feedforward", "shake 1e-4", "newton", "lincs",
         "lincs strict", "settle", "settle and lincs")


def points_of(judge, times, system, method):
    """(step, cost, drift [kT/ns/dof]); a drift below its error is drawn at its error."""
    for step, runs in sorted(judge.table[system].get(method, {}).items()):
        if whole(runs):
            drift, error = mean_and_error([v / kt(system) for v in of(runs, "drift")])
            cost = cost_at(times, system, method, step)
            yield step, cost, max(abs(drift), error)


def draw(judge, times):
    (HERE / "pictures").mkdir(exist_ok=True)
    with styled():
        for system in judge.systems:
            draw_system(judge, times, system)
        draw_front(judge, times, "villin")


def draw_front(judge, times, system):
    """One panel: drift against nanoseconds a day, each point named by its step once."""
    page = Page(1, 120, height_mm=75)
    axis, = page.axes
    points = {method: np.array([(s, 86400 / c, d) for s, c, d in points_of(judge, times, system, method) if c and s >= 2])
              for method in FRONT}
    limit(axis, "x", np.concatenate([rows[:, 1] for rows in points.values()]))
    limit(axis, "y", np.concatenate([rows[:, 2] for rows in points.values()]), log=True)
    axis.axhline(LARGEST_DRIFT_KT, color="#000000", lw=0.6, ls=(0, (4, 2)))
    for method, look in looks_of(FRONT, {method: method.split()[0] for method in FRONT}).items():
        step, x, y = points[method].T
        axis.plot(x, y, **look)
        page.name_points(axis, [(x, y, method, look["color"])])
        if method in ("lincs", "newton"):
            page.name_points(axis, [(x[k], y[k], f"{step[k]:g} fs", look["color"]) for k in range(len(x))])
    axis.set_xlabel("nanoseconds a day, one thread")
    axis.set_ylabel("energy drift, absolute [kT/ns/degree of freedom]")
    save(page.finish(), HERE / "pictures" / "front", "svg")


def draw_system(judge, times, system):
    """Panels of six methods at most, over the step and over the cost; every panel has the others grey behind."""
    points = {method: np.array([[s, c or np.nan, d] for s, c, d in points_of(judge, times, system, method)], float)
              for method in DRAWN}
    points = {method: rows for method, rows in points.items() if len(rows)}
    groups = groups_of(list(points), {method: method.split()[0] for method in points})
    columns = [(0, "step [fs]")] + [(1, "processor seconds a nanosecond, one thread")] * any(name == system for name, _ in times)
    page = Page(len(groups) * len(columns), 170, columns=2, height_mm=58, title=SYSTEMS[system].title, sharey=True)
    panels = [(group, *column) for group in groups for column in columns] if len(columns) > 1 else [(g, *columns[0]) for g in groups]
    for axis, (group, column, label) in zip(page.axes, panels):
        for rows in points.values():
            axis.plot(rows[:, column], rows[:, 2], color="#dddddd", lw=0.7, zorder=1)
        limit(axis, "x", np.concatenate([rows[:, column] for rows in points.values()]), log=True)
        limit(axis, "y", np.concatenate([rows[:, 2] for rows in points.values()]), log=True)
        axis.axhline(LARGEST_DRIFT_KT, color="#000000", lw=0.6, ls=(0, (4, 2)))
        for method, look in looks_of(group, {method: method.split()[0] for method in group}).items():
            x, y = points[method][:, column], points[method][:, 2]
            axis.plot(x, y, **look)
            page.name_points(axis, [(x, y, method, look["color"])])
        axis.set_xlabel(label)
    page.figure.supylabel("energy drift, absolute [kT/ns/degree of freedom]", fontsize=8)
    save(page.finish(), HERE / "pictures" / system, "svg")
