"""LAMMPS: fix shake, fix rattle, fix rigid and, in taut-lammps, fix taut, under fix nve.

fix shake and fix rattle hold stars of up to four atoms and triangles of two equal bonds; fix rigid holds what its bonds
make a rigid body. The command is `lmp`, or what LAMMPS_COMMAND names (TAUT_LAMMPS_COMMAND for fix taut);
`rattle_older` is always run by `lmp`."""

from __future__ import annotations

import functools
import math
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, List

import numpy as np
from lammps_input import Unsayable, write_case

from forces import force_function
from programs import run_program
from shared import (
    BAR, clusters, is_rigid, moving, nearest_images, not_offered, row_steps, tensions_from, wants_refusal, whole)

VARIANTS: Dict[str, Dict[str, Any]] = {
    "shake": {"fix": "shake"},
    "rattle": {"fix": "rattle"},
    "rattle_older": {"fix": "rattle", "older": True},
    "rigid": {"fix": "rigid"},
    "rigid_small": {"fix": "rigid/nve/small"},
    "taut": {"fix": "taut"},
}
Case = Dict[str, Any]


def command(variant: str) -> str:
    if VARIANTS[variant]["fix"] == "taut":
        return os.environ.get("TAUT_LAMMPS_COMMAND", "taut-lammps")
    return "lmp" if "older" in VARIANTS[variant] else os.environ.get("LAMMPS_COMMAND", "lmp")


@functools.lru_cache(maxsize=None)
def version_of(program: str) -> str:
    said = subprocess.run([program, "-h"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"Simulator - (.*)", said)
    return found.group(1).strip() if found else "unknown"


def describe(variant: str) -> Dict[str, str]:
    of = VARIANTS[variant]
    iterated = ", tolerance of the case, up to 1000 iterations"
    held = {"shake": iterated, "rattle": iterated, "taut": " feedforward"}.get(of["fix"], "")
    return {"engine": "LAMMPS" + (" with taut's fix" if of["fix"] == "taut" else ""),
            "version": version_of(command(variant)), "settings": f"fix {of['fix']}{held}" +
            ("" if "rigid/nve" in of["fix"] else ", fix nve") + ", double precision"}


def unfit(case: Case, fix: str) -> str:
    """What keeps this fix from the case, by its manual; empty if nothing does."""
    system = case["system"]
    if "virtual_sites" in system:
        return "no virtual sites"
    if not moving(case).all():
        return "no atoms without mass, and bonds to frozen atoms are not held"
    if not nearest_images(case):
        return "a bond goes to the nearest image, and this one does not"
    try:
        whole(case)
    except ValueError as spans:
        if "rigid" in fix:
            return str(spans)
    for atoms in clusters(case) if fix != "taut" else []:
        held = [bond for bond in system["bonds"] if bond["atoms"][0] in atoms]
        ends = [sum(a in bond["atoms"] for bond in held) for a in atoms]
        lengths = {bond["length_nm"] for bond in held}
        if "rigid" in fix and not is_rigid(case, atoms):
            return "fix rigid holds only rigid bodies"
        star = len(held) == len(atoms) - 1 <= 3 and max(ends) == len(held)
        if "rigid" not in fix and not star and not (len(atoms) == 3 == len(held) and len(lengths) < 3):
            return f"fix {fix} holds stars of up to four atoms, and triangles with two equal bonds"
    return ""


def constraint_lines(made: Dict[str, Any], case: Case, of: Dict[str, Any]) -> List[str]:
    fix, rigid = of["fix"], made["rigid"]
    if "rigid" in fix:
        held = " ".join(str(i + 1) for i, m in enumerate(made["molecules"]) if any(
            i in bond["atoms"] for bond in case["system"]["bonds"]))
        return [f"group held id {held}", "group lone subtract all held", "fix move lone nve",
                f"fix hold held {fix} molecule"]
    kinds = " ".join(f"{letter} {' '.join(map(str, sorted(rigid[section])))}"
                     for letter, section in (("b", "Bonds"), ("a", "Angles")) if rigid[section])
    if fix == "taut":
        return ["fix move all nve", f"fix hold all taut feedforward {kinds}"] if kinds else ["fix move all nve"]
    tolerance = case["run"].get("bond_tolerance", 1e-10)
    return ["fix move all nve"] + ([f"fix hold all {fix} {tolerance:g} 1000 0 {kinds}"] if kinds else [])


def run(case: Case, variant: str) -> Case:
    of = VARIANTS[variant]
    reason = "" if wants_refusal(case) else unfit(case, of["fix"])
    if reason:
        return not_offered(reason)
    with tempfile.TemporaryDirectory() as name:
        folder, steps, rows = Path(name), case["run"]["steps"], row_steps(case)
        try:
            shift = whole(case) if "rigid" in of["fix"] else 0  # fix rigid goes by the atoms' images
            made = write_case(case, folder, shift)
        except Unsayable as why:
            return not_offered(str(why))
        every = math.gcd(*rows) or 1
        hold = constraint_lines(made, case, of)
        lines = [*made["lines"], *hold, f"timestep {case['run']['step_ps']:.17g}", f"thermo {every}",
                 "compute_modify thermo_temp extra/dof 0", "thermo_style custom step pe press temp ke",
                 "thermo_modify norm no lost error format float %.17g",
                 f"dump d all custom {every} dump id xu yu zu vx vy vz fx fy fz",
                 "dump_modify d sort id format float %.17g first yes", f"run {steps}", "undump d",
                 "velocity all create 1.0 4711", "run 0"]
        (folder / "in").write_text("\n".join(lines) + "\n")
        done = run_program([command(variant), "-in", "in", "-log", "log"], folder)
        if done.returncode or "ERROR" in done.stdout:
            said = re.findall(r"ERROR.*", done.stdout + done.stderr)
            why = said[0] if said else (done.stderr or done.stdout)[-300:]
            limits = "Unrecognized" in why or "Too many groups" in why  # this build has no such style; 32 groups at most
            return not_offered(why) if limits else {"refused": why}
        return read(case, folder, rows, shift, of["fix"] in ("shake", "taut"))


def read(case: Case, folder: Path, rows: List[int], shift: Any, told: bool) -> Case:
    text, count = (folder / "dump").read_text(), len(case["system"]["masses_u"])
    frames = {int(part.split("\n", 1)[0]): np.array(part.split("ITEM: ATOMS")[1].split("\n", 1)[1].split(), dtype=float)
              .reshape(count, -1) for part in text.split("ITEM: TIMESTEP\n")[1:]}
    thermo = {}
    for line in (folder / "log").read_text().splitlines():
        if re.fullmatch(r"\s*\d+( +[-+.\dena]+){4}\s*", line):
            step, *last = (float(word) for word in line.split())
            thermo.setdefault(int(step), last)
    out: Dict[str, Any] = {"step": rows, "positions_nm": [frames[s][:, 1:4] - shift for s in rows],
                           "velocities_nm_per_ps": [frames[s][:, 4:7] for s in rows],
                           "potential_kj_per_mol": [thermo[s][0] for s in rows]}
    if "box_nm" in case["system"]:
        out["pressure_bar"] = [thermo[s][1] * BAR for s in rows]
    if told:  # these fixes add the forces of constraint to the others, which are known
        forces = force_function(case)
        out["tensions_kj_per_mol_nm"] = [
            tensions_from(case, frames[s][:, 1:4], frames[s][:, 7:10] - forces(frames[s][:, 1:4])[1]) for s in rows]
    return {"rows": out, "degrees_of_freedom": round(2 * last[3] / last[2])}
