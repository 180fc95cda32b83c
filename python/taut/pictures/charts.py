"""The pictures of `taut chart`: what methods cost, and how exact they are."""

from __future__ import annotations

from typing import Any, Dict, List, Mapping, Tuple

import numpy as np

from .page import Page
from .style import HUES, METHODS, NothingToDraw, Table, each, groups_of, limit, look, numbers, texts

COST = "constraint time [ns a bond and step]"
DRIFT = "|energy drift| [kJ/mol/ns/degree of freedom]"


def _curves(table: Table, there: Any, by: str = "curve") -> Tuple[Any, List[List[str]], Dict[str, Dict[str, Any]]]:
    """Returns the names of rows' curves, groups of those that have a row that is there, a panel each, and their looks."""
    names = texts(table, by)
    methods = dict(zip(names, texts(table, "method") if "method" in table else names))
    curves = [name for name in each(names) if (there & (names == name)).any()]
    if not curves:
        raise NothingToDraw
    taken = {METHODS[method][0] for method in methods.values() if method in METHODS}
    own = [method for method in each(methods[curve] for curve in curves) if method not in METHODS]
    free = [hue for hue in HUES if hue not in taken] or list(HUES)
    number: Dict[str, int] = {}
    looks = {}
    for curve in curves:
        number[methods[curve]] = number.get(methods[curve], -1) + 1
        looks[curve] = look(methods[curve], number[methods[curve]])
        if methods[curve] in own:
            looks[curve].update(color=free[own.index(methods[curve]) % len(free)], marker="*")
    return names, groups_of(curves, methods), looks


def _name(axis: Any, page: Page, x: Any, y: Any, text: str, colour: str) -> None:
    """Writes a curve's name beside one of its points."""
    page.name_points(axis, [(x, y, text, colour)])


def _bars(middle: Any, low: Any, high: Any) -> Any:
    """Returns how far bars reach down and up; nothing where their ends are not known."""
    return np.nan_to_num(np.maximum([middle - low, high - middle], 0))


def _values(axis: Any, page: Page, x: Any, y: Any, values: Any, colour: str) -> None:
    """Writes the settings of a curve's first and last point beside them."""
    ends = {0, len(x) - 1} if len(x) > 1 else set()
    page.name_points(axis, [(x[k:k + 1], y[k:k + 1], str(values[k]), colour) for k in sorted(ends) if values[k]])


