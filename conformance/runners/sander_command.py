"""AmberTools's sander: SHAKE (ntc=2, by the list of bonds with hydrogen) under its leapfrog, in vacuum.

The list may name any bonds. sander's time is Å √(u/(kcal/mol)). Its velocities are half a step behind: a run starts from
that of half a step before, found by a step of its own backwards, and a row has the mean of the two around it, from
restart files in double precision, one a step. Frozen atoms, outer forces, boxes and thermostats are not written.
The command is `sander`, or what SANDER_COMMAND names.
"""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict

import numpy as np
from sander_files import read_restart, write_restart, write_topology

from forces import force_function
from programs import run_program
from shared import Case, EngineStopped, moving, not_offered, row_steps, start_velocities, wants_refusal

VARIANTS: Dict[str, Dict[str, Any]] = {"shake": {}}


def command() -> str:
    return os.environ.get("SANDER_COMMAND", "sander")


def describe(variant: str) -> Dict[str, str]:
    said = subprocess.run([command(), "--version"], capture_output=True, text=True, check=False)
    found = re.search(r"Version (\S+)", said.stdout + said.stderr)
    return {"engine": "AmberTools sander", "version": found.group(1) if found else "unknown",
            "settings": "ntc=2, ntf=1, tol of the case, jfastw=4; leapfrog, double precision"}


def move(case: Case, folder: Path, x: np.ndarray, v: np.ndarray, steps: int, tolerance: float) -> Dict[int, Any]:
    """Positions and the velocities half a step before, by step."""
    write_restart(folder / "inpcrd", x, v)
    (folder / "mdin").write_text(
        f"case\n &cntrl imin=0, irest=1, ntx=5, ntt=0, ntb=0, igb=6, cut=9999.0, nstlim={steps}, "
        f"dt={case['run']['step_ps']!r}, "
        f"ntc=2, ntf=1, tol={tolerance:.3e}, jfastw=4, vlimit=-1.0, nscm=0, ntpr={steps}, ntwr=-1, ntxo=2, ntwx=0, &end\n")
    done = run_program([command(), "-O", "-i", "mdin", "-p", "prmtop", "-c", "inpcrd", "-r", "restrt", "-o", "mdout"], folder)
    if done.returncode or not (folder / f"restrt_{steps}").exists():
        said = (folder / "mdout").read_text()[-400:] if (folder / "mdout").exists() else ""
        raise EngineStopped(" ".join((said + done.stdout + done.stderr).split())[-250:])
    return {step: read_restart(folder / f"restrt_{step}") for step in range(1, steps + 1)}


def run(case: Case, variant: str) -> Case:
    system = case["system"]
    for key, word in (("virtual_sites", "virtual sites of any weights"), ("box_nm", "boxes")):
        if key in system:
            return not_offered(f"{word} are not written by this runner")
    if "langevin" in case["run"] or not moving(case).all() and not wants_refusal(case):
        return not_offered("thermostats and frozen atoms are not written by this runner")
    tolerance = case["run"].get("bond_tolerance", 1e-10)
    x, v, h = np.array(case["start"]["positions_nm"], float), start_velocities(case), case["run"]["step_ps"]
    steps, rows = case["run"]["steps"], row_steps(case)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            write_topology(case, folder)
            turn = -v - 0.5 * h * force_function(case)(x)[1] / np.array(system["masses_u"])[:, None]
            before = -move(case, folder, x, turn, 1, tolerance)[1][1]
            frames = {0: (x, before), **move(case, folder, x, before, steps + 1, tolerance)}
        except NotImplementedError as why:
            return not_offered(str(why))
        except EngineStopped as stopped:
            if wants_refusal(case):
                return {"refused": str(stopped)}
            raise
    return {"rows": {"step": rows, "positions_nm": [frames[s][0] for s in rows],
                     "velocities_nm_per_ps": [0.5 * (frames[s][1] + frames[s + 1][1]) for s in rows]}}
