#!/usr/bin/env python3
"""Measure water's diffusion, viscosity and reorientation over steps and methods: data/transport.csv.

    docs/study/transport.py [--seeds 3] [--jobs 2] [--ps 100] [--taut build/taut]

216 TIP3P with PME in mixed precision, in the study's bath, the first 5 ps left out. taut measure gives the diffusion
(in this box) and Green and Kubo's viscosity; tau2 is the integral of ⟨P₂(u(0)·u(t))⟩ of the OH bonds' directions, by the
trapezoid up to 5 ps and by an exponential's tail beyond. Rows that are there are not run again. Needs h5py.
"""
import json
import subprocess
import tempfile
from pathlib import Path

import h5py
import numpy

from cases import read_rows
from study import Study, add_rows, options, temperatures, why_not

SYSTEM, PRECISION, SETTLING_PS, FRAME_PS = "tip3p", "mixed", 5, 0.1
STEPS = {"newton": (0.5, 2, 4, 5), "feedforward": (2, 5), "shake 1e-4": (2,), "lincs": (2,)}
COLUMNS = "method,dt_fs,seed,ps,status,diffusion_nm2_ps,viscosity_mpa_s,tau2_ps,translation_k,rotation_k".split(",")


def reorientation(positions):
    """The time [ps] in which OH bonds forget their direction, of frames (n, atoms, 3) of whole waters."""
    waters = positions.reshape(len(positions), -1, 3, 3)
    u = (waters[:, :, 1:] - waters[:, :, :1]).reshape(len(positions), -1, 3)
    u /= numpy.linalg.norm(u, axis=2, keepdims=True)
    lags = round(5 / FRAME_PS)
    p2 = [numpy.mean(1.5 * numpy.einsum("tnd,tnd->tn", u[:len(u) - lag], u[lag:]) ** 2 - 0.5) for lag in range(lags + 1)]
    decay = -numpy.polyfit(FRAME_PS * numpy.arange(10, 31), numpy.log(p2[10:31]), 1)[0]  # from 1 to 3 ps
    return FRAME_PS * (sum(p2) - 0.5 * (p2[0] + p2[-1])) + p2[-1] / decay


def measured(study, method, dt_fs, seed, ps):
    words, keys = study.of_cell(SYSTEM, method, dt_fs, PRECISION)
    with tempfile.TemporaryDirectory(dir=study.work) as scratch:
        out = Path(scratch) / "out"
        every = max(1, round(8 / dt_fs))  # of the log: 8 fs
        done = subprocess.run([*words, "--steps", str(round(1000 * ps / dt_fs)), "--out", str(out), "--set",
                               *keys, f"run.seed={seed}", f"run.log_every={every}", "run.trajectory=h5md",
                               f"run.trajectory_every={round(1000 * FRAME_PS / dt_fs)}"], capture_output=True, text=True)
        if done.returncode:
            return {"status": why_not(done)}
        told = subprocess.run([study.taut, "measure", str(out), "--from", str(SETTLING_PS), "--json"], check=True,
                              capture_output=True, text=True)
        row = {"status": "ok", "ps": ps} | temperatures(json.loads(done.stdout)["temperatures_k"])
        with h5py.File(out / "trajectory.h5md") as file:
            frames = next(iter(file["particles"].values()))["position"]["value"][round(SETTLING_PS / FRAME_PS):]
        row["tau2_ps"] = float(reorientation(numpy.asarray(frames, float)))
        for column, key in (("diffusion_nm2_ps", "diffusion_nm2_per_ps"), ("viscosity_mpa_s", "viscosity_mpa_s")):
            if key in (seen := json.loads(told.stdout)):  # where the run is long enough for it
                row[column] = seen[key]["value"]
        return row


def main():
    ask = options(__doc__)
    ask.add_argument("--ps", type=float, default=100)
    asked = ask.parse_args()
    study = Study(asked.taut, asked.work)
    done = {(row["method"], float(row["dt_fs"]), int(row["seed"])) for row in read_rows("transport.csv")}
    todo = [{"method": method, "dt_fs": step, "seed": seed} for seed in range(1, asked.seeds + 1)
            for method, steps in STEPS.items() for step in steps if (method, step, seed) not in done]
    add_rows("transport.csv", COLUMNS, todo, lambda cell: measured(study, **cell, ps=asked.ps), asked.jobs)


if __name__ == "__main__":
    main()
