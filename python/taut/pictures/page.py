"""A picture's page: panels in rows, and the names of curves, which stand beside them and not upon each other."""

from __future__ import annotations

from typing import Any, Dict, List, Optional, Sequence, Tuple

import numpy as np

from . import style

LETTERS = 7  # size of names and values [pt]


class Page:
    """A figure with so many panels, filled from left to right: ``columns`` beside each other, ``narrow`` or half as many
    where the picture is 85 mm wide. ``heights`` are those of the rows beside ``height_mm``."""

    def __init__(self, panels: int, width_mm: int = 170, *, columns: int = 3, narrow: int = 0, height_mm: float = 45,
                 title: str = "", heights: Sequence[float] = (), **shared: Any) -> None:
        self.narrow = width_mm < 100
        self.columns = min(panels, (narrow or max(1, columns // 2)) if self.narrow else columns)
        self.rows = -(-panels // self.columns)
        heights = [*heights, *[1.0] * self.rows][:self.rows]
        height = min(sum(heights) * height_mm + (6 if title else 0), style.HEIGHT_MM)
        plots = style.pyplot()
        self.figure = plots.figure(figsize=(width_mm / style.INCH, height / style.INCH), layout="constrained")
        self.figure.get_layout_engine().set(w_pad=0.02, h_pad=0.03, wspace=0.02, hspace=0.02)
        all_axes = self.figure.subplots(self.rows, self.columns, squeeze=False, gridspec_kw={"height_ratios": heights}, **shared).ravel()
        self.axes: List[Any] = list(all_axes[:panels])
        for unused in all_axes[panels:]:
            unused.remove()
        if title:
            self.figure.suptitle(plain(title), x=0.01, ha="left")
        self.unnamed = True  # no panel has named the runs yet, which have one look in all
        self._at_ends: List[Tuple[Any, List[Any]]] = []
        self._near: List[Tuple[Any, List[Tuple[Any, Any, str, str]]]] = []
        import matplotlib

        if "inline" in matplotlib.get_backend():  # a notebook shows open figures when a cell ends, and what the cell returns
            plots.close(self.figure)

    def name_ends(self, axis: Any, curves: Sequence[Tuple[float, float, str, str]]) -> None:
        """Names curves in the margin to the right: x and y of each one's end, its name and colour."""
        named = [axis.annotate(plain(name), (x, y), (1.03, 0.5), textcoords="axes fraction", va="center", fontsize=LETTERS,
                               color=style.ink(colour), annotation_clip=False,
                               arrowprops={"arrowstyle": "-", "lw": 0.4, "color": colour, "shrinkA": 0, "shrinkB": 1,
                                           "relpos": (0, 0.5)})
                 for x, y, name, colour in curves if np.isfinite(x) and np.isfinite(y)]
        self._at_ends.append((axis, named))

    def name_points(self, axis: Any, labels: Sequence[Tuple[Any, Any, str, str]]) -> None:
        """Writes texts beside one of their points: x and y of the points where each may stand, its text and colour."""
        self._near.append((axis, list(labels)))

    def finish(self) -> Any:
        """Lays out the page, places the names, and returns the figure."""
        self.figure.draw_without_rendering()
        for axis, named in self._at_ends:
            _spread(axis, named)
        for axis in style.each(axis for axis, _ in self._near):
            labels = [label for where, labels in self._near if where is axis for label in labels]
            _place(axis, sorted(labels, key=lambda label: np.size(label[0])))  # first those with the least choice
        self.figure.set_layout_engine("none")
        return self.figure


def plain(text: str) -> str:
    """Returns a text of which matplotlib takes nothing for mathematics."""
    return text.replace("$", r"\$")


def _spread(axis: Any, named: Sequence[Any]) -> None:
    """Moves names up and down until none is upon another, each as near to its curve's end as it can be."""
    height = axis.get_window_extent().height * 72 / axis.figure.dpi
    gap = 1.25 * LETTERS / height
    within = axis.transData.transform([label.xy for label in named]) if named else []
    wanted = axis.transAxes.inverted().transform(within)[:, 1] if named else []
    order = np.argsort(wanted)
    low, high = 0.4 * gap, 1 - 0.4 * gap
    places: List[float] = []
    for k in order:
        low = max(low, min(wanted[k], high))
        places.append(low)
        low += gap
    for n in reversed(range(len(places))):
        places[n] = min(places[n], high)
        high = places[n] - gap
    for k, place in zip(order, places):
        named[k].set_position((1.03, place))


def _place(axis: Any, labels: Sequence[Tuple[Any, Any, str, str]]) -> None:
    """Writes each text where it hides the fewest points and lines, and no other text."""
    figure = axis.figure
    scale = figure.dpi / 72
    frame = axis.get_window_extent()
    hidden = _pixels(axis)
    boxes: List[Tuple[float, float, float, float]] = []
    renderer = figure.canvas.get_renderer() if hasattr(figure.canvas, "get_renderer") else figure._get_renderer()
    for x, y, text, colour in labels:
        points = axis.transData.transform(np.column_stack([np.atleast_1d(x), np.atleast_1d(y)]))
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            continue
        written = axis.text(0, 0, plain(text), fontsize=LETTERS, color=style.ink(colour), transform=None, zorder=4,
                            bbox={"facecolor": "white", "alpha": 0.6, "pad": 0.3, "linewidth": 0})
        extent = written.get_window_extent(renderer)
        wide, high = extent.width, 0.8 * extent.height
        best: Optional[Tuple[float, Any]] = None
        for inner, point in enumerate(points):
            for across, up, gap in [(0, -0.5, 4), (-1, -0.5, 4)] + [(a, u, g) for g in (4, 9, 15, 25, 35, 50) for a in (0, -0.5, -1) for u in (0, -1)]:
                corner = point + scale * gap * np.array([2 * across + 1, 2 * up + 1]) + [across * wide, up * high]
                cost = _cost(corner, wide, high, frame, hidden, boxes) + gap / 2 + (0 if inner in (0, len(points) - 1) else 3)
                if best is None or cost < best[0]:
                    best = cost, corner
        assert best is not None
        corner = best[1]
        boxes.append((corner[0], corner[1], corner[0] + wide, corner[1] + high))
        written.set(x=0, y=0, va="baseline", transform=axis.transAxes)
        written.set_position(axis.transAxes.inverted().transform(corner + [0, 0.1 * high]))


def _pixels(axis: Any) -> Any:
    """Returns points along all lines and marks of a panel, in pixels."""
    found = [np.empty((0, 2))]
    for line in axis.lines:
        points = np.asarray(line.get_xydata(), float)
        points = axis.transData.transform(points[np.isfinite(points).all(axis=1)])
        found.append(np.repeat(points, 3, axis=0))  # a mark counts more than the line to it
        if line.get_linestyle() not in ("None", "none", "") and 1 < len(points) < 200:
            found += [points[:-1] + share * np.diff(points, axis=0) for share in np.linspace(0.05, 0.95, 15)]
    for bars in axis.collections:
        for ends in bars.get_segments() if hasattr(bars, "get_segments") else []:
            if len(ends) > 1:
                found.append(axis.transData.transform(ends[0] + np.linspace(0, 1, 12)[:, None] * (ends[-1] - ends[0])))
    return np.concatenate(found)


def _cost(corner: Any, wide: float, high: float, frame: Any, hidden: Any, boxes: Sequence[Any]) -> float:
    left, low, right, top = corner[0], corner[1], corner[0] + wide, corner[1] + high
    outside = max(0.0, frame.x0 - left) + max(0.0, right - frame.x1) + max(0.0, frame.y0 - low) + max(0.0, top - frame.y1)
    inside = ((hidden[:, 0] > left - 1) & (hidden[:, 0] < right + 1) & (hidden[:, 1] > low - 1) & (hidden[:, 1] < top + 1))
    upon = sum(left < b[2] and right > b[0] and low < b[3] and top > b[1] for b in boxes)
    return float(100 * outside + inside.sum() + 1000 * upon)


def line_of(curve: Dict[str, Any], **changes: Any) -> Dict[str, Any]:
    """Returns the look of a curve without its marks."""
    return {key: value for key, value in {**curve, **changes}.items() if key not in ("marker", "fillstyle")}
