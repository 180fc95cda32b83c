#!/usr/bin/env python3
"""Run the study: every method on every system at every step, several seeds each.

    docs/study/study.py [--systems NAME,...] [--seeds 3] [--jobs 2] [--factor 1] [--taut build/taut] [--work FOLDER]
    docs/study/study.py --short    # a few cells with another seed, compared with the data

One run is one row of data/runs.csv, written when the run ends. Rows that are there are not run again, so a study that
was stopped is resumed by the same command, and a row that a kill cut off is taken away first. cases.py says what is
run, seeds outermost. A run lasts the same physical time at every step and takes one thread; --jobs runs go side by
side, --factor makes all longer. The thermostat rescales velocities (Bussi, Donadio, Parrinello 2007,
doi:10.1063/1.2408420); the drift is that of the total energy less the heat.
"""
import argparse
import concurrent.futures
import csv
import fcntl
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import numpy

from cases import DATA, METHODS, ROOT, SYSTEMS, cells, key_of, read_rows
from judge import Judge, of, whole

COLUMNS = ("system,method,dt_fs,seed,precision,ps,status,promise,rms_bond,max_bond,drift,constraint_drift,"
           "temperature_k,translation_k,rotation_k,rest_k,potential_kj_mol,pressure_bar,end_to_end_nm2,g_peak,"
           "iterations").split(",")
SHORT_SEED = 101


class Study:
    def __init__(self, taut, work, factor=1):
        self.taut, self.work, self.factor = taut, Path(work), factor
        self.reductions = {}
        self.preparing = threading.Lock()
        self.work.mkdir(parents=True, exist_ok=True)

    def command(self, name):
        """What runs the system: words, and keys for --set."""
        system = SYSTEMS[name]
        if not system.openmm:
            return [self.taut, "run", *system.scene], list(system.keys)
        files = system.files(self.work)
        if not files[0].exists():
            import make_systems
            files[0].parent.mkdir(exist_ok=True)
            make_systems.make(files[0].parent, self.taut)
        return [self.taut, "run", "--openmm", *map(str, files)], list(system.keys)

    def started(self, name):
        """The same from an equilibrated start, which is made where it is not there yet."""
        system = SYSTEMS[name]
        words, keys = self.command(name)
        if not system.equilibrate_ps:
            return words, [*keys, "run.velocities=draw"]
        folder = self.work / f"start-{name}"
        if not (folder / "summary.json").exists():
            step = system.dt_fs / 2
            subprocess.run([*words, "--threads", "1", "--steps", str(round(1000 * system.equilibrate_ps / step)), "--dt-fs",
                            str(step), "--out", str(folder), "--overwrite", "--set", *keys,
                            *system.settings(system.precision), "method.name=newton"],
                           check=True, stdout=subprocess.DEVNULL)
        return words, [*keys, f"build.start={folder / 'final.start.toml'}", "run.velocities=draw"]

    def reduction(self, name, asked):
        """The reduction of an error a step that `taut calibrate` finds for this system, at its usual step."""
        if (name, asked) not in self.reductions:
            words, keys = self.command(name)
            words[1] = "calibrate"
            option, value = asked.split(":")
            found = subprocess.run([*words, f"--{option}", value, "--steps", "0", "--json", "-", "--dt-fs", str(SYSTEMS[name].dt_fs),
                                    "--set", *keys, "run.thermostat=none"], capture_output=True, text=True)
            figures = json.loads(found.stdout) if found.stdout.startswith("{") else {}
            self.reductions[name, asked] = figures.get("method", {}).get("reduction")
        return self.reductions[name, asked]

    def method_keys(self, name, method):
        keys = []
        for key in METHODS[method]:
            asked = re.fullmatch(r"reduction=\{(.*)\}", key)
            if asked:
                reduction = self.reduction(name, asked[1])
                if reduction is None:
                    return None
                key = f"reduction={reduction}"
            keys.append(f"method.{key}")
        return keys

    def of_cell(self, name, method, step, precision):
        """The command of a run, but for its length and what it writes; None where no gains were found."""
        with self.preparing:
            method_keys = self.method_keys(name, method)
            if method_keys is None:
                return None
            words, keys = self.started(name)
        return ([*words, "--threads", "1", "--dt-fs", str(step), "--json"],
                [*keys, *SYSTEMS[name].settings(precision), *method_keys])

    def run(self, name, method, step, seed, precision):
        found = self.of_cell(name, method, step, precision)
        if found is None:
            return {"status": "not calibrated: taut calibrate found no gains"}
        words, keys = found
        ps = SYSTEMS[name].ps * self.factor
        steps = round(1000 * ps / step)
        with tempfile.TemporaryDirectory(dir=self.work) as scratch:
            out = Path(scratch) / "out"
            measure = [] if SYSTEMS[name].openmm else ["--measure"]
            done = subprocess.run([*words, "--steps", str(steps), *measure, "--out", str(out), "--set", *keys,
                                   f"run.seed={seed}", f"run.log_every={max(1, steps // 400)}"],
                                  capture_output=True, text=True)
            if done.returncode:
                return {"status": why_not(done)}
            return {"ps": ps} | figures(json.loads(done.stdout), out / "log.csv", min(SYSTEMS[name].settling_ps, ps / 2))


