"""What is measured of runs: scans over settings, runs that differ by their seed, structure and transport."""

from __future__ import annotations

from typing import Any, Callable, Dict, List, Mapping, Tuple

import numpy as np

from .page import LETTERS, Page, line_of, plain
from .style import HUES, MOST, Table, each, ink, look, numbers, texts, with_error

Draw = Callable[[Page, Any, Table], None]


def few(names: Any) -> Tuple[List[str], List[str]]:
    """Returns the curves that are named, six at most, and those that are drawn grey behind them."""
    names = each(names)
    return (names[:MOST], names[MOST:]) if len(names) > MOST else (names, [])


def figures_of(table: Table) -> List[str]:
    """Returns the figures that rows are of, with their units."""
    return [f"{figure} [{unit}]" if unit else figure for figure, unit in zip(texts(table, "figure"), texts(table, "unit"))]


def scan(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """Means over seeds: a panel a figure, along x the first key that was varied, a curve for each setting of the others."""
    table = tables["scan"]
    figures, curves, words = np.array(figures_of(table), object), texts(table, "curve"), texts(table, "x_text")
    x, y, error = (numbers(table, name) for name in ("x", "value", "standard_error"))
    page = Page(len(each(figures)), width_mm, columns=3, height_mm=48, title=title)
    named, behind = few(curves)
    for axis, figure in zip(page.axes, each(figures)):
        ends = []
        for n, name in enumerate(named + behind):
            of = (figures == figure) & (curves == name) & np.isfinite(y)
            if not of.any():
                continue
            curve = look("", n) if n < len(named) else {**look(""), "color": "#bbbbbb"}
            axis.errorbar(x[of] + _aside(x, n, len(named)), y[of], error[of], elinewidth=0.7, **curve)
            if n < len(named):
                ends.append((x[of][-1], y[of][-1], name, curve["color"]))
        axis.set_title(plain(figure))
        if len(named) > 1:
            page.name_ends(axis, ends)
        axis.margins(x=0.08)
        if (words != "-").any():
            axis.set_xticks(each(x), [plain(word) for word in each(words)])
        axis.set_xlabel(plain(texts(table, "x_name")[0]))
    return page.finish()


def _aside(x: Any, n: int, of: int) -> float:
    """Moves curves apart by so little that bars are not upon each other."""
    return float(0.012 * (n - (of - 1) / 2) * (np.nanmax(x) - np.nanmin(x))) if of > 1 else 0.0


def draw_each_run(_: Any, axis: Any, table: Table, of: Any) -> None:
    """Draws the runs in their order, with the value that is measured over all as a band."""
    number, value, error = (numbers(table, name)[of] for name in ("number", "value", "standard_error"))
    run = number > 0
    axis.errorbar(number[run], value[run], error[run], color="#000000", marker="o", linestyle="none", elinewidth=0.8)
    for mean, width in zip(value[~run], error[~run]):
        axis.axhspan(mean - width, mean + width, color="#56B4E9", alpha=0.3, lw=0)
        axis.axhline(mean, color="#0072B2", lw=1)
    axis.set(xlabel="run", xlim=(0.5, number.max() + 0.5))
    axis.xaxis.get_major_locator().set_params(integer=True)


def each_run(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """Every run's value of each figure, and their mean."""
    figures = np.array(figures_of(tables["each_run"]), object)
    page = Page(len(each(figures)), width_mm, columns=3, title=title)
    for axis, figure in zip(page.axes, each(figures)):
        of = figures == figure
        mean = of & (numbers(tables["each_run"], "number") == 0)
        draw_each_run(page, axis, tables["each_run"], of)
        axis.set_title("\n".join([plain(figure), *[f"mean {with_error(value, error)}" for value, error in zip(
            numbers(tables["each_run"], "value")[mean], numbers(tables["each_run"], "standard_error")[mean])]]))
    return page.finish()


# ---- What is drawn alone by `taut measure`, and as a panel by `taut plot`

TITLES = {"distances": "g(r)", "displacement": "⟨Δr²⟩ of molecules [nm²]", "relaxation": "⟨R(0)·R(t)⟩/⟨R²⟩ of chains",
          "viscosity": "viscosity, integral up to t [mPa s]"}


def _by_run(page: Page, axis: Any, table: Table, x: str, y: str) -> None:
    """Draws a curve for each run with its error as a band, named at its end."""
    runs, at, value, error = texts(table, "run"), numbers(table, x), numbers(table, y), numbers(table, "standard_error")
    named, behind = few(runs)
    ends = []
    for n, name in enumerate(named + behind):
        of = runs == name
        curve = line_of(look("", n), **({} if n < len(named) else {"color": "#bbbbbb"}))
        axis.plot(at[of], value[of], **curve)
        axis.fill_between(at[of], value[of] - error[of], value[of] + error[of], color=curve["color"], alpha=0.25, lw=0)
        if n < len(named) and name:
            some = np.unique(np.linspace(0, of.sum() - 1, 24).astype(int))
            ends.append((at[of][some], value[of][some], name, curve["color"]))
    axis.margins(x=0)
    if len(ends) > 1:
        page.name_points(axis, ends)


def draw_distances(page: Page, axis: Any, table: Table) -> None:
    _by_run(page, axis, table, "r_nm", "g")
    r, g = numbers(table, "r_nm"), numbers(table, "g")
    axis.set_xlim(0.85 * r[g > 0].min() if (g > 0).any() else None, r.max())
    axis.set_ylim(0, None)
    axis.axhline(1, color="#999999", lw=0.5, ls=(0, (3, 2)), zorder=0)
    of = each(texts(table, "run"))
    axis.set(xlabel="r [nm]", title=f"g(r) of {plain(of[0])}" if len(of) == 1 and of[0] else TITLES["distances"])


def draw_displacement(page: Page, axis: Any, table: Table) -> None:
    _by_run(page, axis, table, "t_ps", "squared_nm2")
    axis.set(xlabel="t [ps]", title=TITLES["displacement"], ylim=(0, None))


def draw_relaxation(page: Page, axis: Any, table: Table) -> None:
    _by_run(page, axis, table, "t_ps", "correlation")
    axis.axhline(np.exp(-1), color="#777777", lw=0.6, ls=(0, (3, 2)))
    axis.annotate("1/e", (0.01, np.exp(-1)), xycoords=("axes fraction", "data"), fontsize=LETTERS, va="bottom")
    axis.set(xlabel="t [ps]", title=TITLES["relaxation"])


def draw_viscosity(page: Page, axis: Any, table: Table) -> None:
    t, value, error, correlation, cut = (
        numbers(table, name) for name in ("t_ps", "viscosity_mpa_s", "standard_error", "correlation", "cut_ps"))
    shown = t <= (3 * cut[0] if 0 < 3 * cut[0] < t.max() else t.max())
    axis.plot(t[shown], value[shown], color=HUES[0])
    axis.fill_between(t[shown], (value - error)[shown], (value + error)[shown], color=HUES[0], alpha=0.25, lw=0)
    other = axis.twinx()
    other.plot(t[shown], correlation[shown], color=HUES[1], ls=(0, (4, 1.5)), lw=0.8)
    other.set_ylim(-0.2, 1)
    other.grid(False)
    other.spines["right"].set_visible(True)
    other.set_ylabel("⟨P(0)P(t)⟩/⟨P²⟩, dashed", color=ink(HUES[1]), fontsize=LETTERS)
    if cut[0] > 0:
        at = int(np.argmin(abs(t - cut[0])))
        axis.plot(t[at], value[at], "o", color=HUES[0])
        axis.annotate(with_error(value[at], error[at]), (t[at], value[at]), (3, -9), textcoords="offset points",
                      fontsize=LETTERS, color=HUES[0])
    axis.margins(x=0)
    axis.set(xlabel="t [ps]", title=TITLES["viscosity"], ylim=(0, None))


def draw_loads(page: Page, axis: Any, table: Table) -> None:
    bond, mean, error, least, most = (numbers(table, name) for name in (
        "bond", "tension_kj_mol_nm", "standard_error", "least_kj_mol_nm", "most_kj_mol_nm"))
    if len(bond) <= 200:
        axis.bar(bond, most - least, width=0.7, bottom=least, color=HUES[5], alpha=0.4)
    else:
        axis.fill_between(bond, least, most, step="mid", color=HUES[5], alpha=0.4, lw=0)
    axis.errorbar(bond, mean, error, color=HUES[0], marker="o", markersize=2.5 if len(bond) < 200 else 1, linestyle="none",
                  elinewidth=0.7)
    axis.axhline(0, color="#777777", lw=0.5)
    if len(bond) <= 24:
        axis.set_xticks(bond, texts(table, "atoms"), rotation=90 if len(bond) > 8 else 0)
    axis.set(xlabel="bond, by its atoms" if len(bond) <= 24 else "bond", title="tension [kJ/mol/nm]",
             xlim=(bond.min() - 0.5, bond.max() + 0.5))


def draw_loads_in_time(page: Page, axis: Any, table: Table) -> None:
    of, t, tension = texts(table, "run"), numbers(table, "t_ps"), numbers(table, "tension_kj_mol_nm")
    ends = []
    for n, name in enumerate(each(of)):
        curve = line_of(look("", n), lw=0.8)
        axis.plot(t[of == name], tension[of == name], **curve)
        ends.append((t[of == name][-1], tension[of == name][-1], f"bond {name}", curve["color"]))
    axis.margins(x=0)
    page.name_ends(axis, ends)
    axis.set(xlabel="t [ps]", title="tension [kJ/mol/nm]")


def mean_force(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """The mean tension of a bond along its length, and the potential that it integrates to; bars and bands: errors."""
    table = tables["mean_force"]
    of, d = texts(table, "run"), numbers(table, "length_nm")
    page = Page(2, width_mm, columns=2, height_mm=60, title=title)
    for axis, y, error, name in zip(page.axes, ("tension_kj_mol_nm", "potential_kj_mol"), ("tension_error", "standard_error"),
                                    ("mean tension [kJ/mol/nm]", "potential of mean force [kJ/mol]")):
        ends = []
        for n, curve_of in enumerate(each(of)):
            at, curve = of == curve_of, look("", n)
            axis.errorbar(d[at], numbers(table, y)[at], numbers(table, error)[at], elinewidth=0.7, **curve)
            ends.append((d[at][-1], numbers(table, y)[at][-1], curve_of, curve["color"]))
        if len(ends) > 1:
            page.name_ends(axis, ends)
        axis.axhline(0, color="#777777", lw=0.5)
        axis.set(xlabel="length [nm]", title=name)
    return page.finish()


def draw_equilibration(page: Page, axis: Any, table: Table) -> None:
    t, out, measured = (numbers(table, name) for name in ("t_ps", "left_out_kj_mol", "measured_kj_mol"))
    axis.plot(t, out, color=HUES[1], ls=(0, (3, 1)))
    axis.plot(t, measured, color=HUES[0])
    ends = [(t[k][::max(1, k.sum() // 24)], y[k][::max(1, k.sum() // 24)], name, colour) for y, name, colour in ((out, "left out", HUES[1]), (measured, "measured", HUES[0]))
            for k in [np.isfinite(y)] if k.any()]
    axis.margins(x=0)
    page.name_points(axis, ends)
    axis.set(xlabel="t [ps]", title="potential energy [kJ/mol]")


PANELS: Dict[str, Any] = {"distances": draw_distances, "displacement": draw_displacement, "relaxation": draw_relaxation,
                           "viscosity": draw_viscosity}


def _alone(name: str, draw: Draw) -> Callable[[Mapping[str, Table], int, str], Any]:
    def drawn(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
        page = Page(1, width_mm, height_mm=60 if width_mm < 100 else 80, title=title)
        axis = page.axes[0]
        draw(page, axis, tables[name])
        axis.set_ylabel(axis.get_title(loc="left"))
        axis.set_title("")
        return page.finish()

    return drawn


equilibration = _alone("equilibration", draw_equilibration)
distances, displacement = _alone("distances", draw_distances), _alone("displacement", draw_displacement)
loads, loads_in_time = _alone("loads", draw_loads), _alone("loads_in_time", draw_loads_in_time)
relaxation, viscosity = _alone("relaxation", draw_relaxation), _alone("viscosity", draw_viscosity)
