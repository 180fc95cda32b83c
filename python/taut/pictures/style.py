"""How all pictures look: their width, letters, colours, marks, axes, and the files that they are written to."""

from __future__ import annotations

import csv
import io
import re
from pathlib import Path
from typing import Any, Dict, Iterable, List, Mapping, Sequence, Tuple, Union

import numpy as np

WIDTHS_MM = (85, 170)  #: a column of a journal, and its page
HEIGHT_MM = 230  #: of a page: no picture is higher
MOST = 6  #: curves of a panel
INCH = 25.4

STYLE = {
    "font.family": "DejaVu Sans", "font.size": 8, "axes.titlesize": 8, "axes.labelsize": 8, "xtick.labelsize": 7,
    "ytick.labelsize": 7, "legend.fontsize": 7, "figure.titlesize": 8, "axes.titlelocation": "left",
    "axes.linewidth": 0.6, "xtick.major.width": 0.6, "ytick.major.width": 0.6, "xtick.minor.width": 0.4,
    "ytick.minor.width": 0.4, "xtick.major.size": 3, "ytick.major.size": 3, "lines.linewidth": 1.0,
    "lines.markersize": 3.5, "lines.markeredgewidth": 0.7, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.formatter.useoffset": False, "axes.axisbelow": True, "grid.color": "#dddddd", "grid.linewidth": 0.4, "errorbar.capsize": 1.5,
    "svg.fonttype": "none", "svg.hashsalt": "taut", "pdf.fonttype": 42, "savefig.dpi": 300, "figure.dpi": 150}

#: Okabe and Ito's colours, which the colour-blind tell apart too. Marks and dashes do so in grey.
HUES = ("#0072B2", "#E69F00", "#000000", "#CC79A7", "#009E73", "#56B4E9", "#D55E00", "#8C564B")
MARKS = ("o", "s", "^", "D", "v", "P", "X", "<")
DASHES: Tuple[Any, ...] = ("-", (0, (5, 1.5)), (0, (1, 1)), (0, (6, 1.5, 1, 1.5)), (0, (3, 1)), (0, (8, 2, 1, 1, 1, 2)))
METHODS = {"baumgarte": ("#D55E00", "o"), "feedforward": ("#000000", "s"), "shake": ("#56B4E9", "^"),
           "rattle": ("#0072B2", "v"), "newton": ("#009E73", "D"), "mshake": ("#9ACD32", "P"),
           "lincs": ("#CC79A7", "X"), "settle": ("#E69F00", "<"), "penalty": ("#8C564B", ">"), "none": ("#999999", "h")}

Table = Any  #: columns by their names: a dict of arrays, or a pandas.DataFrame


class Refused(ValueError):
    """What is asked for is not there."""


class NothingToDraw(Exception):
    """No row of a table can be drawn."""


def pyplot() -> Any:
    """Returns matplotlib's pyplot. Raises ImportError that says what is missing."""
    try:
        import matplotlib
        from matplotlib import pyplot as found
    except ImportError:
        raise ImportError("pictures need matplotlib: pip install matplotlib (Debian: python3-matplotlib)") from None
    if tuple(int(part) for part in matplotlib.__version__.split(".")[:2]) < (3, 6):
        raise ImportError(f"pictures need matplotlib 3.6 or later, here is {matplotlib.__version__}: "
                          "pip install -U matplotlib")
    return found


def styled() -> Any:
    """A context in which matplotlib has the style of these pictures, whatever the user's own is."""
    pyplot()
    from matplotlib import style

    return style.context(["default", STYLE])


# ---- Tables

def table_of(text: str) -> Dict[str, Any]:
    """Returns the columns of a CSV text with a line of names: numbers, or texts where one is none. An empty cell is nan."""
    rows = list(csv.reader(io.StringIO(text)))
    return {name: _column([row[n] for row in rows[1:]]) for n, name in enumerate(rows[0] if rows else [])}


def _column(cells: List[str]) -> Any:
    try:
        return np.array([float(cell) if cell else np.nan for cell in cells])
    except ValueError:
        return np.array(cells, dtype=str)


def texts(table: Table, name: str) -> Any:
    """Returns a column as texts: of a number its shortest."""
    return np.array([cell if isinstance(cell, str) else "" if cell != cell else f"{cell:g}"
                     for cell in np.asarray(table[name]).tolist()], dtype=object)


def numbers(table: Table, name: str) -> Any:
    """Returns a column as numbers; nan where the cell is none, or the column is absent."""
    if name not in table:
        return np.full(len(table[next(iter(table))]), np.nan)
    found = np.asarray(table[name])
    return found.astype(float) if found.dtype.kind in "fiub" else np.array([_number(cell) for cell in found.tolist()])


def _number(cell: Any) -> float:
    try:
        return float(cell)
    except (TypeError, ValueError):
        return float("nan")


def each(values: Iterable[Any]) -> List[Any]:
    """Returns the values in their order, each once."""
    return list(dict.fromkeys(values))


# ---- Curves

def look(method: str, number: int = 0) -> Dict[str, Any]:
    """Returns colour, mark and dashes of the number-th curve of a method; of other names those of the number."""
    colour, mark = METHODS.get(method, (HUES[number % len(HUES)], MARKS[number % len(MARKS)]))
    return {"color": colour, "marker": mark, "linestyle": DASHES[number % len(DASHES)],
            "fillstyle": "none" if number and method in METHODS else "full"}


