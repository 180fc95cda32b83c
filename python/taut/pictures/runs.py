"""The picture of `taut plot` and `sim.plot()`: a run, or some over each other, in panels."""

from __future__ import annotations

from functools import partial
from typing import Any, Callable, Dict, List, Mapping, Tuple

import numpy as np

from . import measured
from .page import LETTERS, Page, line_of, plain
from .style import HUES, MOST, NothingToDraw, Refused, Table, each, limit, look, numbers, shade, texts, with_error

Panel = Tuple[str, Callable[[Page, Any], None]]  # its title, and what draws it


def run(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """The log in time; temperatures by kind of molecule; what was measured; the first and the last frame. A table "panels"
    names those that are wanted, by a part of their titles."""
    table = tables["run"]
    above: List[Panel] = []
    frames: List[Panel] = []
    panels = each(texts(table, "panel"))
    runs = each(name.partition(": ")[0] for name in texts(table, "curve")[texts(table, "panel") == panels[0]]) if panels else []
    runs = runs if len(runs) > 1 else []
    for panel in panels:
        above.append((panel, partial(_time, tables=tables, panel=panel, runs=runs)))
    if "kinds" in tables and (texts(tables["kinds"], "kind") != "bath").any():
        above.append(("temperature by motion [K]", partial(_kinds, table=tables["kinds"])))
    for name in [name for name in measured.PANELS if name in tables]:
        above.append((measured.TITLES[name], partial(measured.PANELS[name], table=tables[name])))
    figures = np.array(measured.figures_of(tables["each_run"]), object) if "each_run" in tables else np.array([])
    for figure in each(figures):
        above.append((f"{figure}, each run", partial(measured.draw_each_run, table=tables["each_run"], of=figures == figure)))
    for frame in each(texts(tables["frames"], "frame")) if "frames" in tables else []:
        frames.append((frame, partial(_frame, table=tables["frames"], frame=frame)))
    if "panels" in tables:
        wanted = each(texts(tables["panels"], "panel"))
        for name in wanted:
            if not any(name in panel for panel, _ in above + frames):
                raise Refused(f"panels: no panel of {name}, there are {', '.join(panel for panel, _ in above + frames)}")
        above, frames = ([(panel, draw) for panel, draw in some if any(name in panel for name in wanted)] for some in (above, frames))
    return _page(tables, above, frames, width_mm, title)


def _page(tables: Mapping[str, Table], above: List[Panel], frames: List[Panel], width_mm: int, title: str) -> Any:
    """Draws panels, and frames in rows of their own below."""
    if not above + frames:
        raise NothingToDraw
    columns = (1 if width_mm < 100 else 2) if len(above) < 5 else 2 if width_mm < 100 else 3
    columns = max(columns, len(frames)) if len(above) < 5 else columns
    rows, below = -(-len(above) // columns), -(-len(frames) // columns)
    high = min(0.9 * _shape(tables["frames"]) * width_mm / columns / 45, 2.2) if frames else 1.0
    page = Page(rows * columns + len(frames), width_mm, columns=columns, narrow=columns, title=title,
                heights=[1.0] * rows + [high] * below)
    for unused in page.axes[len(above):rows * columns]:
        unused.remove()
    for axis, (panel, draw) in zip(page.axes[:len(above)] + page.axes[rows * columns:], above + frames):
        axis.set_title(plain(panel))
        draw(page, axis)
    return page.finish()


def _time(page: Page, axis: Any, tables: Mapping[str, Table], panel: str, runs: List[str]) -> None:
    """Draws a panel's curves: light each row, and over the measured part the mean up to each time and that of all."""
    table = tables["run"]
    of_panel = texts(table, "panel") == panel
    names, t, y, mean = texts(table, "curve"), numbers(table, "t_ps"), numbers(table, "value"), numbers(table, "running_mean")
    log = "bond error" in panel and (y[of_panel] > 0).any()
    ends, shown, seen, said, had = [], [], [], [], []
    for n, name in enumerate(each(names[of_panel])):
        of = of_panel & (names == name) & np.isfinite(y) & ((y > 0) if log else True)
        if not of.any():
            continue
        whose, _, what = name.partition(": ")
        k = runs.index(whose) if whose in runs else -1
        curve = line_of(look("", k if runs else n))
        if runs:
            curve.update({"linestyle": (0, (1, 1))} if whose in had else {}, **({"color": "#bbbbbb"} if k >= MOST else {}))
        had.append(whose)
        averaged = np.isfinite(mean[of]).any()
        axis.plot(t[of], y[of], **{**curve, "lw": 0.6, "color": shade(curve["color"], 0.5) if averaged else curve["color"]})
        if averaged:
            axis.plot(t[of], mean[of], **{**curve, "lw": 1.3})
        value = _mean(axis, tables.get("means"), panel, name, "#000000" if not runs else curve["color"])
        said += [value] if value and not runs else []
        shown += [y[of], mean[of]]
        label = (whose if page.unnamed and not what and k < MOST else what if k == 0 else "") if runs else name
        if label and label not in seen and label != "each row":
            some = np.unique(np.linspace(0, of.sum() - 1, 24).astype(int))
            ends.append((t[of][some], y[of][some], label, curve["color"]))
            seen.append(label)
    limit(axis, "y", np.concatenate(shown) if shown else [], log)
    axis.set_title("\n".join([plain(panel), *said]))
    if not log:
        axis.ticklabel_format(axis="y", useOffset=False, style="plain")
    axis.set_xlim(0 if 0 < t.min() < 0.05 * t.max() else t.min(), t.max())
    axis.set_xlabel("t [ps]")
    page.name_points(axis, ends)
    page.unnamed &= not set(runs) & set(seen)


def _mean(axis: Any, means: Any, panel: str, name: str, colour: str) -> str:
    """Draws the measured mean over the part that it is of, and returns it in words."""
    if means is None:
        return ""
    said, of = "", (texts(means, "panel") == panel) & (texts(means, "curve") == name)
    for begin, end, value, error in zip(*(numbers(means, key)[of] for key in ("from_ps", "to_ps", "value", "standard_error"))):
        axis.plot([begin, end], [value, value], color=colour, lw=0.9, ls=(0, (3, 1.5)))
        said = f"mean {with_error(value, error)}"
    return said


def _kinds(page: Page, axis: Any, table: Table) -> None:
    """Draws temperatures by type of molecule and motion, with each bath's as a dashed line."""
    runs, kinds = texts(table, "run"), texts(table, "kind")
    value, error = numbers(table, "temperature_k"), numbers(table, "standard_error")
    places = [kind for kind in each(kinds) if kind != "bath"]
    for n, name in enumerate(each(runs)):
        of = (runs == name) & (kinds != "bath")
        aside = 0.5 * (n - (len(each(runs)) - 1) / 2) / len(each(runs))
        curve = look("", n) if n < MOST else {**look(""), "color": "#bbbbbb"}
        axis.errorbar([places.index(kind) + aside for kind in kinds[of]], value[of], error[of], elinewidth=0.8,
                      color=curve["color"], marker=curve["marker"], linestyle="none")
        for bath in value[(runs == name) & (kinds == "bath")]:
            axis.axhline(bath, color=curve["color"], lw=0.8, ls=(0, (4, 2)))
            if n == 0:
                axis.annotate("bath", (1, bath), xycoords=("axes fraction", "data"), fontsize=LETTERS, ha="right", va="bottom")
    types, alone = [kind.partition(": ")[0] for kind in places], len({kind.partition(": ")[0] for kind in places}) == 1
    axis.set_xticks(range(len(places)), [plain(kind.partition(": ")[2] if alone else kind.partition(" molecules of ")[2] or kind) for kind in places],
                    **({} if alone else {"rotation": 25, "ha": "right", "rotation_mode": "anchor"}))
    axis.set(xlim=(-0.6, len(places) - 0.4), xlabel=plain(types[0]) if alone else "")


def _shape(table: Table) -> float:
    """Returns the height of a frame over its width."""
    x, up = ([*numbers(table, one), *numbers(table, other)] for one, other in (("x_nm", "to_x_nm"), ("up_nm", "to_up_nm")))
    return float((np.nanmax(up) - np.nanmin(up)) / max(np.nanmax(x) - np.nanmin(x), 1e-3))


KINDS = {"O": "#D55E00", "H": "#DDDDDD", "C": "#444444", "N": "#0072B2"}


def _frame(_: Page, axis: Any, table: Table, frame: str) -> None:
    """Draws atoms and bonds, box and walls, on the same scale in all frames."""
    what, frames, kinds = (texts(table, name) for name in ("what", "frame", "kind"))
    x, up, to_x, to_up, size = (numbers(table, name) for name in ("x_nm", "up_nm", "to_x_nm", "to_up_nm", "size_nm"))
    lines = {"box": ("#999999", 0.6), "bond": ("#555555", 0.7), "wall": ("#D55E00", 1.6)}
    from matplotlib.collections import EllipseCollection, LineCollection

    for kind, (colour, width) in lines.items():
        of = (frames == frame) & (what == kind)
        ends = np.stack([np.column_stack([x[of], up[of]]), np.column_stack([to_x[of], to_up[of]])], 1)
        axis.add_collection(LineCollection(list(ends), colors=colour, linewidths=width, zorder=1))
    of = (frames == frame) & (what == "atom")
    number = {kind: n for n, kind in enumerate(each(kinds[what == "atom"]))}
    colours = [KINDS.get(kind[:1], HUES[number[kind] % len(HUES)]) if number[kind] or kind[:1] in KINDS else "#56B4E9"
               for kind in kinds[of]]
    axis.add_collection(EllipseCollection(0.6 * size[of], 0.6 * size[of], np.zeros(of.sum()), units="xy", facecolors=colours,
                                          edgecolors="#222222", linewidths=0.2, offsets=np.column_stack([x[of], up[of]]),
                                          offset_transform=axis.transData, zorder=2))
    atoms = what == "atom"
    across = np.concatenate([x[atoms] - 0.3 * size[atoms], x[atoms] + 0.3 * size[atoms], x[~atoms], to_x[~atoms]])
    along = np.concatenate([up[atoms] - 0.3 * size[atoms], up[atoms] + 0.3 * size[atoms], up[~atoms], to_up[~atoms]])
    for values, set_limits in ((across, axis.set_xlim), (along, axis.set_ylim)):
        margin = 0.02 * max(np.ptp(values), 1e-3)
        set_limits(values.min() - margin, values.max() + margin)
    axis.set(aspect="equal", xlabel="x [nm]")
    axis.grid(False)


def log_tables(log: Mapping[str, Any], measure: Any) -> Dict[str, Table]:
    """Returns the tables of a log's picture: each column in time, its mean from where the energy is equilibrated."""
    t, potential = np.asarray(log["time_ps"], float), np.asarray(log["potential_kj_mol"], float)
    heat = np.nan_to_num(np.asarray(log.get("heat_kj_mol", np.zeros(len(t))), float))
    account = np.asarray(log["total_kj_mol"], float) - heat
    panels = [("potential energy [kJ/mol]", "", potential, True),
              ("energy's account [kJ/mol]", "energy but for the heat", account - account[:1], False),
              ("energy's account [kJ/mol]", "what the bonds did", np.asarray(log["constraint_work_kj_mol"], float), False),
              ("temperature [K]", "", log["temperature_k"], True), ("pressure [bar]", "", log["pressure_bar"], True),
              ("relative bond error", "largest", log["max_rel_bond_error"], False),
              ("relative bond error", "rms", log["rms_rel_bond_error"], False)]
    rows: Dict[str, List[Any]] = {name: [] for name in ("panel", "curve", "t_ps", "value", "running_mean")}
    means: Dict[str, List[Any]] = {name: [] for name in ("panel", "curve", "from_ps", "to_ps", "value", "standard_error")}
    begin = measure.equilibration(potential) if len(t) > 20 else 0
    for panel, curve, values, averaged in panels:
        y = np.asarray(values, float)
        there = np.isfinite(y)
        if not there.any():
            continue
        mean = np.full(len(y), np.nan)
        if averaged:
            mean[begin:] = np.nancumsum(y[begin:]) / np.maximum(np.cumsum(there[begin:]), 1)
            if there[begin:].sum() > 20:
                of_part = measure.mean(y[begin:][there[begin:]])
                for name, cell in zip(means, (panel, curve, t[begin], t[-1], of_part.value, of_part.error)):
                    means[name].append(cell)
        columns: List[Any] = [[panel] * len(y), [curve] * len(y), t, y, mean]
        for name, column in zip(rows, columns):
            rows[name].extend(column)
    return {"run": {name: np.array(column, object if name in ("panel", "curve") else float) for name, column in rows.items()},
            "means": means}