def said(text):
    lines = [line for line in text.splitlines() if line.startswith("taut: ")] or text.splitlines() or ["nothing"]
    return lines[0].removeprefix("taut: ")[:160]


def why_not(done):
    """The status of a run that taut refused or that failed; one that was killed is no row, and ends the study."""
    kinds = {1: "failed", 2: "refused"}
    if done.returncode not in kinds:
        raise SystemExit(f"a run ended with {done.returncode}: {said(done.stderr)}")
    return f"{kinds[done.returncode]}: {said(done.stderr)}"


def temperatures(kinds):
    """Translation and rotation of the molecules of which there are most, the rest of those of most atoms."""
    count = lambda kind: int(re.match(r"(\d+) molecule", kind)[1]) if " molecule" in kind else 0
    size = lambda kind: int(re.search(r"(\d+) atoms?$", kind)[1])
    row = {}
    if kinds:
        common, large = kinds[max(kinds, key=count)], kinds[max(kinds, key=size)]
        row = {f"{part}_k": common[part]["value"] for part in ("translation", "rotation") if part in common}
        if "rest" in large:
            row["rest_k"] = large["rest"]["value"]
    return row


def figures(summary, log, settling_ps):
    """What a run measured. Drifts and means of the log are of what comes after the settling; the rest is of all."""
    row = {"status": "ok", "rms_bond": summary["rms_rel_bond_error"], "max_bond": summary["max_rel_bond_error"]}
    if summary["converged"] is not None:  # every step to twice the error that the method promises
        row["promise"] = "kept" if summary["converged"] else "missed"
    row |= temperatures(summary.get("temperatures_k", {}))
    measured = summary.get("measured") or {}
    if "end_to_end_squared_nm2" in measured:
        row["end_to_end_nm2"] = next(iter(measured["end_to_end_squared_nm2"].values()))
    if measured.get("distances"):
        row["g_peak"] = max(point[1] for point in measured["distances"])
    with open(log, newline="") as file:
        rows = list(csv.DictReader(file))
    column = lambda title: numpy.array([float(r[title]) for r in rows]) if rows[0].get(title) else None
    t = column("Time (ps)")
    settled, later = t >= settling_ps, t >= (settling_ps or 0.1 * t[-1])
    slope = lambda energy: 1000 * numpy.polyfit(t[settled], energy[settled], 1)[0] / summary["dof"]
    row["drift"] = slope(column("Total Energy (kJ/mole)") - column("Heat (kJ/mole)"))
    row["constraint_drift"] = slope(column("Constraint Work (kJ/mole)"))
    for name, title in (("temperature_k", "Temperature (K)"), ("potential_kj_mol", "Potential Energy (kJ/mole)"),
                        ("pressure_bar", "Pressure (bar)"), ("iterations", "Iterations per Step")):
        if (values := column(title)) is not None:
            row[name] = values[later].mean()
    known = lambda value: value is not None and not (isinstance(value, float) and math.isnan(value))
    return {key: value for key, value in row.items() if known(value)}


def open_rows(path, columns):
    """A writer of rows to a CSV file that may be there already: what a kill cut off at its end is taken away."""
    file = open(path, "a+", newline="")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"{path} is being written by another run of this command")
    file.seek(0)
    text = file.read()
    if text and not text.endswith("\n"):
        os.truncate(path, len(text[:text.rfind("\n") + 1].encode()))
    writer = csv.DictWriter(file, columns, lineterminator="\n")
    if not text:
        writer.writeheader()

    def write(row):
        writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})
        file.flush()
    return write


