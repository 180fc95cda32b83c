#!/usr/bin/env python3
"""Measure how often torsions are where, over steps and methods: data/torsions.csv.

    docs/study/torsions.py [--systems NAME,...] [--seeds 3] [--jobs 2] [--taut build/taut] [--work FOLDER]

- decane: the share of its inner torsions that are trans, at most 60° from 180°, in the study's bath
- dipeptide-vacuum: alanine dipeptide alone, the share of time in which it is stretched (C5, |ψ| over 110°; else it is
  C7eq), with a friction of 1/ps
Double precision. Rows that are there are not run again. Needs h5py.
"""
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy

import cases
from cases import read_rows
from study import Study, add_rows, options, why_not

cases.SYSTEMS["dipeptide-vacuum"] = cases.of_openmm("alanine dipeptide alone", "dipeptide-vacuum", 5000)
METHODS = {"newton": (0.5, 2, 3, 4, 5), "feedforward": (2, 4, 5), "shake 1e-4": (2,), "lincs strict": (2, 4)}
LENGTH_PS = {"decane": 200, "dipeptide-vacuum": 5000}
SETTLING_PS = {"decane": 20, "dipeptide-vacuum": 100}
FRAME_PS = 0.5
COLUMNS = "system,method,dt_fs,seed,ps,status,share".split(",")


def angles(positions, atoms):
    """The torsions [degrees] of positions (frames, atoms, 3) along the atoms (torsions, 4): (frames, torsions)."""
    a, b, c, d = (positions[:, atoms[:, k]] for k in range(4))
    axis = (c - b) / numpy.linalg.norm(c - b, axis=2, keepdims=True)
    first, last = numpy.cross(b - a, axis), numpy.cross(axis, d - c)
    dot = lambda u, v: numpy.sum(u * v, axis=2)
    return numpy.degrees(numpy.arctan2(dot(numpy.cross(first, last), axis), dot(first, last)))


def share_of(system, positions):
    if system == "decane":
        chains = numpy.arange(positions.shape[1]).reshape(-1, 10)
        atoms = numpy.concatenate([chains[:, k:k + 4] for k in range(7)])
        return numpy.mean(numpy.abs(angles(positions, atoms)) > 120)
    psi = numpy.array([[6, 8, 14, 16]])  # N, CA, C of alanine and the next N
    return numpy.mean(numpy.abs(angles(positions, psi)) > 110)


def measured(study, system, method, dt_fs, seed):
    words, keys = study.of_cell(system, method, dt_fs, "double")
    if system == "dipeptide-vacuum":
        keys = [key for key in keys if not key.startswith("run.thermostat")]
        keys += ["run.thermostat=langevin", "run.friction_per_ps=1"]
    ps = LENGTH_PS[system]
    with tempfile.TemporaryDirectory(dir=study.work) as scratch:
        out = Path(scratch) / "out"
        steps = round(1000 * ps / dt_fs)
        done = subprocess.run([*words, "--steps", str(steps), "--out", str(out), "--set", *keys, f"run.seed={seed}",
                               f"run.log_every={steps // 100}", "run.trajectory=h5md",
                               f"run.trajectory_every={round(1000 * FRAME_PS / dt_fs)}"], capture_output=True, text=True)
        if done.returncode:
            return {"status": why_not(done)}
        with h5py.File(out / "trajectory.h5md") as file:
            frames = next(iter(file["particles"].values()))["position"]["value"][round(SETTLING_PS[system] / FRAME_PS):]
        return {"status": "ok", "ps": ps, "share": float(share_of(system, numpy.asarray(frames, float)))}


def main():
    ask = options(__doc__)
    ask.set_defaults(systems=",".join(LENGTH_PS))
    asked = ask.parse_args()
    if unknown := set(asked.systems.split(",")) - set(LENGTH_PS):
        ask.error(f"no torsions of {min(unknown)}: expected {', '.join(LENGTH_PS)}")
    study = Study(asked.taut, asked.work)
    done = {(row["system"], row["method"], float(row["dt_fs"]), int(row["seed"])) for row in read_rows("torsions.csv")}
    todo = [{"system": system, "method": method, "dt_fs": step, "seed": seed} for seed in range(1, asked.seeds + 1)
            for system in asked.systems.split(",") for method, steps in METHODS.items() for step in steps
            if (system, method, step, seed) not in done]
    add_rows("torsions.csv", COLUMNS, todo, lambda cell: measured(study, **cell), asked.jobs)


if __name__ == "__main__":
    main()
