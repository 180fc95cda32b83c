"""The command `taut run --openmm`: the case as files, the answers from the files that a run leaves.

Energies and pressure are those of log.csv, positions and velocities those of final.start.toml, so that a run has them
at the start and at the end alone. What wants more rows of them is not offered here, but by the module.
"""

from __future__ import annotations

import csv
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

try:
    import tomllib
except ImportError:  # Python before 3.11
    import toml as tomllib  # type: ignore[no-redef]

from programs import run_program
from taut_xml import box_xml, system_xml, tag, whole_by_images

Case = Dict[str, Any]

VARIANTS: Dict[str, Dict[str, str]] = {
    "newton": {"method.name": "newton"}, "feedforward": {"method.name": "feedforward"},
    "newton_mixed": {"method.name": "newton", "forcefield.precision": "mixed"},
}
BUILT = Path(__file__).resolve().parents[2] / "build" / "taut"
COLUMNS = {"step": "Step", "potential_kj_per_mol": "Potential Energy (kJ/mole)",
           "kinetic_kj_per_mol": "Kinetic Energy (kJ/mole)", "pressure_bar": "Pressure (bar)"}


def command() -> str:
    """TAUT_COMMAND, or the build of this tree, or what PATH has."""
    found = os.environ.get("TAUT_COMMAND") or (str(BUILT) if BUILT.exists() else shutil.which("taut"))
    if not found:
        raise FileNotFoundError("no command taut: build it, or name it in TAUT_COMMAND")
    return found


def describe(variant: str) -> Dict[str, str]:
    version = subprocess.run([command(), "--version"], capture_output=True, text=True).stdout.split()
    precision = VARIANTS[variant].get("forcefield.precision", "double")
    return {"engine": "taut, the command", "version": version[1] if len(version) > 1 else "",
            "settings": f"{precision} precision of pair forces, tolerance of the case"}


def state_xml(case: Case, shift: np.ndarray) -> str:
    start = case["start"]
    parts = [("Positions", "Position", (np.array(start["positions_nm"], dtype=float) + shift).tolist())]
    if "velocities_nm_per_ps" in start:
        parts.append(("Velocities", "Velocity", start["velocities_nm_per_ps"]))
    lists = [tag(several, [tag(one, x=x, y=y, z=z) for x, y, z in rows]) for several, one, rows in parts]
    return '<?xml version="1.0" ?>' + tag("State", [box_xml(case["system"]), *lists], type="State", version=1, time=0, openmmVersion="8.0")


def settings_of(case: Case, variant: str) -> List[str]:
    run, system = case["run"], case["system"]
    chosen: Dict[str, Any] = {"forcefield.precision": "double", **VARIANTS[variant], "run.redundant": "drop",
                              "run.dt_fs": 1000 * run["step_ps"],
                              "run.log_every": run.get("rows_every", run["steps"]) or 1,
                              "method.tolerance": run.get("bond_tolerance", 1e-10)}
    if "box_nm" not in system and all(force["kind"] != "nonbonded" for force in system["forces"]):
        del chosen["forcefield.precision"]  # taut refuses it where no pairs are
    if "langevin" in run:
        chosen.update({"run.thermostat": "langevin", "run.temperature_k": run["langevin"]["temperature_k"],
                       "run.friction_per_ps": run["langevin"]["friction_per_ps"]})
    if "temperature_k" in case["start"]:
        chosen.update({"run.temperature_k": case["start"]["temperature_k"], "run.velocities": "draw"})
    if "langevin" in run or "temperature_k" in case["start"]:
        chosen["run.seed"] = run["seed"]
    return [f"{key}={value}" for key, value in chosen.items()]


def read_rows(folder: Path, case: Case, shift: np.ndarray) -> Dict[str, Any]:
    with open(folder / "log.csv", encoding="utf-8") as file:
        log = list(csv.DictReader(line.lstrip("#") for line in file))
    rows: Dict[str, Any] = {key: [float(row[column]) for row in log] for key, column in COLUMNS.items()
                            if all(row.get(column) for row in log)}
    if all(ask["kind"] != "statistical" for ask in case["asks"]):
        end = np.array(tomllib.loads((folder / "final.start.toml").read_text(encoding="utf-8"))["atoms"])
        start = [np.array(case["start"][key], dtype=float) for key in ("positions_nm", "velocities_nm_per_ps")]
        rows["positions_nm"] = [start[0], end[:, :3] - shift]
        rows["velocities_nm_per_ps"] = [start[1], end[:, 3:]]
    return rows


def run(case: Case, variant: str) -> Dict[str, Any]:
    shift = whole_by_images(case)
    if shift is None:
        return {"offered": False, "why": "two bonds of the same atoms, or bonds over half the box, that close through it"}
    if any(ask["what"] == "degrees_of_freedom" for ask in case["asks"]):  # all are counted where a bath acts on all
        case = {**case, "run": {**case["run"], "langevin": {"temperature_k": 300, "friction_per_ps": 1}, "seed": 1}}
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        (folder / "system.xml").write_text(system_xml(case), encoding="utf-8")
        (folder / "state.xml").write_text(state_xml(case, shift), encoding="utf-8")
        done = run_program([command(), "run", "--openmm", "system.xml", "state.xml", "--threads", "1", "--out", "out",
                            "--steps", str(case["run"]["steps"]), "--set", *settings_of(case, variant)], folder)
        if done.returncode in (1, 2):
            return {"refused": done.stderr.strip()}
        if done.returncode:
            raise RuntimeError(f"exit {done.returncode}: {done.stderr}")
        freedom = json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))["dof"]
        return {"rows": read_rows(folder / "out", case, shift), "degrees_of_freedom": freedom}
