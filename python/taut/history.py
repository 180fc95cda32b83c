"""The log and the summary of what a simulation ran before it was resumed, copied or unpickled."""

from __future__ import annotations

import csv
import io
import json
import re
from pathlib import Path
from typing import Any, Dict, List, Optional

import numpy as np

#: Columns of the log and their titles in log.csv.
TITLES = {"step": "Step", "time_ps": "Time (ps)", "potential_kj_mol": "Potential Energy (kJ/mole)",
          "kinetic_kj_mol": "Kinetic Energy (kJ/mole)", "total_kj_mol": "Total Energy (kJ/mole)",
          "temperature_k": "Temperature (K)", "pressure_bar": "Pressure (bar)", "volume_nm3": "Box Volume (nm^3)",
          "density_kg_m3": "Density (kg/m^3)", "max_rel_bond_error": "Max Relative Bond Error",
          "rms_rel_bond_error": "RMS Relative Bond Error", "drift_kj_mol_ns_dof": "Energy Drift (kJ/mole/ns/dof)",
          "constraint_work_kj_mol": "Constraint Work (kJ/mole)", "heat_kj_mol": "Heat (kJ/mole)",
          "bath_temperature_k": "Bath Temperature (K)",
          "iterations": "Iterations per Step", "ns_per_day": "Speed (ns/day)"}

#: Columns that only some scenes have, and their titles, in which a number stands where there are several.
FURTHER = {"wall_pressure_bar": r"Wall \d+ Pressure \(bar\)",
           "wall_force_kj_mol_nm": r"Wall \d+ Force \(kJ/mole/nm\)",
           "steering_work_kj_mol": r"Steering Work \(kJ/mole\)",
           "steering_force_kj_mol_nm": r"Steering Force \(kJ/mole/nm\)"}

#: The columns of biases: what a title's end is in the log, behind bias_NAME.
OF_BIASES = {" (nm)": "_nm", " (degree)": "_deg", " Force (kJ/mole/nm)": "_force_kj_mol_nm",
             " Force (kJ/mole/rad)": "_force_kj_mol_rad"}


def _further(titles: List[str], rows: List[List[str]]) -> Dict[str, Any]:
    """Returns the columns of FURTHER and of biases that there are. Several of one kind are (rows, several)."""
    found: Dict[str, Any] = {}
    for name, title in FURTHER.items():
        places = [n for n, there in enumerate(titles) if re.fullmatch(title, there)]
        if places:
            numbers = np.array([[float(row[n] or "nan") for n in places] for row in rows]).reshape(-1, len(places))
            found[name] = numbers if r"\d+" in title else numbers[:, 0]
    for n, there in enumerate(titles):
        bias = re.fullmatch(r"Bias (\w+)( .*)", there)
        if bias and bias[2] in OF_BIASES:
            found[f"bias_{bias[1]}{OF_BIASES[bias[2]]}"] = np.array([float(row[n] or "nan") for row in rows])
    return found


class History:
    """Columns of the log, each of one length, and the summary as JSON ("null" if there is none)."""

    def __init__(self, log: Optional[Dict[str, Any]] = None, summary: str = "null") -> None:
        self.log, self.summary = log or {}, summary

    def to_bytes(self) -> bytes:
        """Returns both as a compressed archive of numpy's, without pickled objects."""
        if not len(self.log.get("step", ())) and self.summary == "null":
            return b""
        into = io.BytesIO()
        np.savez_compressed(into, summary=np.frombuffer(self.summary.encode(), np.uint8), **self.log)
        return into.getvalue()

    @classmethod
    def of_bytes(cls, kept: bytes) -> "History":
        if not kept:
            return cls()
        with np.load(io.BytesIO(kept), allow_pickle=False) as archive:
            columns = {name: archive[name] for name in archive.files}
        return cls(log=columns, summary=columns.pop("summary").tobytes().decode())

    @classmethod
    def of_folder(cls, folder: str) -> "History":
        """Reads log.csv and summary.json, if they are there, from the folder of a run."""
        log: Dict[str, Any] = {}
        path = Path(folder)
        if (path / "log.csv").exists():
            with open(path / "log.csv", newline="") as file:
                rows = [row for row in csv.reader(file) if row]
            titles = [title.lstrip("#").strip('"') for title in rows[0]] if rows else []
            place = {name: titles.index(title) for name, title in TITLES.items() if title in titles}
            rows = [row for row in rows[1:] if len(row) == len(titles)]
            log = {name: np.array([float(row[place[name]] or "nan") if name in place else np.nan for row in rows])
                   for name in TITLES}
            log["step"] = log["step"].astype(np.int64)
            log.update(_further(titles, rows))
        summary = (path / "summary.json").read_text() if (path / "summary.json").exists() else "null"
        return cls(log, summary)

    def cut(self, last_step: int) -> None:
        """Drops the rows after a step."""
        if self.log:
            kept = self.log["step"] <= last_step
            self.log = {name: column[kept] for name, column in self.log.items()}

    def before(self, later: Dict[str, Any]) -> Dict[str, Any]:
        """Returns this log followed by a later one. A row that both have is taken from the later one."""
        if not len(self.log.get("step", ())):
            return later
        own = self.log["step"] < later["step"][0] if len(later["step"]) else slice(None)
        return {name: np.concatenate([self.log[name][own], column]) for name, column in later.items()}

    def summary_or(self, later: str) -> Any:
        """Returns the later summary, or this one if there is none, as a dict; None if there is neither."""
        return json.loads(self.summary if later == "null" else later)
