"""The pictures of `taut crosscheck` and `taut calibrate`: runs beside OpenMM's, and errors that decay."""

from __future__ import annotations

from typing import Any, Mapping

import numpy as np

from .page import Page, line_of
from .style import Table, each, groups_of, limit, logarithmic, look, looks_of, numbers, texts

BROKEN = 0.5  #: relative bond error from which a run is no run any more


def crosscheck(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """Distances from OpenMM's run and from the fine one, bond errors and the energy, of at most six runs a panel."""
    table = tables["crosscheck" if "crosscheck" in tables else "samples"]
    names, t = texts(table, "run"), numbers(table, "t_ps")
    energy, error = numbers(table, "energy_kj_mol"), numbers(table, "max_rel_bond_error")
    energy = abs(energy - np.array([energy[names == name][0] for name in names]))
    quantities = [("apart from OpenMM's run [nm]", numbers(table, "apart_nm")),
                  ("apart from the fine run [nm]", numbers(table, "from_fine_run_nm")),
                  ("largest relative bond error", error), ("|E − E₀| [kJ/mol]", energy)]
    whole = t > 0
    for name in each(names):
        broken = np.flatnonzero((names == name) & ~(error < BROKEN) & np.isfinite(error))
        if len(broken):
            whole &= ~((names == name) & (t >= t[broken[0]]))
    runs = [name for name in each(names) if " at h/" not in name]
    methods = {name: name.split(" ")[0] for name in runs}
    groups = groups_of(runs, methods)
    looks = {name: curve for group in groups for name, curve in looks_of(group, methods).items()}
    columns = len(groups) if width_mm > 100 else 1
    page = Page(len(quantities) * len(groups), width_mm, columns=columns, height_mm=46 if width_mm > 100 else 38, title=title)
    order = [(row, group) for row in range(len(quantities)) for group in groups] if columns > 1 else \
        [(row, group) for group in groups for row in range(len(quantities))]
    explained = max([t[names == name].max() for name in runs if " moved " in name], default=t.max())
    for axis, (row, group) in zip(page.axes, order):
        words, values = quantities[row]
        shown = whole & (values > 0) & np.isin(names, runs) & ((t <= explained) if row < 2 else True)
        ends = []
        for name in group:
            of = shown & (names == name)
            if of.any() and (row < 2 or t[of].max() > 0.5 * t.max()):  # others only explain
                curve = line_of(looks[name])
                axis.plot(t[of], values[of], **{**curve, "lw": 0.9})
                ends.append((t[of][-1], values[of][-1], name, curve["color"]))
        limit(axis, "y", values[shown], log=True)
        axis.set_xlim(0, explained if row < 2 else t.max())
        axis.set_title(words)
        axis.set_xlabel("t [ps]")
        page.name_ends(axis, ends)
    return page.finish()


def courses(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """The error of a bond after each step, of the reference and of Baumgarte that copies it."""
    table = tables["courses"]
    page = Page(1, width_mm, height_mm=70, title=title)
    axis, step, ends = page.axes[0], numbers(table, "step"), []
    curves = [name for name in table if name != "step" and not name.endswith("_error")]
    floor = max((numbers(table, name)[-1] for name in curves), default=0)
    last = max((int(np.argmax(numbers(table, name) <= 2 * floor)) for name in curves), default=0) + 3
    for n, name in enumerate(curves):
        y = numbers(table, name)
        shown = (y > 0) & (step <= max(last, 6))
        curve = look("baumgarte" if name == "baumgarte" else "rattle", 0)
        axis.plot(step[shown], y[shown], **{**curve, "linestyle": ("-", (0, (4, 1.5)))[n % 2]})
        if shown.any():
            ends.append((step[shown][-1], y[shown][-1], name, curve["color"]))
    limit(axis, "y", np.concatenate([axis.lines[n].get_ydata() for n in range(len(axis.lines))] or [[1]]), log=True)
    logarithmic(axis, "y")
    axis.set(xlabel="step", ylabel="bond error, rms σ/d²")
    page.name_ends(axis, ends)
    return page.finish()
