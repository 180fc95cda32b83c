"""taut's Python module: every constraint method, from the System's XML.

Tolerances are those of the case, where a method has one; else its defaults. Rows are read between steps, with the
velocities of the full step. Redundant bonds are run as `run.redundant = "drop"`, which taut recommends where it refuses
them.
"""

from __future__ import annotations

from typing import Any, Dict, List

import numpy as np
import taut
from taut_xml import system_xml, whole_by_images

Case = Dict[str, Any]

#: Methods by name, with settings; TOLERANT take the case's tolerance.
VARIANTS: Dict[str, Dict[str, Any]] = {
    "newton": {}, "mshake": {}, "rattle": {}, "shake": {}, "feedforward": {}, "baumgarte": {}, "lincs": {},
    "lincs_strict": {"name": "lincs", "order": 8, "iterations": 4}, "settle": {}, "penalty": {}, "none": {},
}
TOLERANT = {"newton", "mshake", "rattle", "shake", "feedforward", "baumgarte"}


def describe(variant: str) -> Dict[str, str]:
    said = ", ".join(f"{key} {value}" for key, value in VARIANTS[variant].items() if key != "name") or "defaults"
    tolerance = ", tolerance of the case" if variant in TOLERANT else ""
    return {"engine": "taut", "version": taut.__version__, "settings": f"double precision; {said}{tolerance}"}


def settings_of(case: Case, variant: str) -> Dict[str, Any]:
    run, method = case["run"], VARIANTS[variant]
    chosen = {f"method.{key}": value for key, value in {"name": variant, **method}.items()}
    if variant in TOLERANT:
        chosen["method.tolerance"] = run.get("bond_tolerance", 1e-10)
    chosen.update({"run.dt_fs": 1000 * run["step_ps"], "run.redundant": "drop"})
    if "langevin" in run or "temperature_k" in case["start"]:
        chosen["run.seed"] = run["seed"]
    if "langevin" in run:
        bath = run["langevin"]
        chosen.update({"run.thermostat": "langevin", "run.temperature_k": bath["temperature_k"],
                       "run.friction_per_ps": bath["friction_per_ps"]})
    if "temperature_k" in case["start"]:
        chosen.update({"run.temperature_k": case["start"]["temperature_k"], "run.velocities": "draw"})
    return chosen


def read_row(simulation: taut.Simulation, shift: np.ndarray) -> Dict[str, Any]:
    energies = simulation.energies
    row = {"positions_nm": simulation.positions - shift, "velocities_nm_per_ps": simulation.velocities.copy(),
           "potential_kj_per_mol": energies["potential"], "kinetic_kj_per_mol": energies["kinetic"],
           "tensions_kj_per_mol_nm": simulation.tensions}
    if simulation.box is not None:
        row["pressure_bar"] = simulation.pressure
    return {key: np.array(value) for key, value in row.items()}


def start(case: Case, variant: str, shift: np.ndarray, bath: Dict[str, Any]) -> taut.Simulation:
    begin = case["start"]
    return taut.Simulation.from_openmm(
        system_xml(case), np.array(begin["positions_nm"], dtype=float) + shift,
        velocities=begin.get("velocities_nm_per_ps"), box=case["system"].get("box_nm"),
        set={**settings_of(case, variant), **bath}, threads=1)


def count_freedom(case: Case, variant: str, shift: np.ndarray) -> Any:
    """taut leaves out motions of the whole that nothing changes; under Langevin's thermostat all can change."""
    if all(ask["what"] != "degrees_of_freedom" for ask in case["asks"]):
        return None
    return start(case, variant, shift, {"run.thermostat": "langevin", "run.temperature_k": 300}).degrees_of_freedom


def run(case: Case, variant: str) -> Dict[str, Any]:
    shift = whole_by_images(case)
    if shift is None:
        return {"offered": False, "why": "two bonds of the same atoms, or bonds over half the box, that close through it"}
    steps = case["run"]["steps"]
    try:
        simulation = start(case, variant, shift, {})
        rows: Dict[str, List[Any]] = {"step": []}
        every = case["run"].get("rows_every", steps) or 1
        for step in sorted({*range(0, steps + 1, every), steps}):
            if step:
                simulation.step(step - simulation.steps_taken)
            rows["step"].append(step)
            for key, value in read_row(simulation, shift).items():
                rows.setdefault(key, []).append(value)
    except (taut.InputError, taut.SimulationFailure) as error:
        if variant == "settle" and "water" in str(error):
            return {"offered": False, "why": "SETTLE holds three-site water alone"}
        return {"refused": str(error)}
    return {"rows": rows, "degrees_of_freedom": count_freedom(case, variant, shift)}
