#!/usr/bin/env python3
"""Draws systems/gallery/NAME.png of every scene, from its start: systems/gallery.py [build/taut [NAME ...]]

Needs gnuplot. Atoms and rigid bonds as `taut run` writes them; of scenes that say their atoms one by one also
anchors (squares), springs (dotted), struts and ropes (dashed), constant forces (arrows).
"""

import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).parent
COLOUR = {"O": "#D55E00", "H": "#BBBBBB", "C": "#444444", "N": "#0072B2", "FE": "#E69F00"}
BEAD = "#0072B2"
CLOSE = {"knee": ((0.02, -0.12), 0.32)}  # what is too small to be seen in the whole: middle and half width [Å]


def start_of(taut, scene):
    """Positions [Å], element or name of each, bonds."""
    with tempfile.TemporaryDirectory() as out:
        command = [taut, "run", scene, "--method", "newton", "--steps", "1", "--out", f"{out}/run"]
        command += ["--set", "run.trajectory_every=1"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode:
            sys.exit(f"{scene}: {done.stdout}")
        atoms, kinds, bonds = [], [], []
        for line in open(f"{out}/run/start.pdb"):
            if line.startswith(("ATOM", "HETATM")):
                atoms.append([float(line[c : c + 8]) for c in (30, 38, 46)])
                kinds.append((line[76:78].strip() or line[12:16].strip()).upper())
            elif line.startswith("CONECT"):
                ends = [int(line[c : c + 5]) - 1 for c in range(6, len(line.rstrip()), 5)]
                bonds += [(ends[0], other) for other in ends[1:] if ends[0] < other]
        return atoms, kinds, bonds


def seen(atoms):
    """On the page, and how near: flat things from the front, others a little from above and from the side."""
    deep = max(a[2] for a in atoms) - min(a[2] for a in atoms)
    wide = max(max(a[d] for a in atoms) - min(a[d] for a in atoms) for d in (0, 1))
    if deep < 0.02 * wide:
        return atoms
    cy, sy, cx, sx = math.cos(0.5), math.sin(0.5), math.cos(0.45), math.sin(0.45)
    turned = [(x * cy + z * sy, y, z * cy - x * sy) for x, y, z in atoms]
    return [(x, y * cx - z * sx, z * cx + y * sx) for x, y, z in turned]


def lines(name, pairs, at):
    rows = [f"{at[i][0]:.3f} {at[i][1]:.3f}\n{at[j][0]:.3f} {at[j][1]:.3f}\n" for i, j in pairs]
    return f"${name} << EOD\n" + "\n".join(rows) + "\nEOD\n"


def draw(taut, scene):
    atoms, kinds, bonds = start_of(taut, scene)
    build = tomllib.load(open(scene, "rb")).get("build", {})
    rows = build.get("atoms", [])
    at = seen(atoms)
    sizes = [max(a[d] for a in at) - min(a[d] for a in at) for d in (0, 1)]
    middle = [(max(a[d] for a in at) + min(a[d] for a in at)) / 2 for d in (0, 1)]
    middle, half = CLOSE.get(pathlib.Path(scene).stem, (middle, (0.7 if build.get("pulls") else 0.56) * max(sizes) or 1))
    point = min(2.2, max(0.35, 6 / math.sqrt(len(at))))
    order = sorted(range(len(at)), key=lambda a: at[a][2])
    near, far = at[order[-1]][2], at[order[0]][2]
    text, plots = "", []
    kept = {"springs": "dt 3 lw 1 lc rgb '#999999'", "at_least": "dt 2 lw 1 lc rgb '#009E73'", "at_most": "dt 2 lw 1 lc rgb '#CC79A7'"}
    for name, style in [*kept.items(), ("bonds", f"lw {1 + point:.1f} lc rgb '#888888'")]:
        pairs = bonds if name == "bonds" else [row[:2] for row in build.get(name, [])]
        if name == "bonds" and rows:
            pairs = [row[:2] for row in build.get("bonds", [])]
        if pairs:
            text += lines(name, pairs, at)
            plots.append(f"${name} using 1:2 with lines {style}")
    pulls = build.get("pulls", [])
    if pulls:
        most = max(math.hypot(*row[1:]) for row in pulls)
        feet = [atoms[int(row[0])] for row in pulls]
        heads = [[a + 0.22 * half * f / most for a, f in zip(foot, row[1:])] for foot, row in zip(feet, pulls)]
        ends = seen([*atoms, *feet, *heads])[len(atoms) :]
        arrows = [f"{x:.3f} {y:.3f} {u - x:.3f} {v - y:.3f}\n" for (x, y, _), (u, v, _) in zip(ends, ends[len(pulls) :])]
        text += f"$pulls << EOD\n{''.join(arrows)}EOD\n"
        plots.append("$pulls using 1:2:3:4 with vectors filled lw 1.5 lc rgb '#D55E00'")
    text += "$atoms << EOD\n"
    for a in order:
        kind = kinds[a] if kinds[a] in COLOUR else ""
        colour = int(COLOUR.get(kind, BEAD)[1:], 16)
        pale = 0.55 * (near - at[a][2]) / (near - far) if near > far else 0
        mixed = sum(int((colour >> s & 255) * (1 - pale) + 255 * pale) << s for s in (16, 8, 0))
        anchor = bool(rows) and rows[a][3] == 0
        size = point * (0.7 if kind == "H" else 1)
        text += f"{at[a][0]:.3f} {at[a][1]:.3f} {size:.2f} {5 if anchor else 7} {0 if anchor else mixed}\n"
    text += "EOD\n"
    plots.append("$atoms using 1:2:3:4:5 with points ps variable pt variable lc rgb variable")
    picture = HERE / "gallery" / (pathlib.Path(scene).stem + ".png")
    text += (
        "set terminal pngcairo size 240,240 background 'white'; unset border; unset tics; unset key; set margins 0,0,0,0\n"
        f"set output '{picture}'\n"
        f"set xrange [{middle[0] - half}:{middle[0] + half}]; set yrange [{middle[1] - half}:{middle[1] + half}]\n"
        f"plot {', '.join(plots)}\n"
    )
    subprocess.run(["gnuplot"], input=text, text=True, check=True)


def main():
    taut, names = (sys.argv[1] if len(sys.argv) > 1 else "build/taut"), sys.argv[2:]
    (HERE / "gallery").mkdir(exist_ok=True)
    for scene in sorted(HERE.glob("*.toml")) + sorted(HERE.glob("hard/*.toml")) + sorted(HERE.glob("worlds/*.toml")):
        if scene.stem.endswith(".start") or (names and scene.stem not in names):
            continue
        draw(taut, str(scene))
        print(scene.stem)


main()
