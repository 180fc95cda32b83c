"""A case as GROMACS's files: topology, coordinates with all digits, parameters; its commands called, its trajectory read."""

from __future__ import annotations

import re
import struct
from math import degrees
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

from shared import Case, clusters, moving, run_program, whole



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


def settle_molecules(case: Case) -> List[List[int]]:
    """Each water's atoms, the one of two equal bonds first; all that is no such water makes it Unsayable."""
    made = []
    bonds = {tuple(sorted(bond["atoms"])): bond["length_nm"] for bond in case["system"]["bonds"]}
    masses = case["system"]["masses_u"]
    for atoms in clusters(case):
        a, b, c = (*atoms, 0, 0)[:3]
        three = [bonds.get(tuple(sorted(pair))) for pair in ((a, b), (a, c), (b, c))]
        if len(atoms) != 3 or None in three or three[0] != three[1] or masses[b] != masses[c] or c - a != 2:
            raise Unsayable("[ settles ] holds molecules of three atoms with two equal bonds from the first, equal ends")
        made.append([a, b, c])
    if any(force["kind"].startswith(("harmonic_bond", "harmonic_angle", "periodic")) or "virtual_sites" in case["system"]
           for force in case["system"]["forces"]) or len(made) * 3 != len(masses):
        raise Unsayable("[ settles ] here: waters alone, without bonded forces or sites")
    return made


def molecule_type(case: Case, number: int, atoms: List[int], settled: bool, charges: List[float]) -> List[str]:
    system, at = case["system"], {atom: k + 1 for k, atom in enumerate(atoms)}
    lines = ["[ moleculetype ]", f"M{number} 0", "[ atoms ]"]
    sites = {site["atom"] for site in system.get("virtual_sites", [])}
    for atom in atoms:  # a frozen atom's mass counts nowhere
        mass = system["masses_u"][atom] or (0 if atom in sites else 1)
        lines.append(f"{at[atom]} T{atom} 1 R A{at[atom]} {at[atom]} {charges[atom]:.17g} {mass:.17g}")
    bonds = [bond for bond in system["bonds"] if bond["atoms"][0] in at]
    if settled:
        lengths = {tuple(sorted(bond["atoms"])): bond["length_nm"] for bond in bonds}
        a, b, c = atoms
        lines += ["[ settles ]", f"1 1 {lengths[a, b]:.17g} {lengths[b, c]:.17g}"]
    elif bonds:
        lines += ["[ constraints ]", *[f"{at[bond['atoms'][0]]} {at[bond['atoms'][1]]} 2 {bond['length_nm']:.17g}"
                                       for bond in bonds]]
    for site in system.get("virtual_sites", []):
        rest = " ".join(f"{w:.17g}" for w in site["weights"][1:])
        of = " ".join(str(at[a]) for a in site["of"])
        lines += [f"[ virtual_sites{len(site['of'])} ]", f"{at[site['atom']]} {of} 1 {rest}"]
    for force in system["forces"]:
        of, kind = force.get("atoms", [force.get("atom")]), force["kind"]
        here = " ".join(str(at[a]) for a in of if a in at)
        if kind == "harmonic_bond":
            lines += ["[ bonds ]", f"{here} 6 {force['length_nm']:.17g} {force['k_kj_per_mol_nm2']:.17g}"]
        elif kind == "harmonic_angle":
            lines += ["[ angles ]", f"{here} 1 {degrees(force['angle_rad']):.17g} {force['k_kj_per_mol_rad2']:.17g}"]
        elif kind == "periodic_torsion":
            lines += ["[ dihedrals ]", f"{here} 9 {degrees(force['phase_rad']):.17g} {force['k_kj_per_mol']:.17g} "
                                       f"{force['periodicity']}"]
        elif kind == "harmonic_position" and of[0] in at:
            if of[0] in sites:
                raise Unsayable("no position restraints on virtual sites")
            lines += ["[ position_restraints ]", f"{here} 1 " + 3 * f"{force['k_kj_per_mol_nm2']:.17g} "]
        elif kind == "nonbonded":
            pairs = [pair for pair in force["excluded"] if pair[0] in at]
            lines += ["[ exclusions ]", *[f"{at[i]} {at[j]}" for i, j in pairs]] if pairs else []
    return lines


def write_topology(case: Case, folder: Path, settled: bool) -> None:
    count = len(case["system"]["masses_u"])
    charges, sigma, epsilon = [[0.0] * count for _ in range(3)]
    for force in case["system"]["forces"]:
        if force["kind"] == "nonbonded":
            charges, sigma, epsilon = force["charges_e"], force["sigma_nm"], force["epsilon_kj_per_mol"]
    lines = ["[ defaults ]", "1 2 no 1 1", "[ atomtypes ]"]
    lines += [f"T{i} 1 0 A {sigma[i]:.17g} {epsilon[i]:.17g}" for i in range(count)]
    molecules = settle_molecules(case) if settled else [list(range(count))]
    lines += molecule_type(case, 0, molecules[0], settled, charges)
    if settled:  # GROMACS allows one kind of settled molecule: all are the first
        if len(molecules) > 1 and any(force["kind"] == "harmonic_position" for force in case["system"]["forces"]):
            raise Unsayable("[ settles ] of one kind of molecule alone, all restrained or none")
        columns = (case["system"]["masses_u"], charges, sigma, epsilon)
        if any([values[a] for a in atoms] != [values[a] for a in molecules[0]] for values in columns for atoms in molecules):
            raise Unsayable("[ settles ] of one kind of molecule alone")
    lines += ["[ system ]", "a case", "[ molecules ]", f"M0 {len(molecules)}"]
    (folder / "topol.top").write_text("\n".join(lines) + "\n")


