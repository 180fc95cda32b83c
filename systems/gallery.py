#!/usr/bin/env python3
"""Draws systems/gallery/NAME.png of every scene, from its start: PYTHONPATH=build/python systems/gallery.py [NAME ...]

Atoms and rigid bonds; of scenes that say their atoms one by one also anchors (squares), springs (dotted), struts and ropes
(dashed), constant forces (arrows).
"""

import pathlib
import sys
import tomllib

import numpy as np

import taut
from taut.pictures.style import pyplot, shade, styled

HERE = pathlib.Path(__file__).parent
COLOUR = {"O": "#D55E00", "H": "#BBBBBB", "C": "#444444", "N": "#0072B2", "FE": "#E69F00"}
BEAD = "#0072B2"
KEPT = {"springs": ((0, (1, 1.5)), "#999999"), "at_least": ((0, (4, 2)), "#009E73"), "at_most": ((0, (4, 2)), "#CC79A7")}
CLOSE = {"knee": ((0.002, -0.012), 0.032)}  # what is too small to be seen in the whole: middle and half width [nm]


def turn_of(atoms):
    """The rotation by which a scene is seen: flat things from the front, others a little from above and from the side."""
    wide, deep = np.ptp(atoms[:, :2], axis=0).max(), np.ptp(atoms[:, 2])
    if deep < 0.02 * wide:
        return np.eye(3)
    cy, sy, cx, sx = np.cos(0.5), np.sin(0.5), np.cos(0.45), np.sin(0.45)
    return np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]]) @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])


def draw(scene):
    sim = taut.Simulation(str(scene), method="newton")
    build = tomllib.loads(scene.read_text()).get("build", {})
    turn = turn_of(sim.positions)
    at = sim.positions @ turn.T
    pulls = build.get("pulls", [])
    middle, half = (at.max(0) + at.min(0))[:2] / 2, (0.7 if pulls else 0.56) * np.ptp(at[:, :2], axis=0).max() or 0.1
    middle, half = CLOSE.get(scene.stem, (middle, half))
    point = min(9.0, max(1.2, 24 / np.sqrt(len(at))))
    figure = pyplot().figure(figsize=(0.8, 0.8))
    axis = figure.add_axes((0, 0, 1, 1), xlim=(middle[0] - half, middle[0] + half), ylim=(middle[1] - half, middle[1] + half))
    axis.axis("off")
    kept = {tuple(row[:2]) for name in ("at_least", "at_most") for row in build.get(name, [])}
    pairs = {name: [row[:2] for row in build.get(name, [])] for name in KEPT}
    pairs["bonds"] = [tuple(bond) for bond in sim.bonds.tolist() if tuple(bond) not in kept]
    for name, (dashes, colour) in {**KEPT, "bonds": ("-", "#888888")}.items():
        for i, j in pairs[name]:
            axis.plot(*at[[i, j], :2].T, color=colour, ls=dashes, lw=0.4 + point / 4 if name == "bonds" else 0.6, zorder=1)
    order = np.argsort(at[:, 2])
    kinds = [element or (name[:1] if name[:1] in "OHCN" else "") for element, name in zip(sim.names["element"], sim.names["atom"])]
    pale = 0.55 * (at[:, 2].max() - at[:, 2]) / max(np.ptp(at[:, 2]), 1e-9)
    for marker, anchored in (("o", False), ("s", True)):
        of = [a for a in order if (bool(build.get("atoms")) and sim.masses[a] == 0) == anchored]
        axis.scatter(at[of, 0], at[of, 1], [(point * (0.7 if kinds[a] == "H" else 1)) ** 2 for a in of], marker=marker, lw=0, zorder=2,
                     c=["#000000" if anchored else shade(COLOUR.get(kinds[a].upper(), BEAD), pale[a]) for a in of])
    if pulls:
        feet, forces = at[[int(row[0]) for row in pulls]], np.array([row[1:] for row in pulls]) @ turn.T
        forces *= 0.22 * half / np.linalg.norm(forces, axis=1).max()
        axis.quiver(*feet[:, :2].T, *forces[:, :2].T, angles="xy", scale_units="xy", scale=1, width=0.012, color="#D55E00", zorder=3)
    figure.savefig(HERE / "gallery" / f"{scene.stem}.png")
    pyplot().close(figure)


def main():
    with styled():
        for scene in sorted([*HERE.glob("*.toml"), *HERE.glob("hard/*.toml"), *HERE.glob("worlds/*.toml")]):
            if not scene.stem.endswith(".start") and (len(sys.argv) == 1 or scene.stem in sys.argv):
                draw(scene)
                print(scene.stem)


main()
