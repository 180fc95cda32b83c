#!/usr/bin/env python3
"""What Python costs beside the command: PYTHONPATH=build/python python3 benchmarks/python_overhead.py [--instructions]

Times a run by the command, by Python, and by Python with a callback every 100 steps, in turns. Then times how much
longer a step takes with a constraint method written in Python: an empty one, and SHAKE of python/examples.

--instructions counts the instructions of the three by valgrind, which a busy machine does not disturb. It subtracts
runs of two lengths, so start and end of a run do not count, and takes some ten minutes.
"""
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # more threads would only wait on matrices this small

import numpy as np

import taut

ROOT = Path(__file__).resolve().parents[1]
STEPS, TURNS = 2000, 9
TAUT = [str(ROOT / "build" / "taut"), "run", "water", "--method", "feedforward", "--set", "run.log_every=100", "--steps"]


def instructions(command):
    counting = ["valgrind", "--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"]
    done = subprocess.run(counting + command, check=True, capture_output=True, text=True,
                          env={**os.environ, "OMP_NUM_THREADS": "1"})
    return int(re.search(r"I +refs: +([\d,]+)", done.stderr).group(1).replace(",", ""))


def compare_instructions(few=200, many=600):
    run = "import sys, taut; taut.Simulation('water', method='feedforward').run(int(sys.argv[1]), every=100, callback={})"
    called, watched = ([sys.executable, "-c", run.format(what)] for what in ("None", "lambda row: row.temperature_k"))
    names = "command", "called from Python", "with a callback every 100 steps"
    each = [(instructions(c + [str(many)]) - instructions(c + [str(few)])) / (many - few) for c in (TAUT, called, watched)]
    for name, count in zip(names, each):
        print(f"{name}: {count:.0f} instructions a step, {100 * (count / each[0] - 1):+.3f} %", flush=True)


def command():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([*TAUT, str(STEPS), "--out", folder + "/run"], check=True, capture_output=True)
        return json.loads((Path(folder) / "run" / "summary.json").read_text())["us_per_step"]


def python(callback=None, method="feedforward", steps=STEPS, dt_fs=2):
    sim = taut.Simulation("water", method=method, dt_fs=dt_fs)
    sim.run(steps, every=100, callback=callback)
    return sim.summary["us_per_step"], sim.summary["constraint_us_per_step"]


def wall(callback):
    sim = taut.Simulation("water", method="feedforward")
    sim.run(100)
    start = time.perf_counter()
    sim.run(STEPS, every=100, callback=callback)
    return (time.perf_counter() - start) / STEPS * 1e6


def compare_times():
    rows = [(command(), python()[0], wall(None), wall(lambda row: row.temperature_k)) for _ in range(TURNS)]
    there, here, quiet, called = (statistics.median(column) for column in zip(*rows))
    print(f"command {there:.1f} µs a step, from Python {here:.1f}: {100 * (here / there - 1):+.1f} %")
    print(f"wall {quiet:.1f} µs a step, with a callback every 100 steps {called:.1f}: {100 * (called / quiet - 1):+.1f} %")


class Empty(taut.ConstraintMethod):
    def project_positions(self, system, h, state):
        pass

    def project_velocities(self, system, h, state):
        pass


class Triangles(taut.ConstraintMethod):
    """SHAKE's equations for all waters at once: Newton with the matrix of the start of the step (as M-SHAKE has it)"""

    holds, promised_error = "positions", 1e-6

    def prepare(self, system, h):
        bonds = system.bonds.reshape(-1, 3, 2)
        self.atoms = bonds.min((1, 2))[:, None] + np.arange(3)
        ends = bonds[0] - self.atoms[0, 0]
        self.sides = np.zeros((3, 3))  # of bonds by atoms: −1 where it begins, 1 where it ends
        self.sides[np.arange(3), ends[:, 0]], self.sides[np.arange(3), ends[:, 1]] = -1, 1
        self.pull = (self.sides * system.inverse_masses[self.atoms[0]]).T
        self.coupling = self.sides @ self.pull
        self.d2 = system.lengths.reshape(-1, 3) ** 2

    def project_positions(self, system, h, state):
        before = state.positions - h * state.velocities
        r0, x = self.sides @ before[self.atoms], state.positions[self.atoms]
        inverse = np.linalg.inv(self.coupling * (r0 @ r0.transpose(0, 2, 1)))
        moved = np.zeros_like(x)
        for iteration in range(20):
            r = self.sides @ (x + moved)
            sigma = ((r * r).sum(2) - self.d2) / 2
            if abs(sigma / self.d2).max() < self.promised_error:
                state.positions[self.atoms] += moved
                state.velocities[self.atoms] += moved / h
                return iteration
            moved -= self.pull @ ((inverse @ sigma[:, :, None]) * r0)
        return taut.NotConverged(20)


def methods_in_python():
    names = {}
    text = (ROOT / "python" / "examples" / "own_method.py").read_text()
    exec(text[:text.index("\n\n\ncharted")], names)
    for method, dt_fs in ((Empty, 0.01), (Triangles, 2), (names["MyShake"](tolerance=1e-6), 2)):
        each = [python(method=method, steps=100, dt_fs=dt_fs)[1] for _ in range(TURNS)]
        print(f"{method}: {statistics.median(each):.0f} µs a step, at best {min(each):.0f}")


if "--instructions" in sys.argv:
    compare_instructions()
else:
    compare_times()
    methods_in_python()
