#!/usr/bin/env python3
"""Run the study: every method on every system at every step, several seeds each.

    docs/study/study.py [--systems NAME,...] [--seeds 4] [--factor 1] [--taut build/taut] [--work FOLDER]
    docs/study/study.py --time     # what a step of each method takes
    docs/study/study.py --short    # a few cells again, compared with the data

One run is one row of data/runs.csv, written when the run ends. Rows that are there are not run again, so a study that
was stopped is resumed by the same command. Seeds are the outermost loop: after the first seed every cell has one value.
A run lasts the same physical time at every step. --factor makes all runs longer. The thermostat rescales velocities (Bussi,
Donadio, Parrinello 2007, doi:10.1063/1.2408420); the drift is that of the total energy less the heat.
"""
import argparse
import csv
import json
import math
import os
import re
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DATA = HERE / "data"
COLUMNS = ("system,method,dt_fs,seed,precision,ps,status,promise,rms_bond,max_bond,drift,constraint_drift,"
           "temperature_k,translation_k,rotation_k,rest_k,potential_kj_mol,pressure_bar,end_to_end_nm2,g_peak,"
           "iterations,cpu_us").split(",")
STEP_FACTORS = (0.25, 0.5, 1, 1.5, 2, 2.5)
REFERENCE = ("newton", STEP_FACTORS[0])  # the method and the step that averages are compared with


class System:
    """A system: what `taut run` is told, its usual step [fs], the times of a run and of the equilibration before [ps]."""

    def __init__(self, title, scene, dt_fs, ps, temperature_k=298.15, thermostat_ps=0.5, equilibrate_ps=0, water=False,
                 openmm=None, keys=()):
        self.keys_of_scene = list(keys)
        self.title, self.scene, self.dt_fs, self.ps, self.temperature_k = title, scene, dt_fs, ps, temperature_k
        self.thermostat_ps, self.equilibrate_ps, self.water, self.openmm = thermostat_ps, equilibrate_ps, water, openmm

    def keys(self):
        return [f"run.temperature_k={self.temperature_k}", "run.thermostat=rescaling",
                f"run.thermostat_ps={self.thermostat_ps}"]


def openmm(name):
    return [str(ROOT / f"tests/data/{name}.system.xml"), str(ROOT / f"tests/data/{name}.state.xml")]


LENNARD_JONES_K = 120.27235504272603  # the temperature 1 kJ/mol
SYSTEMS = {
    "chains": System("100 free chains of 20", ["freely_jointed"], 10, 20, LENNARD_JONES_K, 1, 20),
    "melt": System("Kremer–Grest melt, 20 × 50", ["melt"], 5, 20, LENNARD_JONES_K, 1, 10),
    "decane": System("decane, 128 molecules", ["decane"], 2, 10),
    "tip3p": System("TIP3P, 216 waters, PME", ["water"], 2, 10, water=True, keys=["forcefield.coulomb=pme"]),
    "tip4p2005": System("TIP4P/2005, 216 waters, PME",
                        ["water"], 2, 10, equilibrate_ps=20, water=True,
                        keys=["forcefield.coulomb=pme", "build.model=tip4p2005"]),
    "dipeptide": System("alanine dipeptide in water, h-bonds", [], 2, 4, 300, openmm=openmm("ala2-hbonds-rf")),
    "dipeptide-all": System("the same, all bonds", [], 2, 4, 300, openmm=openmm("ala2-allbonds-rf")),
    "dna": System("DNA duplex without water, h-bonds", [], 2, 10, 300, openmm=openmm("dna-hbonds")),
}

# A method's name in the tables, and its keys. {sweeps:4} stands for what `taut calibrate --sweeps 4` finds.
METHODS = {
    "none": ["name=none"],
    "penalty": ["name=penalty"],
    "baumgarte": ["name=baumgarte"],
    "baumgarte dead-beat": ["name=baumgarte", "gains=dead-beat"],
    "baumgarte as 4 sweeps": ["name=baumgarte", "gains=rattle", "damping=centred", "passes=2", "reduction={sweeps:4}"],
    "baumgarte as rattle 1e-5": ["name=baumgarte", "gains=rattle", "damping=centred", "passes=2",
                                 "reduction={tolerance:1e-5}"],
    "baumgarte physical": ["name=baumgarte", "gains=physical"],
    "baumgarte hoomd": ["name=baumgarte", "gains=hoomd"],
    "baumgarte box2d": ["name=baumgarte", "gains=box2d"],
    "baumgarte implicit": ["name=baumgarte", "damping=implicit"],
    "baumgarte lagged": ["name=baumgarte", "damping=lagged"],
    "feedforward": ["name=feedforward"],
    "shake 1e-4": ["name=shake", "tolerance=1e-4"],
    "shake": ["name=shake"],
    "rattle": ["name=rattle"],
    "newton": ["name=newton"],
    "mshake": ["name=mshake"],
    "lincs": ["name=lincs"],
    "lincs strict": ["name=lincs", "order=8", "iterations=2"],
    "settle": ["name=settle"],
}