def write_coordinates(case: Case, path: Path, x: np.ndarray, v: np.ndarray) -> None:
    lines = ["a case", str(len(x))]
    for i, (at, moves) in enumerate(zip(x, v), 1):
        lines.append(f"{1:5d}{'R':<5}{'A':>5}{i % 100000:5d}" + "".join(f"{c:20.14f}" for c in at)
                     + "".join(f"{c:20.15f}" for c in moves))
    box = case["system"]["box_nm"]
    order = [box[0][0], box[1][1], box[2][2], box[0][1], box[0][2], box[1][0], box[1][2], box[2][0], box[2][1]]
    lines.append(" ".join(f"{value:.15f}" for value in order))
    path.write_text("\n".join(lines) + "\n")


def pull_lines(case: Case, groups: Dict[str, List[int]]) -> List[str]:
    """Gravity pulls at the centre of all moving atoms, a constant force at one: coordinates of constant force."""
    pulls = []
    masses = np.array(case["system"]["masses_u"], dtype=float)
    for force in case["system"]["forces"]:
        if force["kind"] == "gravity":
            atoms = [int(a) for a in np.nonzero(moving(case))[0]]
            pulls.append((atoms, masses.sum() * np.array(force["acceleration_nm_per_ps2"], dtype=float)))
        elif force["kind"] == "constant_force":
            if masses[force["atom"]] == 0:
                raise Unsayable("no constant force on a virtual site")
            pulls.append(([force["atom"]], np.array(force["force_kj_per_mol_nm"], dtype=float)))
        elif force["kind"] == "external":
            raise Unsayable("no forces by formula")
    if not pulls:
        return []
    lines = ["pull = yes", f"pull-ngroups = {len(pulls)}", f"pull-ncoords = {len(pulls)}", "pull-nstxout = 0",
             "pull-nstfout = 0"]
    for n, (atoms, pull) in enumerate(pulls, 1):
        size = float(np.linalg.norm(pull))
        groups[f"pull{n}"] = atoms
        three = " ".join(f"{c:.17g}" for c in pull / size)
        lines += [f"pull-group{n}-name = pull{n}", f"pull-coord{n}-type = constant-force", f"pull-coord{n}-k = {-size:.17g}",
                  f"pull-coord{n}-geometry = direction-periodic", f"pull-coord{n}-groups = 0 {n}", f"pull-coord{n}-vec = {three}"]
    return lines


def write_parameters(case: Case, folder: Path, steps: int, held: List[str], integrator: str) -> None:
    run, count = case["run"], len(case["system"]["masses_u"])
    groups = {"System": list(range(count))}
    lines = [f"integrator = {integrator}", f"dt = {run['step_ps']:.17g}", f"nsteps = {steps}", "comm-mode = None",
             "nstxout = 1", "nstvout = 1", "nstenergy = 1", "nstcalcenergy = 1", "nstlog = 0", "cutoff-scheme = Verlet",
             "verlet-buffer-tolerance = -1", "nstlist = 1", "tcoupl = no", "pcoupl = no", "constraints = none", *held,
             "vdw-modifier = None", "coulomb-modifier = None"]
    cut, dielectric = case["cutoff"], 1.0
    for force in case["system"]["forces"]:
        if force["kind"] == "nonbonded":
            cut = force.get("cutoff_nm", cut)
            dielectric = force.get("solvent_dielectric", 78.3) if "cutoff_nm" in force else 1.0
    lines += ["coulombtype = Reaction-Field", "epsilon-rf = %.17g" % dielectric,
              *[f"{key} = {cut:.17g}" for key in ("rlist", "rcoulomb", "rvdw")]]
    try:
        whole(case)
    except ValueError:
        lines.append("periodic-molecules = yes")
    if "langevin" in run:
        bath = run["langevin"]
        lines += ["tc-grps = System", f"ref-t = {bath['temperature_k']:.17g}", f"tau-t = {1 / bath['friction_per_ps']:.17g}",
                  f"ld-seed = {run.get('seed', 1)}"]
    sites = {site["atom"] for site in case["system"].get("virtual_sites", [])}
    frozen = [i for i in range(count) if not moving(case)[i] and i not in sites]
    if frozen:
        groups["Frozen"] = frozen
        lines += ["freezegrps = Frozen", "freezedim = Y Y Y"]
    lines += pull_lines(case, groups)
    (folder / "run.mdp").write_text("\n".join(lines) + "\n")
    text = [f"[ {name} ]\n{' '.join(str(a + 1) for a in atoms)}" for name, atoms in groups.items()]
    (folder / "index.ndx").write_text("\n".join(text) + "\n")


def read_trr(path: Path) -> Dict[int, Any]:
    """Positions and velocities by step, of a file of single or double precision."""
    data, at, frames = path.read_bytes(), 0, {}
    while at < len(data):
        sizes = struct.unpack(">13i", data[at + 24 : at + 76])
        count, step = sizes[10], sizes[11]
        real = ">f8" if sizes[7] == 24 * count else ">f4"
        at += 76 + 2 * int(real[-1]) + sum(sizes[:7])
        arrays = []
        for size in sizes[7:10]:
            arrays.append(np.frombuffer(data[at : at + size], real).reshape(-1, 3).astype(float))
            at += size
        frames[step] = arrays[:2]
    return frames


def call(program: str, arguments: List[str], folder: Path, typed: str = "") -> str:
    """The error that GROMACS says, empty if it has none."""
    done = run_program([program, "-quiet", *arguments], folder, typed, GMX_MAXBACKUP="-1")
    if done.returncode == 0:
        return ""
    said = re.search(r"(?:Fatal error|Error in user input|Inconsistency[^:]*|ERROR \d[^:]*):\s*\n(.*?)\n\n", done.stderr, re.S)
    return " ".join((said.group(1) if said else done.stderr[-400:]).split())