def work(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """Constraint time against bond error: a point at the rms, a line from there to the largest error."""
    table = tables["work"]
    rms, most, cost = (numbers(table, name) for name in ("rms_rel_bond_error", "max_rel_bond_error", "ns_per_bond_step"))
    rms = np.maximum(rms, 1e-16)  # what rounding leaves at the least
    low, high = numbers(table, "ns_per_bond_step_q1"), numbers(table, "ns_per_bond_step_q3")
    there = np.isfinite(rms) & np.isfinite(cost)
    names, groups, looks = _curves(table, there)
    values = texts(table, "value")
    page = Page(len(groups), width_mm, columns=2 if len(groups) < 5 else 3, height_mm=68, title=title, sharex=True, sharey=True)
    for axis, group in zip(page.axes, groups):
        limit(axis, "x", rms[there], log=True)
        limit(axis, "y", cost[there], log=True)
        axis.set_xlim(rms[there].min() / 3, rms[there].max() * 3)
        for name in group:
            of = there & (names == name)
            x, y, curve = rms[of], cost[of], looks[name]
            axis.hlines(y, x, np.fmax(most[of], x), color=curve["color"], lw=0.5, alpha=0.6)
            axis.errorbar(x, y, _bars(y, low[of], high[of]), elinewidth=0.6, **curve)
            _name(axis, page, x, y, name, curve["color"])
        for name in group:
            of = there & (names == name)
            _values(axis, page, rms[of], cost[of], values[of], looks[name]["color"])
    _label(page, "relative bond error: rms, and line to the largest", COST)
    return page.finish()


def _label(page: Page, x: str, y: str) -> None:
    """Names the axes of panels that share them: below the lowest and left of the first of each row."""
    for n, axis in enumerate(page.axes):
        if n + page.columns >= len(page.axes):
            axis.set_xlabel(x)
            axis.tick_params(labelbottom=True)
        if n % page.columns == 0:
            axis.set_ylabel(y)


def _drifts(table: Table) -> Tuple[Any, Any, Any, Any]:
    """|drift| with its interval. Where that holds zero the drift is no more than its upper end, and drawn there."""
    drift, a, b = (numbers(table, name) for name in ("drift_kj_mol_ns_dof", "drift_low", "drift_high"))
    zero = a * b <= 0
    low, high = np.minimum(abs(a), abs(b)), np.maximum(abs(a), abs(b))
    return np.where(zero, high, abs(drift)), low, high, zero


def _draw_drifts(axis: Any, of: Any, drifts: Tuple[Any, Any, Any, Any], y: Any, curve: Dict[str, Any]) -> None:
    """Draws the interval of each drift, or where it holds zero an arrow to the left."""
    x, low, high, zero = (of_all[of] for of_all in drifts)
    sure = ~zero & np.isfinite(low)
    axis.hlines(y[of][sure], low[sure], high[sure], color=curve["color"], lw=0.6)
    for at, up in zip(x[zero], y[of][zero]):
        axis.annotate("", (0.45 * at, up), (at, up), annotation_clip=True,
                      arrowprops={"arrowstyle": "-|>,head_width=0.12,head_length=0.25", "lw": 0.6, "color": curve["color"],
                                  "shrinkA": 0, "shrinkB": 0})


def drift(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """Constraint time against the energy's drift."""
    table = tables["drift"]
    drifts, cost = _drifts(table), numbers(table, "ns_per_bond_step")
    there = np.isfinite(drifts[0]) & np.isfinite(cost) & (drifts[0] > 0)
    names, groups, looks = _curves(table, there)
    values = texts(table, "value")
    page = Page(len(groups), width_mm, columns=2 if len(groups) < 5 else 3, height_mm=68, title=title, sharex=True, sharey=True)
    for axis, group in zip(page.axes, groups):
        limit(axis, "x", drifts[0][there], log=True)
        limit(axis, "y", cost[there], log=True)
        axis.set_xlim(drifts[0][there].min() / 3, drifts[0][there].max() * 2)
        for name in group:
            of, curve = there & (names == name), looks[name]
            axis.plot(drifts[0][of], cost[of], **curve)
            _draw_drifts(axis, of, drifts, cost, curve)
            _name(axis, page, drifts[0][of], cost[of], name, curve["color"])
        for name in group:
            of = there & (names == name)
            _values(axis, page, drifts[0][of], cost[of], values[of], looks[name]["color"])
    _label(page, f"{DRIFT},\n95 %; arrow: zero is inside, at most that", COST)
    return page.finish()


def _functions(table: Table, x: Any, y: Any, by: str, page_of: Tuple[int, str], error: Any = None) -> Page:
    """Draws curves over one x, named at their ends, in panels of six."""
    there = np.isfinite(x) & np.isfinite(y) & (y > 0)
    names, groups, looks = _curves(table, there, by)
    page = Page(len(groups), page_of[0], columns=2, height_mm=62, title=page_of[1], sharex=True, sharey=True)
    for axis, group in zip(page.axes, groups):
        limit(axis, "x", x[there], log=True)
        limit(axis, "y", y[there], log=True)
        ends = []
        for name in group:
            of, curve = there & (names == name), looks[name]
            axis.errorbar(x[of], y[of], None if error is None else error[:, of], elinewidth=0.6, **curve)
            end = np.argmax(x[of])
            ends.append((x[of][end], y[of][end], name, curve["color"]))
        page.name_ends(axis, ends)
    return page


def order(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """The distance from the exact trajectory against the step, and the order of the methods that is its slope."""
    table = dict(method=texts(tables["order"], "method"))
    slope, x = numbers(tables["order"], "order"), numbers(tables["order"], "dt_fs")
    table["curve"] = np.array([f"{method} {of:.2f}" if of == of else method for method, of in zip(table["method"], slope)], object)
    y = np.where(np.isfinite(slope), numbers(tables["order"], "rms_distance_nm"), np.nan)
    page = _functions(table, x, y, "curve", (width_mm, title))
    for axis in page.axes:
        axis.set_xticks(each(x[np.isfinite(x)]), [f"{step:g}" for step in each(x[np.isfinite(x)])])
        axis.minorticks_off()
    _label(page, "step [fs]; behind the names: the order", "rms distance from the exact run [nm]")
    return page.finish()


def length(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """What a bond costs in chains of so many."""
    table = tables["length"]
    cost = numbers(table, "ns_per_bond_step")
    error = _bars(cost, numbers(table, "ns_per_bond_step_q1"), numbers(table, "ns_per_bond_step_q3"))
    page = _functions(table, numbers(table, "bonds"), cost, "method", (width_mm, title), error)
    _label(page, "bonds of a chain", COST)
    return page.finish()


def precision(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """A step's time against the drift, with pair forces in double (full) and mixed precision (empty marks)."""
    table = tables["precision"]
    drifts, time = _drifts(table), numbers(table, "step_us")
    low, high = numbers(table, "step_us_q1"), numbers(table, "step_us_q3")
    there = np.isfinite(drifts[0]) & np.isfinite(time) & (drifts[0] > 0)
    mixed = texts(table, "precision") == "mixed"
    names, groups, looks = _curves(table, there, "method")
    page = Page(len(groups), width_mm, columns=2, height_mm=70, title=title, sharex=True, sharey=True)
    for axis, group in zip(page.axes, groups):
        limit(axis, "x", drifts[0][there], log=True)
        axis.set_xlim(drifts[0][there].min() / 4, drifts[0][there].max() * 3)
        for name in group:
            both = there & (names == name)
            curve = looks[name]
            axis.plot(drifts[0][both], time[both], lw=0.5, color=curve["color"])
            for of, fill in ((both & ~mixed, "full"), (both & mixed, "none")):
                axis.errorbar(drifts[0][of], time[of], _bars(time[of], low[of], high[of]), elinewidth=0.6,
                              color=curve["color"], marker=curve["marker"], fillstyle=fill, linestyle="none", markersize=4.5)
                _draw_drifts(axis, of, drifts, time, curve)
            _name(axis, page, drifts[0][both], time[both], name, curve["color"])
        axis.set_ylim(0, 1.06 * time[there].max())
    _label(page, f"{DRIFT},\n95 %; arrow: zero is inside, at most that;\nempty marks: mixed precision", "time of a step [µs]")
    return page.finish()
