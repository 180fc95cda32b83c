#!/usr/bin/env python3
"""Draws the pictures of systems/worlds, benchmarks/results/worlds/NAME.svg, in a minute:
PYTHONPATH=build/python benchmarks/worlds.py [build folder, default build]"""

import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from taut.pictures import save, styled, table_of
from taut.pictures.page import Page
from taut.pictures.style import limit

RESULTS = pathlib.Path(__file__).resolve().parent / "results" / "worlds"
ORANGE, BLUE, SKY, GREEN, GREY, BLACK = "#D55E00", "#0072B2", "#56B4E9", "#009E73", "#777777", "#000000"
# Of each picture its panels: title, x, least and most of a logarithmic y or none, and its curves: column, colour, dashes or a mark, name.
WORLDS = {
    "knee": ("t [s]", [
        ("ligaments off by at most [mm]", (1e-15, 100), [("none_mm", GREY, ":", "none"),
         ("physical_mm", ORANGE, "--", "α = β = √(k/I)"), ("calibrated_mm", BLUE, "-", "calibrated: αh = 0.3, (βh)² = 2.5")]),
        ("energy [J]", None, [("none_energy", GREY, ":", "none"), ("physical_energy", ORANGE, "--", "α = β = √(k/I)"),
                              ("calibrated_energy", BLUE, "-", "calibrated")])]),
    "planted_foot": ("t [s]", [
        ("the foot slides by [mm]", None, [("none_mm", GREY, "o", "none: bare accelerations"),
         ("foretold_mm", BLACK, "-", "foretold: σ₊ − 2σ + σ₋ = ¼h⁴|a|²"), ("baumgarte_mm", BLUE, "--", "baumgarte")]),
        ("reaction [N]", None, [("closed_form_n", BLACK, "-", "m(g cos θ − v²/L)"), ("reaction_n", BLUE, "o", "along the leg")])]),
    "fold": ("t [ps]", [
        ("nearest layers [thicknesses]", None, [("without", GREY, ":", "no struts"),
         ("none", ORANGE, "--", "struts without a corrective term"), ("baumgarte", SKY, "-", "baumgarte"),
         ("rattle", BLACK, (0, (5, 2, 1, 2)), "rattle")])]),
    "double_pendulum": ("t [ps]", [
        ("energy given [kJ/mol]", None,
         [(f"implicit_{ah}", colour, "o", f"implicit, αh = {ah}") for ah, colour in (("0.1", SKY), ("0.3", BLUE), ("1", ORANGE))] +
         [(f"foretold_{ah}", BLACK, "-", "") for ah in ("0.1", "0.3", "1")] + [("centred", GREEN, "--", "centred")])]),
    "flow": ("step", [
        ("rms divergence, pressure to 1e-3 by conjugate gradients", (1e-9, 1e-2), [("bare", GREY, ":", "bare: D u̇ = 0"),
         ("baumgarte", BLUE, "-", "baumgarte, dead-beat"), ("projection", GREEN, "--", "projection, a second solve")]),
        ("rms divergence, put in at the start", (1e-12, 1), [("put_in_weak", ORANGE, "o", "αh = 0.05, βh = 0.2"),
         ("foretold_weak", BLACK, "-", ""), ("put_in_strong", BLUE, "s", "αh = 0.3, (βh)² = 2.5"), ("foretold_strong", BLACK, "-", "")])]),
}


def draw(name, table):
    x_name, panels = WORLDS[name]
    x = next(iter(table.values()))
    page = Page(len(panels), 170, columns=1, height_mm=60)
    for axis, (title, log, curves) in zip(page.axes, panels):
        names = []
        for column, colour, look, words in curves:
            y = table[column] - (table["discrete"] if name == "double_pendulum" and "foretold" not in column else 0)
            some = slice(None, None, 6) if look in ("o", "s") else slice(None)
            axis.plot(x[some], y[some], color=colour, **({"marker": look, "ls": "none", "fillstyle": "none", "ms": 3}
                                                         if look in ("o", "s") else {"ls": look}))
            shown = np.flatnonzero((y >= log[0]) & (y <= log[1])) if log else np.flatnonzero(np.isfinite(y))
            if words and len(shown):
                names.append((x[shown[-1]], y[shown[-1]], words, colour))
        if log:
            limit(axis, "y", np.concatenate([table[column][table[column] > log[0]] for column, *_ in curves]), log=True)
        axis.set_xlim(x[0], x[-1])
        axis.set_title(title)
        page.name_ends(axis, names)
    if name == "fold":
        page.axes[0].set_ylim(-8, 16)
        page.axes[0].axhline(1, color=BLACK, lw=0.6, ls=":")
    page.axes[-1].set_xlabel(x_name)
    save(page.finish(), RESULTS / name, "svg")


def main():
    with tempfile.TemporaryDirectory() as folder, styled():
        subprocess.run([pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else "build") / "worlds", folder], check=True)
        for name in WORLDS:
            draw(name, table_of((pathlib.Path(folder) / f"{name}.csv").read_text()))


main()
