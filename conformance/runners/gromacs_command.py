"""GROMACS: LINCS, SHAKE and SETTLE under the integrator md, the leapfrog that its manual recommends.

The commands are `gmx_d` for double precision, and what GMX_NEW names (else `gmx`) for the newest version there is. md's
velocities are half a step behind: a run starts from that of half a step before, found by a step of GROMACS's own
backwards, and rows have the mean of the two around them. Gravity and constant forces are pull coordinates."""

from __future__ import annotations

import functools
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
from gromacs_files import call, read_trr, write_coordinates, write_topology
from gromacs_parameters import Unsayable, roomy, write_parameters

from forces import force_function
from programs import run_program
from shared import (
    Case, EngineStopped, inverse_masses, nearest_images, not_offered, row_steps, start_velocities, unwrap,
    wants_refusal, wants_tensions_alone)

LINCS = {"algorithm": "lincs", "order": 4, "iter": 1}
VARIANTS: Dict[str, Dict[str, Any]] = {
    "lincs": {**LINCS, "program": "gmx_d"},
    "lincs_order_8_iter_8": {"algorithm": "lincs", "order": 8, "iter": 8, "program": "gmx_d"},
    "shake": {"algorithm": "shake", "program": "gmx_d"},
    "settle": {"algorithm": "settle", "program": "gmx_d"},
    "newest_lincs_mixed": {**LINCS, "program": "new"},
    "newest_settle_mixed": {"algorithm": "settle", "program": "new"},
}


def command(variant: str) -> str:
    program = VARIANTS[variant]["program"]
    return os.environ.get("GMX_NEW", "gmx") if program == "new" else program


