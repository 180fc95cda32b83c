#!/usr/bin/env python3
"""Compares part by part where a step of a prepared molecule goes: `taut run --timings` beside GROMACS's own accounting.

    GMX=/path/to/gmx benchmarks/step_parts.py FOLDER [--systems dhfr] [--threads 1] [--seconds 5] [--repeats 3]
      [--build build]

FOLDER is real_systems.py's. PME of order 4 at equal α and grid, newton beside LINCS and SETTLE, mixed precision, 2 fs.
GROMACS prunes its lists within its forces, so taut's pruning stands there, too. Prints ms a step, medians, as a Markdown table.
"""
import json
import pathlib
import statistics
import subprocess

import machine
import peer_gromacs
import peer_systems

PARTS = {  # taut's parts, and rows of GROMACS
    "search": (["pair search"], ["Domain decomp.", "Neighbor search"]),
    "pairs, pruning, exclusions, bonded": (["pairs", "list pruning", "exclusions", "bonded"], ["Force"]),
    "mesh": (["mesh spread", "mesh solve", "mesh gather"], ["PME mesh"]),
    "cluster copies": (["cluster copies"], ["NB X/F buffer ops."]),
    "bonds": (["bonds"], ["Constraints"]),
    "kicks, drift": (["kicks, drift"], ["Update"]),
}


def parts_of_taut(taut, prepared, threads, seconds):
    def run(steps):
        command = [taut, "run", "--openmm", prepared.file("system.xml"), prepared.file("state.xml"), "--json", "--timings",
                   "--steps", steps, "--dt-fs", 2, "--precision", "mixed", "--threads", threads, "--set",
                   f"run.log_every={steps}", "forcefield.pme_order=4", f"forcefield.ewald_alpha_per_nm={prepared.alpha}",
                   f"forcefield.pme_grid={list(prepared.mesh)}"]
        return json.loads(subprocess.run(list(map(str, command)), check=True, capture_output=True, text=True).stdout)["timings"]
    table = run(max(20, int(seconds * 1000 / run(20)["ms_per_step"])))
    return {**{name: part["ms_per_step"] for name, part in table["parts"].items()}, "Total": table["ms_per_step"]}


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--systems", default="dhfr")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=5, help="of each run")
    parser.add_argument("--repeats", type=int, default=3, help="in turns; medians are printed")
    told = parser.parse_args()
    gmx = peer_gromacs.engines()[0]
    print(f"{machine.describe()}; {peer_gromacs.version(gmx)}; {told.threads} threads\n")
    print("| ms a step |", " | ".join([*PARTS, "rest", "all"]), "|\n|---" + "|---" * (len(PARTS) + 2) + "|")
    for name in told.systems.split(","):
        prepared = peer_systems.Prepared(name, told.folder)
        seen = {"taut": [], "GROMACS": []}
        for _ in range(told.repeats):
            seen["taut"].append(parts_of_taut(told.build / "taut", prepared, told.threads, told.seconds))
            seen["GROMACS"].append(peer_gromacs.ms_of_parts(gmx, prepared, told.threads, told.seconds))
        for side, (program, runs) in enumerate(seen.items()):
            ms = {row: statistics.median(run[row] for run in runs) for row in runs[0]}
            parts = [sum(ms.get(row, 0) for row in rows[side]) for rows in PARTS.values()]
            print(f"| {name}, {program} |", " | ".join(f"{part:.2f}" for part in [*parts, ms["Total"] - sum(parts), ms["Total"]]), "|")


if __name__ == "__main__":
    main()