def looks_of(names: Sequence[str], methods: Mapping[str, str]) -> Dict[str, Dict[str, Any]]:
    """Returns the looks of curves in one panel: a method's own colour where no other curve there has it."""
    found: Dict[str, Dict[str, Any]] = {}
    for n, name in enumerate(names):
        taken = {curve["color"] for curve in found.values()}
        own = METHODS.get(methods[name], ("", ""))[0]
        free = [hue for hue in (own, *HUES) if hue and hue not in taken]
        found[name] = {**look(methods[name]), "color": (free or HUES)[0], "linestyle": DASHES[n % len(DASHES)]}
    return found


def shade(colour: str, share: float) -> str:
    """Returns the colour mixed with white, or where the share is below 0 with black."""
    parts, to = [int(colour[k:k + 2], 16) for k in (1, 3, 5)], 255 if share > 0 else 0
    return "#" + "".join(f"{round(part + (to - part) * abs(share)):02x}" for part in parts)


def ink(colour: str) -> str:
    """Returns the colour as letters have it: dark enough to be read in grey, too."""
    red, green, blue = (int(colour[k:k + 2], 16) / 255 for k in (1, 3, 5))
    return shade(colour, -min(0.6, max(0.0, 1.4 * (0.3 * red + 0.59 * green + 0.11 * blue - 0.38))))


def groups_of(curves: Sequence[str], methods: Mapping[str, str]) -> List[List[str]]:
    """Returns the curves in groups of at most six, a panel each, much alike in size; those of a method stay together where
    they can."""
    count = -(-len(curves) // MOST)
    groups: List[List[str]]
    while True:
        size, groups = -(-len(curves) // count), [[]]
        for method in each(methods[curve] for curve in curves):
            own = [curve for curve in curves if methods[curve] == method]
            if groups[-1] and len(groups[-1]) + len(own) > max(size, len(own) if len(groups[-1]) < size / 2 else 0):
                groups.append([])
            for curve in own:
                if len(groups[-1]) == MOST:
                    groups.append([])
                groups[-1].append(curve)
        if len(groups) <= count + 1 or count >= len(curves):
            return groups
        count += 1


# ---- Axes

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def power(value: float) -> str:
    """Returns 10 to a power as it is written, other numbers in short: "10⁻⁶", "0.5"."""
    exponent = np.log10(value) if value > 0 else 0.5
    if abs(exponent - round(exponent)) < 1e-9 and not -3 < exponent < 4:
        return "10" + str(round(exponent)).translate(RAISED)
    if value > 0 and not 1e-3 <= value < 1e5:
        return f"{value / 10.0**np.floor(exponent):.3g}·" + power(10.0**np.floor(exponent))
    return f"{value:g}"


def with_error(value: float, error: float) -> str:
    """Returns a number as far as its error goes: "300.8 ± 1.7"."""
    if not 0 < error < np.inf:
        return f"{value:.6g}"
    digits = max(0, 1 - int(np.floor(np.log10(error))))
    return f"{value:.{digits}f} ± {error:.{digits}f}".replace("-", "−")


def logarithmic(axis: Any, which: str, sparse: bool = False) -> None:
    """Gives an axis ("x" or "y") powers of ten, or where it spans few and is not to be sparse 1, 2 and 5 times these."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    getattr(axis, f"set_{which}scale")("log")
    low, high = getattr(axis, f"get_{which}lim")()
    few = np.log10(high / low) < 2.2 and not sparse
    along = getattr(axis, f"{which}axis")
    along.set_major_locator(LogLocator(10, subs=(1, 2, 5) if few else (1,), numticks=7))
    along.set_major_formatter(FuncFormatter(lambda value, _: power(value)))
    along.set_minor_formatter(NullFormatter())


def limit(axis: Any, which: str, values: Any, log: bool = False) -> None:
    """Sets an axis to the range of most values: what one row in fifty has alone, a start or a run that broke, is left out
    where it would take most of the room."""
    values = np.asarray(values, float).ravel()
    values = values[np.isfinite(values) & ((values > 0) if log else True)]
    if not len(values):
        return
    values = np.log10(values) if log else values
    inner, outer = np.percentile(values, (2, 98)), (values.min(), values.max())
    room = max(inner[1] - inner[0], 1e-9 * abs(inner[0]), 1e-300)
    low, high = (outer[0] if inner[0] - outer[0] < room else inner[0]), (outer[1] if outer[1] - inner[1] < room else inner[1])
    margin = max(0.06 * (high - low), (0.7 - high + low) / 2) if log else 0.06 * (high - low) or 0.05 * abs(high) or 1.0
    low, high = low - margin, high + margin
    getattr(axis, f"set_{which}lim")(*((10.0**low, 10.0**high) if log else (low, high)))
    if log:
        logarithmic(axis, which)


# ---- Files

def save(figure: Any, path: Union[str, Path], formats: Union[str, Sequence[str]] = "png") -> List[str]:
    """Writes a figure for print as PATH.FORMAT: "pdf", "svg", and "png" of 300 dots an inch. Returns the files' names.

    ``formats``: one, several with commas between them, or a list
    """
    wanted = formats.split(",") if isinstance(formats, str) else list(formats)
    with styled():
        for kind in wanted:
            dates = {"Date": None} if kind == "svg" else {"CreationDate": None} if kind == "pdf" else {}
            figure.savefig(f"{path}.{kind}", metadata=dates)
            if kind == "svg":  # a path is a line, so that the picture's changes are few
                file = Path(f"{path}.svg")
                file.write_text(re.sub(r' ?\n(?=[LCQMz]\b|")', " ", file.read_text(encoding="utf-8")), encoding="utf-8")
    return [f"{Path(path).name}.{kind}" for kind in wanted]
