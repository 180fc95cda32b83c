"""The pictures of `taut stability`: where methods fail."""

from __future__ import annotations

from typing import Any, List, Mapping

import numpy as np

from .page import LETTERS, Page, plain
from .style import Table, each, logarithmic, numbers, texts

DAMPINGS = ("discrete", "centred", "implicit", "lagged")


def _edges(values: Any, log: bool = False) -> Any:
    """Returns the borders of cells whose middles are these."""
    at = np.log(values) if log else np.asarray(values, float)
    steps = np.diff(at) if len(at) > 1 else np.array([1.0])
    edges = np.concatenate([[at[0] - steps[0] / 2], at[:-1] + np.diff(at) / 2, [at[-1] + steps[-1] / 2]])
    return np.exp(edges) if log else edges


def plane(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """Baumgarte over its gains, light where it is good: above the steps survived, below the drift, × where it failed."""
    from matplotlib import cm, colors

    table, limits = tables["plane"], tables.get("limits")
    damping, failed = texts(table, "damping"), numbers(table, "failed") == 1
    ah, bh = numbers(table, "alpha_h"), numbers(table, "beta_h")
    survived, drift = numbers(table, "steps_survived"), abs(numbers(table, "drift_kj_mol_ns_dof"))
    seen = [name for name in DAMPINGS if name in set(damping)] or each(damping)
    page = Page(2 * len(seen), width_mm, columns=len(seen), narrow=min(2, len(seen)), height_mm=48, title=title,
                sharex=True, sharey=True)
    whole = ~failed & (drift > 0)
    least, most = (drift[whole].min(), drift[whole].max()) if whole.any() else (0.1, 1.0)
    scales = (colors.LogNorm(1, max(numbers(table, "of_steps").max(), 2)), colors.LogNorm(least, max(most, 1.01 * least)))
    for row, (values, shown, maps) in enumerate([(np.maximum(survived, 1), np.ones(len(ah), bool), "gray"),
                                                 (drift, whole, "cividis_r")]):
        for axis, name in zip(page.axes[row * len(seen):], seen):
            of = damping == name
            across, up = np.unique(ah[of]), np.unique(bh[of])
            grid = np.full((len(up), len(across)), np.nan)
            chosen = of & shown & np.isfinite(values)
            grid[np.searchsorted(up, bh[chosen]), np.searchsorted(across, ah[chosen])] = values[chosen]
            axis.pcolormesh(_edges(across, log=True), _edges(up), grid, norm=scales[row], cmap=maps)
            if row == 1:
                axis.plot(ah[of & failed], bh[of & failed], "x", color="#777777", markersize=2.5)
            if limits is not None and "damping" in limits:
                edge = texts(limits, "damping") == name
                x, y = numbers(limits, "alpha_h")[edge], numbers(limits, "limit_beta_h")[edge]
                axis.plot(x, y, color="#D55E00", lw=1.2, ls=(0, (4, 1.5)))
            axis.grid(False)
            axis.set_xlim(*_edges(across, log=True)[[0, -1]])
            axis.set_ylim(*_edges(up)[[0, -1]])
            logarithmic(axis, "x", sparse=True)
            axis.set_title(f"{name} damping" if row == 0 or page.narrow else "", fontsize=LETTERS + 0.5)
            axis.set_xlabel("αh" if row == 1 or page.narrow else "")
            axis.set_ylabel("βh" if name == seen[0] or page.narrow else "")
        bar = page.figure.colorbar(cm.ScalarMappable(scales[row], maps), ax=page.axes[row * len(seen):(row + 1) * len(seen)],
                                   aspect=12, pad=0.02)
        newton = numbers(table, "newton_drift")
        newton = newton[np.isfinite(newton)]
        bar.set_label("steps survived" if row == 0 else "|drift| [kJ/mol/ns/dof]")
        if row == 1 and len(newton):
            bar.ax.axhline(abs(newton[0]), color="#D55E00", lw=1.2)
    notes = ["dashed: limit of one bond by theory", "×: failed"]
    notes += ["line on the scale: newton"] if np.isfinite(numbers(table, "newton_drift")).any() else []
    page.figure.supxlabel(_wrapped(notes, width_mm), fontsize=LETTERS, x=0.01, ha="left")
    return page.finish()


def steps(tables: Mapping[str, Table], width_mm: int, title: str) -> Any:
    """The largest stable step of each method and scene, and by a letter how the next one fails."""
    table = tables["steps"]
    scenes, methods, reasons = (texts(table, name) for name in ("scene", "method", "fails_as"))
    longest, share = numbers(table, "largest_stable_fs"), numbers(table, "share_of_best")
    rows, columns, ends = each(scenes), each(methods), [reason for reason in each(reasons) if reason]
    flip = width_mm < 100 < 12 * len(columns)
    page = Page(1, width_mm, height_mm=22 + 9 * len(columns if flip else rows) + 4 * -(-len(ends) // (2 if width_mm < 100 else 4)),
                title=title)
    axis = page.axes[0]
    across, down = (rows, columns) if flip else (columns, rows)
    for scene, method, reason, step, best in zip(scenes, methods, reasons, longest, share):
        x, y = (rows.index(scene), columns.index(method)) if flip else (columns.index(method), rows.index(scene))
        grey = 0.62 + 0.38 * np.clip(1 + np.log10(max(best, 1e-3)) / 3, 0, 1) if best == best else 1.0
        axis.add_patch(_cell(x, y, grey))
        axis.text(x, y - 0.12, f"{step:.3g}" if step > 0 else "–", ha="center", va="center", fontsize=8)
        if reason:
            axis.text(x, y + 0.27, chr(ord("a") + ends.index(reason)), ha="center", va="center", fontsize=LETTERS, style="italic")
    axis.set(xlim=(-0.5, len(across) - 0.5), ylim=(len(down) - 0.5, -0.5))
    axis.set_xticks(range(len(across)), [plain(name) for name in across], rotation=40 if page.narrow else 0,
                    ha="left" if page.narrow else "center", rotation_mode="anchor")
    axis.set_yticks(range(len(down)), [plain(name) for name in down])
    axis.tick_params(length=0, top=False, labeltop=True, bottom=False, labelbottom=False)
    axis.grid(False)
    axis.spines[:].set_visible(False)
    page.figure.supxlabel(_wrapped([f"{chr(ord('a') + n)} {plain(reason)}" for n, reason in enumerate(ends)], width_mm),
                          fontsize=LETTERS, x=0.01, ha="left")
    return page.finish()


def _cell(x: float, y: float, grey: float) -> Any:
    from matplotlib.patches import Rectangle

    return Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=(grey,) * 3, edgecolor="#888888", lw=0.4)


def _wrapped(words: List[str], width_mm: int) -> str:
    """Returns words in lines as wide as the page."""
    lines, most = [""], width_mm * 0.72
    for word in words:
        if lines[-1] and len(lines[-1]) + len(word) > most:
            lines.append("")
        lines[-1] += ("   " if lines[-1] else "") + word
    return "\n".join(lines)
