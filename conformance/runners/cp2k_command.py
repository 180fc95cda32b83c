"""CP2K: collective constraints of distances under its velocity Verlet with RATTLE, forces of the FIST method.

Springs, tethers, gravity and forces by formula are restraints and external potentials. The runner writes no nonbonded
forces, torsions and boxes, which CP2K has. The command is `cp2k`, or what CP2K_COMMAND names.
"""

from __future__ import annotations

import functools
import os
import re
import subprocess
import tempfile
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

from programs import run_program
from shared import Case, EngineStopped, moving, not_offered, row_steps, start_velocities, wants_refusal

VARIANTS: Dict[str, Dict[str, Any]] = {"rattle": {}}
BOHR, HARTREE, AU_TIME = 0.0529177210903, 2625.4996394799, 2.4188843265857e-5  # nm, kJ/mol, ps
SPEED = BOHR / AU_TIME


def command() -> str:
    return os.environ.get("CP2K_COMMAND", "cp2k")


@functools.lru_cache(maxsize=None)
def version() -> str:
    said = subprocess.run([command(), "--version"], capture_output=True, text=True, check=False).stdout
    found = re.search(r"CP2K version (\S+)", said)
    return found.group(1) if found else "unknown"


def describe(variant: str) -> Dict[str, str]:
    return {"engine": "CP2K", "version": version(),
            "settings": "COLLECTIVE DISTANCE constraints, SHAKE_TOLERANCE of the case, ENSEMBLE NVE, double precision"}


def potential(atoms: List[int], formula: str) -> List[str]:
    """An external potential in Hartree of X, Y and Z in Bohr."""
    return ["&EXTERNAL_POTENTIAL", f"ATOMS_LIST {' '.join(str(a + 1) for a in atoms)}", f"FUNCTION {formula}", "&END"]


def force_lines(case: Case, colvars: List[str], held: List[str]) -> List[str]:
    lines: List[str] = []
    masses = np.array(case["system"]["masses_u"], dtype=float)
    linear = "-1.0*(({:.15E})*X+({:.15E})*Y+({:.15E})*Z)".format
    for force in case["system"]["forces"]:
        kind = force["kind"]
        if kind == "gravity":
            for mass in sorted(set(masses[masses > 0])):
                pull = mass * np.array(force["acceleration_nm_per_ps2"]) * BOHR / HARTREE
                lines += potential([int(i) for i in np.nonzero(masses == mass)[0]], linear(*pull))
        elif kind == "constant_force":
            lines += potential([force["atom"]], linear(*np.array(force["force_kj_per_mol_nm"]) * BOHR / HARTREE))
        elif kind == "harmonic_position":
            k, c = force["k_kj_per_mol_nm2"] * BOHR**2 / HARTREE / 2, np.array(force["centre_nm"]) / BOHR
            lines += potential([force["atom"]], f"({k:.15E})*" + "((X-({:.15E}))^2+(Y-({:.15E}))^2+(Z-({:.15E}))^2)".format(*c))
        elif kind == "external":
            formula = re.sub(r"\b([xyz])\b", rf"(\1*{BOHR!r})", force["energy_kj_per_mol"]).upper()
            lines += potential(force["atoms"], f"({formula})/{HARTREE!r}")
        else:
            raise NotImplementedError(f"{kind} is not written by this runner")
    return lines