def add_rows(file, columns, todo, measure, jobs):
    """Measures each cell of todo, `jobs` at a time, and writes its row to data/`file` when it ends."""
    write = open_rows(DATA / file, columns)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        begun = {pool.submit(measure, cell): cell for cell in todo}
        try:
            for n, ended in enumerate(concurrent.futures.as_completed(begun), 1):
                cell = begun[ended]
                write({key: value for key, value in ended.result().items() if key in columns}
                      | cell | {"dt_fs": f"{cell['dt_fs']:g}"})
                print(f"\r{n} of {len(todo)}: {', '.join(map(str, cell.values()))}".ljust(100), end="", file=sys.stderr,
                      flush=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    print(f"\n{len(todo)} runs are in {DATA / file}", file=sys.stderr)


def check_short(study):
    """Runs cells at the usual step with a seed of their own, compares them with data/runs.csv: whether all hold.

    The bond error holds within a factor of 2 (newton's below 1e-9), drift and potential energy within 4 standard
    deviations of one run beside the mean of those that are there.
    """
    judge = Judge(read_rows())
    compared = differing = 0
    for name in judge.systems:
        system = SYSTEMS[name]
        if system.precision != "double":  # large
            continue
        for method in ("baumgarte", "feedforward", "lincs", "newton"):
            kept = judge.table[name].get(method, {}).get(float(system.dt_fs), [])
            if len(kept) < 2 or not whole(kept):
                continue
            row = study.run(name, method, system.dt_fs, SHORT_SEED, system.precision)
            words, holds = [row["status"]], row["status"] == "ok"
            if holds:
                expected = statistics.mean(of(kept, "rms_bond"))
                holds = 0.5 < row["rms_bond"] / expected < 2 or row["rms_bond"] < 1e-9
                words = [f"bonds {row['rms_bond']:.1e} for {expected:.1e}"]
                for column in ("drift", "potential_kj_mol"):
                    values = of(kept, column)
                    one = judge.error(name, column, values) * math.sqrt(len(values) + 1)
                    off = row[column] - statistics.mean(values)
                    holds = holds and abs(off) <= 4 * one
                    words.append(f"{column} {row[column]:.4g} for {row[column] - off:.4g} ± {one:.2g}")
            compared += 1
            differing += not holds
            verdict = "holds  " if holds else "DIFFERS"
            print(f"{verdict} {name}, {method}, {system.dt_fs:g} fs: {'; '.join(words)}", flush=True)
    if compared == 0:
        print(f"nothing to compare: {DATA / 'runs.csv'} has none of these cells", file=sys.stderr)
    return compared > 0 and differing == 0


def options(description):
    ask = argparse.ArgumentParser(description=description.splitlines()[0])
    ask.add_argument("--systems", default=",".join(SYSTEMS))
    ask.add_argument("--taut", default=str(ROOT / "build/taut"))
    ask.add_argument("--seeds", type=int, default=3)
    ask.add_argument("--jobs", type=int, default=2, help="runs side by side")
    ask.add_argument("--work", default=str(Path(tempfile.gettempdir()) / "taut-study"),
                     help="folder of the equilibrated starts")
    return ask


def main():
    ask = options(__doc__)
    ask.add_argument("--methods", default=",".join(METHODS))
    ask.add_argument("--factor", type=float, default=1)
    ask.add_argument("--short", action="store_true", help="compare a few runs with the data instead")
    asked = ask.parse_args()
    unknown = [name for name in asked.systems.split(",") if name not in SYSTEMS]
    if unknown:
        ask.error(f"no system {unknown[0]}: expected {', '.join(SYSTEMS)}")
    DATA.mkdir(exist_ok=True)
    study = Study(asked.taut, asked.work, asked.factor)
    if asked.short:
        sys.exit(0 if check_short(study) else 1)
    done = {key_of(row) for row in read_rows()}
    todo = [dict(zip(("system", "method", "dt_fs", "seed", "precision"), cell))
            for cell in cells(asked.systems.split(","), asked.seeds)
            if cell not in done and cell[1] in asked.methods.split(",")]
    add_rows("runs.csv", COLUMNS, todo, lambda cell: study.run(*cell.values()), asked.jobs)


if __name__ == "__main__":
    main()