class Study:
    def __init__(self, taut, work, factor):
        self.taut, self.work, self.factor = taut, Path(work), factor
        self.reductions = {}

    def command(self, name):
        """What runs the system: words, and keys for --set."""
        system = SYSTEMS[name]
        if system.openmm:
            return [self.taut, "run", "--openmm", *system.openmm], []
        return [self.taut, "run", *system.scene], system.keys_of_scene

    def started(self, name):
        """The same from an equilibrated start, which is made where it is not there yet."""
        system = SYSTEMS[name]
        words, keys = self.command(name)
        if not system.equilibrate_ps:
            return words, [*keys, "run.velocities=draw"]
        folder = self.work / f"start-{name}"
        if not (folder / "summary.json").exists():
            step = system.dt_fs / 2
            subprocess.run([*words, "--steps", str(round(1000 * system.equilibrate_ps / step)), "--dt-fs", str(step),
                            "--out", str(folder), "--overwrite", "--set", *keys, *system.keys(), "method.name=newton"],
                           check=True, stdout=subprocess.DEVNULL)
        return words, [*keys, f"build.start={folder / 'final.start.toml'}", "run.velocities=draw"]

    def reduction(self, name, asked):
        """The reduction of an error a step that `taut calibrate` finds for this system, at its usual step."""
        if (name, asked) not in self.reductions:
            words, keys = self.command(name)
            words[1] = "calibrate"
            option, value = asked.split(":")
            found = subprocess.run([*words, f"--{option}", value, "--json", "-", "--dt-fs", str(SYSTEMS[name].dt_fs),
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

    def run(self, name, method, step, seed, precision):
        system = SYSTEMS[name]
        method_keys = self.method_keys(name, method)
        if method_keys is None:
            return {"status": "not calibrated: taut calibrate found no gains"}
        words, keys = self.started(name)
        ps = system.ps * self.factor
        steps = round(1000 * ps / step)
        with tempfile.TemporaryDirectory(dir=self.work) as scratch:
            out = Path(scratch) / "out"
            before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
            done = subprocess.run(
                [*words, "--steps", str(steps), "--dt-fs", str(step), "--measure", "--json",
                 "--out", str(out), "--set", *keys, *system.keys(), *method_keys, f"run.seed={seed}",
                 *([] if name == "chains" else [f"forcefield.precision={precision}"]),
                 f"run.log_every={max(1, steps // 200)}"], capture_output=True, text=True)
            row = {"ps": ps, "cpu_us": 1e6 * (resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before) / steps}
            if done.returncode == 2:
                return {"status": "refused: " + said(done.stderr)}
            if done.returncode == 1:
                return {"status": "failed: " + said(done.stderr)}
            if done.returncode:
                sys.exit(f"study.py: {said(done.stderr)}")
            return row | figures(json.loads(done.stdout), out / "log.csv")


def said(text):
    lines = [line for line in text.splitlines() if line.startswith("taut: ")] or text.splitlines() or ["nothing"]
    return lines[0].removeprefix("taut: ")[:160]


def figures(summary, log):
    row = {"status": "ok", "rms_bond": summary["rms_rel_bond_error"], "max_bond": summary["max_rel_bond_error"],
           "drift": summary["energy_drift_kj_mol_ns_dof"],
           "constraint_drift": summary["constraint_drift_kj_mol_ns_dof"], "temperature_k": summary["temperature_k"]}
    if summary["converged"] is not None:  # every step to twice the error that the method promises
        row["promise"] = "kept" if summary["converged"] else "missed"
    kinds = summary.get("temperatures_k", {})
    if kinds:
        largest = max(kinds, key=lambda kind: int(kind.split()[0]))
        for part, value in kinds[largest].items():
            row[f"{part}_k"] = value["value"]
    if summary.get("pressure_bar"):
        row["pressure_bar"] = summary["pressure_bar"]["value"]
    measured = summary.get("measured") or {}
    if "end_to_end_squared_nm2" in measured:
        row["end_to_end_nm2"] = next(iter(measured["end_to_end_squared_nm2"].values()))
    if measured.get("distances"):
        row["g_peak"] = max(point[1] for point in measured["distances"])
    with open(log, newline="") as file:
        rows = list(csv.DictReader(file))
    later = rows[len(rows) // 10:]  # the first tenth, in which drawn velocities settle, is left out
    mean = lambda title: sum(float(r[title]) for r in later) / len(later)
    titles = {title.lstrip("#"): title for title in rows[0]}
    row["potential_kj_mol"] = mean(titles["Potential Energy (kJ/mole)"])
    row["iterations"] = mean(titles["Iterations per Step"])
    known = lambda value: value is not None and not (isinstance(value, float) and math.isnan(value))
    return {key: value for key, value in row.items() if known(value)}


def cells(names, seeds, precisions=True):
    """All runs, (system, method, step, seed, precision), the most telling first."""
    for seed in range(1, seeds + 1):
        for name in names:
            system = SYSTEMS[name]
            for method in METHODS:
                if method == "settle" and not system.water:
                    continue
                for factor in STEP_FACTORS:
                    yield name, method, factor * system.dt_fs, seed, "double"
            for method in ("baumgarte", "feedforward", "newton") if precisions and name not in ("chains",) else ():
                yield name, method, system.dt_fs, seed, "mixed"


def read_rows():
    path = DATA / "runs.csv"
    if not path.exists():
        return []
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def key_of(row):
    return row["system"], row["method"], float(row["dt_fs"]), int(row["seed"]), row["precision"]


def measure_times(study, names):
    """Writes data/times.csv: processor time of a step [µs] at the usual step, the least of three, methods in turns.

    It is that of a run of about a second less that of one of a third of it, so that reading and writing do not count.
    """
    def seconds_of(name, method_keys, steps):
        words, keys = study.started(name)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run([*words, "--steps", str(steps), "--dt-fs", str(SYSTEMS[name].dt_fs), "--set", *keys,
                               *SYSTEMS[name].keys(), *method_keys, f"run.log_every={steps}"], capture_output=True)
        return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before if done.returncode == 0 else None

    best = {}
    for name in names:
        steps = 300
        while seconds_of(name, study.method_keys(name, "newton"), steps) < 1:
            steps *= 2
        for _ in range(3):
            for method in METHODS:
                method_keys = study.method_keys(name, method)
                if method_keys is None or method in ("none", "penalty"):
                    continue
                short, long = (seconds_of(name, method_keys, count) for count in (steps // 3, steps))
                if short is not None and long is not None:
                    us = 1e6 * (long - short) / (steps - steps // 3)
                    best[name, method] = min(us, best.get((name, method), us))
        print(f"{name}: timed", file=sys.stderr)
    with open(DATA / "times.csv", "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["system", "method", "us"])
        writer.writerows([*key, f"{us:.1f}"] for key, us in best.items())


def check_short(study):
    """Runs a few cells for a tenth of the time, and compares them with data/runs.csv. Returns whether all hold, and any was there."""
    kept = {}
    for row in read_rows():
        if row["status"] == "ok":
            kept.setdefault(key_of(row)[:3], []).append(float(row["rms_bond"]))
    compared = differing = 0
    study.factor = 0.1
    for name in ("chains", "melt", "tip3p"):
        for method in ("baumgarte", "baumgarte implicit", "feedforward", "lincs", "newton"):
            step = SYSTEMS[name].dt_fs
            if (name, method, step) not in kept:
                continue
            row = study.run(name, method, step, 1, "double")
            expected = sum(kept[name, method, step]) / len(kept[name, method, step])
            holds = row["status"] == "ok" and (0.5 < row["rms_bond"] / expected < 2 or row["rms_bond"] < 1e-9)
            compared += 1
            differing += not holds
            found = f"{row['rms_bond']:.1e} for {expected:.1e}" if row["status"] == "ok" else row["status"]
            print(f"{'holds  ' if holds else 'DIFFERS'} {name}, {method}, {step:g} fs: rms bond error {found}")
    if compared == 0:
        print(f"nothing to compare: {DATA / 'runs.csv'} has none of these cells", file=sys.stderr)
    return compared > 0 and differing == 0


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--systems", default=",".join(SYSTEMS))
    ask.add_argument("--seeds", type=int, default=4)
    ask.add_argument("--factor", type=float, default=1)
    ask.add_argument("--time", action="store_true", help="measure the time of a step instead")
    ask.add_argument("--short", action="store_true", help="compare a few short runs with the data instead")
    ask.add_argument("--taut", default=str(ROOT / "build/taut"))
    ask.add_argument("--work", default=None, help="folder of the equilibrated starts (a folder in the system's /tmp)")
    asked = ask.parse_args()
    unknown = [name for name in asked.systems.split(",") if name not in SYSTEMS]
    if unknown:
        ask.error(f"no system {unknown[0]}: expected {', '.join(SYSTEMS)}")
    work = Path(asked.work or Path(tempfile.gettempdir()) / "taut-study")
    work.mkdir(parents=True, exist_ok=True)
    DATA.mkdir(exist_ok=True)
    study = Study(asked.taut, work, asked.factor)
    if asked.time:
        return measure_times(study, asked.systems.split(","))
    if asked.short:
        sys.exit(0 if check_short(study) else 1)
    done = {key_of(row) for row in read_rows()}
    todo = [cell for cell in cells(asked.systems.split(","), asked.seeds) if cell not in done]
    new = not (DATA / "runs.csv").exists()
    with open(DATA / "runs.csv", "a", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        if new:
            writer.writeheader()
        for n, (name, method, step, seed, precision) in enumerate(todo):
            print(f"\r{n} of {len(todo)}: {name}, {method}, {step:g} fs, seed {seed}, {precision}".ljust(100), end="",
                  file=sys.stderr, flush=True)
            row = study.run(name, method, step, seed, precision)
            row |= {"system": name, "method": method, "dt_fs": f"{step:g}", "seed": seed, "precision": precision}
            writer.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})
            file.flush()
    print(f"\n{len(todo)} runs are in {DATA / 'runs.csv'}", file=sys.stderr)


if __name__ == "__main__":
    main()