def write_input(case: Case, folder: Path, tolerance: float) -> None:
    system, run = case["system"], case["run"]
    masses, x = np.array(system["masses_u"], dtype=float), np.array(case["start"]["positions_nm"], dtype=float)
    colvars: List[str] = []
    held: List[str] = []
    for k, bond in enumerate(system["bonds"], 1):
        colvars += ["&COLVAR", "&DISTANCE", "ATOMS {} {}".format(*(a + 1 for a in bond["atoms"])), "&END", "&END"]
        held += ["&COLLECTIVE", f"COLVAR {k}", "INTERMOLECULAR", f"TARGET {bond['length_nm'] / BOHR:.16E}", "&END"]
    frozen = np.nonzero(~moving(case))[0]
    if frozen.size:
        held += ["&FIXED_ATOMS", f"LIST {' '.join(str(i + 1) for i in frozen)}", "&END"]
    external = force_lines(case, colvars, held)
    kinds = [line for i, mass in enumerate(masses) for line in
             (f"&KIND K{i}", "ELEMENT H", f"MASS {mass if mass != 0 or wants_refusal(case) else 1:.16E}", "&END")]
    charges = [line for i in range(len(masses)) for line in ("&CHARGE", f"ATOM K{i}", "CHARGE 0", "&END")]
    steps = row_steps(case)
    every = int(np.gcd.reduce(steps)) or 1
    three = "{:.16E} {:.16E} {:.16E}".format
    edge = 100 * (1 + float(np.abs(x).max()))
    lines = ["&GLOBAL", "PROJECT c", "RUN_TYPE MD", "PRINT_LEVEL LOW", "&END", "&MOTION", "&MD", "ENSEMBLE NVE",
             f"STEPS {run['steps']}", f"TIMESTEP [au_t] {run['step_ps'] / AU_TIME:.16E}", "TEMPERATURE 0", "&PRINT", "&PROGRAM_RUN_INFO OFF",
             "&END", "&END", "&END"]
    if held:
        lines += ["&CONSTRAINT", f"SHAKE_TOLERANCE {tolerance:.1E}", *held, "&END"]
    lines += ["&PRINT"]
    for what, unit in (("TRAJECTORY", "bohr"), ("VELOCITIES", "bohr*au_t^-1")):
        lines += [f"&{what}", f"UNIT {unit}", "&EACH", f"MD {every}", "&END", "&END"]
    lines += ["&END", "&END", "&FORCE_EVAL", "METHOD FIST", "&MM", "&FORCEFIELD", "DO_NONBONDED FALSE", *charges, "&END", "&POISSON",
              "PERIODIC NONE", "&EWALD", "EWALD_TYPE NONE", "&END", "&END", "&END", *external, "&SUBSYS", "&CELL",
              f"ABC [nm] {edge} {edge} {edge}", "PERIODIC NONE", "&END", "&TOPOLOGY", "CONNECTIVITY OFF", "&END", *kinds, *colvars,
              "&COORD", "UNIT bohr", *[f"K{i} {three(*at / BOHR)}" for i, at in enumerate(x)], "&END",
              "&VELOCITY", *[three(*v / SPEED) for v in start_velocities(case)], "&END", "&END", "&END"]
    (folder / "c.inp").write_text("\n".join(lines) + "\n")


def read_frames(path: Path, count: int, scale: float) -> Dict[int, np.ndarray]:
    lines, frames = path.read_text().splitlines(), {}
    for k in range(0, len(lines), count + 2):
        step = int(re.search(r"i = *(\d+)", lines[k + 1]).group(1))
        frames[step] = scale * np.array([line.split()[1:4] for line in lines[k + 2 : k + 2 + count]], dtype=float)
    return frames


def run(case: Case, variant: str) -> Case:
    for key, word in (("virtual_sites", "virtual sites"), ("box_nm", "boxes")):
        if key in case["system"]:
            return not_offered(f"{word} are not written by this runner")
    if "langevin" in case["run"]:
        return not_offered("no Langevin thermostat with constraints")
    tolerance = case["run"].get("bond_tolerance", 1e-10)
    with tempfile.TemporaryDirectory() as name:
        folder, count = Path(name), len(case["system"]["masses_u"])
        try:
            write_input(case, folder, tolerance)
        except NotImplementedError as why:
            return not_offered(str(why))
        done = run_program([command(), "-i", "c.inp"], folder, OMPI_ALLOW_RUN_AS_ROOT="1",
                           OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        if done.returncode:
            said = " ".join(re.sub(r"[*_|/\\]+", " ", " ".join(done.stdout.splitlines()[-25:])).split())[-300:]
            if wants_refusal(case) or not (folder / "c-1.ener").exists():
                return {"refused": said}
            raise EngineStopped(said)
        x = read_frames(folder / "c-pos-1.xyz", count, BOHR)
        v = read_frames(folder / "c-vel-1.xyz", count, SPEED)
        energy = {int(row[0]): row for row in np.loadtxt(folder / "c-1.ener", ndmin=2)}
    rows = row_steps(case)
    return {"rows": {"step": rows, "positions_nm": [x[s] for s in rows], "velocities_nm_per_ps": [v[s] for s in rows],
                     "potential_kj_per_mol": [energy[s][4] * HARTREE for s in rows]}}
