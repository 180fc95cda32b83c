"""A case's forces and run as GROMACS's parameters: the box it wants, outer forces as pull coordinates."""

from __future__ import annotations

from pathlib import Path
from typing import Dict, List

import numpy as np

from shared import Case, digits, masses_of, moving, whole


class Unsayable(Exception):
    """GROMACS has no words for something in the case."""


def roomy(case: Case) -> Case:
    """The case in a periodic box, which GROMACS wants: without one of its own, in the middle of a wide one.

    The cutoff reaches all atoms with half as much room again; the box is wider than twice that.
    """
    x = np.array(case["start"]["positions_nm"], dtype=float)
    if "box_nm" in case["system"]:
        return {**case, "shift": np.zeros(3), "cutoff": 0.3}
    reach = 1.5 * float(np.linalg.norm(np.ptp(x, axis=0))) + 1.0
    edge = 2.5 * reach
    shift = edge / 2 - 0.5 * (x.min(axis=0) + x.max(axis=0))
    return {**case, "system": {**case["system"], "box_nm": (edge * np.eye(3)).tolist()},
            "start": {**case["start"], "positions_nm": (x + shift).tolist()}, "shift": shift, "cutoff": reach}


def nonbonded_of(case: Case) -> Case:
    """Its nonbonded forces; none."""
    nothing = [0.0] * len(case["system"]["masses_u"])
    none = {"charges_e": nothing, "sigma_nm": nothing, "epsilon_kj_per_mol": nothing, "excluded": []}
    return next((force for force in case["system"]["forces"] if force["kind"] == "nonbonded"), none)


def pull_lines(case: Case, groups: Dict[str, List[int]]) -> List[str]:
    """Gravity pulls at the centre of all moving atoms, a constant force at one: coordinates of constant force."""
    lines, masses = [], masses_of(case)
    for force in case["system"]["forces"]:
        if force["kind"] == "external":
            raise Unsayable("no forces by formula")
        if force["kind"] not in ("gravity", "constant_force"):
            continue
        atoms = [force["atom"]] if "atom" in force else np.nonzero(masses)[0].tolist()
        if not masses[atoms[0]]:
            raise Unsayable("no constant force on a virtual site")
        vector = np.array(force.get("force_kj_per_mol_nm") or masses.sum() * np.array(force["acceleration_nm_per_ps2"]))
        size, n = float(np.linalg.norm(vector)), len(groups)
        groups[f"pull{n}"] = atoms
        lines += [f"pull-group{n}-name = pull{n}", f"pull-coord{n}-type = constant-force", f"pull-coord{n}-k = {digits(-size)}",
                  f"pull-coord{n}-geometry = direction-periodic", f"pull-coord{n}-groups = 0 {n}",
                  f"pull-coord{n}-vec = {digits(*vector / size)}"]
    count = len(lines) // 6
    return ["pull = yes", f"pull-ngroups = {count}", f"pull-ncoords = {count}", "pull-nstxout = 0", "pull-nstfout = 0",
            *lines] if lines else []


def write_parameters(case: Case, folder: Path, steps: int, held: List[str], integrator: str) -> None:
    run, groups, pairs = case["run"], {"System": list(range(len(masses_of(case))))}, nonbonded_of(case)
    dielectric = pairs.get("solvent_dielectric", 78.3) if "cutoff_nm" in pairs else 1
    lines = [f"integrator = {integrator}", f"dt = {digits(run['step_ps'])}", f"nsteps = {steps}", "comm-mode = None",
             "nstxout = 1", "nstvout = 1", "nstenergy = 1", "nstcalcenergy = 1", "nstlog = 0", "cutoff-scheme = Verlet",
             "verlet-buffer-tolerance = -1", "nstlist = 1", "tcoupl = no", "pcoupl = no", "constraints = none", *held,
             "vdw-modifier = None", "coulomb-modifier = None", "coulombtype = Reaction-Field",
             f"epsilon-rf = {digits(dielectric)}",
             *[f"{key} = {digits(pairs.get('cutoff_nm', case['cutoff']))}" for key in ("rlist", "rcoulomb", "rvdw")]]
    try:
        whole(case)
    except ValueError:
        lines.append("periodic-molecules = yes")
    if "langevin" in run:
        bath = run["langevin"]
        lines += ["tc-grps = System", f"ref-t = {digits(bath['temperature_k'])}",
                  f"tau-t = {digits(1 / bath['friction_per_ps'])}", f"ld-seed = {run.get('seed', 1)}"]
    lines += pull_lines(case, groups)
    frozen = set(np.nonzero(~moving(case))[0].tolist()) - {site["atom"] for site in case["system"].get("virtual_sites", [])}
    if frozen:
        groups["Frozen"] = sorted(frozen)
        lines += ["freezegrps = Frozen", "freezedim = Y Y Y"]
    (folder / "run.mdp").write_text("\n".join(lines) + "\n")
    text = [f"[ {name} ]\n{' '.join(str(a + 1) for a in atoms)}" for name, atoms in groups.items()]
    (folder / "index.ndx").write_text("\n".join(text) + "\n")