@functools.lru_cache(maxsize=None)
def version_of(program: str) -> str:
    said = subprocess.run([program, "--version"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"GROMACS version:\s*(\S+)", said)
    return found.group(1).split("-Debian")[0] if found else "unknown"


def describe(variant: str) -> Dict[str, str]:
    of = VARIANTS[variant]
    held = {"lincs": f"LINCS, lincs-order {of.get('order')}, lincs-iter {of.get('iter')}",
            "shake": "SHAKE, shake-tol of the case", "settle": "SETTLE"}[of["algorithm"]]
    precision = "mixed" if of["program"] == "new" else "double"
    return {"engine": "GROMACS", "version": version_of(command(variant)),
            "settings": f"{held}, integrator md (sd with a thermostat), {precision} precision"}


def constraint_lines(case: Case, of: Dict[str, Any]) -> List[str]:
    if of["algorithm"] == "shake":
        return ["constraint-algorithm = shake", f"shake-tol = {case['run'].get('bond_tolerance', 1e-10):g}"]
    return ["constraint-algorithm = lincs", f"lincs-order = {of.get('order', 4)}", f"lincs-iter = {of.get('iter', 1)}"]


class Gromacs:
    """Runs of one case in one folder."""

    def __init__(self, case: Case, of: Dict[str, Any], program: str, folder: Path) -> None:
        self.case, self.of, self.program, self.folder = case, of, program, folder
        write_topology(case, folder, of["algorithm"] == "settle")
        reference = np.array(case["start"]["positions_nm"], dtype=float)
        for force in case["system"]["forces"]:
            if force["kind"] == "harmonic_position":
                reference[force["atom"]] = force["centre_nm"] + case["shift"]
        write_coordinates(case, folder / "reference.gro", reference, np.zeros_like(reference))

    def move(self, v: np.ndarray, steps: int, integrator: str) -> Any:
        """Frames by step from the case's start with these velocities; or the refusal, before the run, as a string."""
        write_parameters(self.case, self.folder, steps, constraint_lines(self.case, self.of), integrator)
        write_coordinates(self.case, self.folder / "start.gro", np.array(self.case["start"]["positions_nm"], float), v)
        said = call(self.program, ["grompp", "-f", "run.mdp", "-p", "topol.top", "-c", "start.gro", "-r", "reference.gro",
                                   "-n", "index.ndx", "-o", "run.tpr", "-maxwarn", "20"], self.folder)
        if said:
            return said
        said = call(self.program, ["mdrun", "-s", "run.tpr", "-deffnm", "run", "-ntmpi", "1", "-ntomp", "1", "-nb", "cpu",
                                   "-pin", "off"], self.folder)
        if said and not (self.folder / "run.trr").exists():
            return said
        if said:
            raise EngineStopped(said)
        return read_trr(self.folder / "run.trr")

    def energies(self, steps: int) -> Dict[str, np.ndarray]:
        pulled = "pull = yes" in (self.folder / "run.mdp").read_text()
        call(self.program, ["energy", "-f", "run.edr", "-o", "e.xvg", "-dp", "-xvg", "none"], self.folder,
             "Potential\nKinetic-En.\nPressure\n" + "COM-Pull-En.\n" * pulled + "\n")
        *pull, potential, kinetic, pressure = np.loadtxt(self.folder / "e.xvg", ndmin=2)[:steps + 1, 1:].T
        # the pull's energy jumps where an atom leaves the box: that of the formula is taken
        return {"potential_kj_per_mol": potential - (pull[0] if pull else 0), "kinetic_kj_per_mol": kinetic,
                "pressure_bar": pressure}

    def degrees_of_freedom(self) -> int:
        said = run_program([self.program, "-quiet", "dump", "-s", "run.tpr"], self.folder).stdout
        return round(float(re.search(r"nrdf:\s*(\S+)", said).group(1)))


def run(case: Case, variant: str) -> Case:
    of = VARIANTS[variant]
    if wants_tensions_alone(case):
        return not_offered("the engine does not tell tensions")
    if not nearest_images(case):
        return not_offered("a bond goes to the nearest image, and this one does not")
    with tempfile.TemporaryDirectory() as name:
        try:
            return run_in(case, Gromacs(roomy(case), of, command(variant), Path(name)))
        except Unsayable as why:
            return not_offered(str(why))
        except EngineStopped as stopped:
            if wants_refusal(case):
                return {"refused": str(stopped)}
            raise


def run_in(case: Case, engine: Gromacs) -> Case:
    x, v, h, steps = (np.array(case["start"]["positions_nm"], float), start_velocities(case), case["run"]["step_ps"],
                      case["run"]["steps"])
    integrator = "sd" if "langevin" in case["run"] else "md"
    if integrator == "md" and steps:  # half a step back: a step of the motion turned round
        back = engine.move(-v - 0.5 * h * force_function(case)(x)[1] * inverse_masses(case)[:, None], 1, "md")
        if isinstance(back, str):
            return {"refused": back}
        v = -back[1][1]
    frames = engine.move(v, steps + 1, integrator)
    if isinstance(frames, str):
        return {"refused": frames}
    rows = row_steps(case)
    places = unwrap(engine.case, [frames[s][0] for s in range(steps + 1)]) - engine.case["shift"]
    speeds = [frames[s][1] if integrator != "md" else 0.5 * (frames[s][1] + frames[s + 1][1]) for s in rows]
    what, told, freedom = {ask["what"] for ask in case["asks"]}, {}, {}
    if what & {"pressure_bar", "energy_kj_per_mol", "energy_range_kj_per_mol", "drift_kt_per_ns_dof"}:
        told = {key: values[rows] for key, values in engine.energies(steps).items()}
        uniform = {"system": {**case["system"], "forces": [
            force for force in case["system"]["forces"] if force["kind"] in ("gravity", "constant_force")]}}
        told["potential_kj_per_mol"] = told["potential_kj_per_mol"] + [force_function(uniform)(places[s])[0] for s in rows]
    if "degrees_of_freedom" in what:
        freedom = {"degrees_of_freedom": engine.degrees_of_freedom()}
    if "box_nm" not in case["system"]:
        told.pop("pressure_bar", None)
    return {"rows": {"step": rows, "positions_nm": places[rows], "velocities_nm_per_ps": speeds, **told}, **freedom}
