"""A case as GROMACS's topology and coordinates with all digits; its commands called, its trajectory read."""

from __future__ import annotations

import re
import struct
from math import degrees
from pathlib import Path
from typing import Any, Dict, List

import numpy as np

from gromacs_parameters import Unsayable, nonbonded_of
from programs import run_program
from shared import Case, clusters, digits, masses_of, whole


# Section, GROMACS's number of the function, its parameters.
BONDED: Dict[str, Any] = {
    "harmonic_bond": ("bonds", 6, lambda of: (of["length_nm"], of["k_kj_per_mol_nm2"])),
    "harmonic_angle": ("angles", 1, lambda of: (degrees(of["angle_rad"]), of["k_kj_per_mol_rad2"])),
    "periodic_torsion": ("dihedrals", 9, lambda of: (degrees(of["phase_rad"]), of["k_kj_per_mol"], of["periodicity"])),
    "harmonic_position": ("position_restraints", 1, lambda of: 3 * [of["k_kj_per_mol_nm2"]])}


def settle_molecules(case: Case) -> List[List[int]]:
    """Each water's atoms, the one of two equal bonds first: GROMACS allows one kind, which all must be of."""
    try:
        whole(case)
    except ValueError as why:
        raise Unsayable(f"SETTLE holds triangles, not {why}") from None
    system, pairs, made = case["system"], nonbonded_of(case), clusters(case)
    lengths = {tuple(sorted(bond["atoms"])): bond["length_nm"] for bond in system["bonds"]}
    columns = [system["masses_u"], *[pairs[key] for key in ("charges_e", "sigma_nm", "epsilon_kj_per_mol")]]
    kinds = {(*[lengths.get((a[i], a[j])) for i, j in ((0, 1), (0, 2), (1, 2))],
              *[values[k] for values in columns for k in a]) if len(a) == 3 == a[2] - a[0] + 1 else (None,) for a in made}
    first, bonded = next(iter(kinds), (None,)), {force["kind"] for force in system["forces"]} & set(BONDED)
    unfit = bonded - {"harmonic_position"} or (bonded and len(made) > 1)
    if (len(kinds) != 1 or None in first or first[0] != first[1] or first[4] != first[5]
            or len(system["masses_u"]) != 3 * len(made) or unfit or "virtual_sites" in system):
        raise Unsayable("[ settles ] holds waters of one kind, two equal bonds from the first atom to equal ends")
    return made


def molecule_type(case: Case, atoms: List[int], settled: bool) -> List[str]:
    system, at, charges = case["system"], {atom: k + 1 for k, atom in enumerate(atoms)}, nonbonded_of(case)["charges_e"]
    lines = ["[ moleculetype ]", "M0 0", "[ atoms ]"]
    sites = {site["atom"] for site in system.get("virtual_sites", [])}
    for atom in atoms:  # a frozen atom's mass counts nowhere
        mass = system["masses_u"][atom] or (0 if atom in sites else 1)
        lines.append(f"{at[atom]} T{atom} 1 R A{at[atom]} {at[atom]} {digits(charges[atom], mass)}")
    bonds = [(at[i], at[j], bond["length_nm"]) for bond in system["bonds"] for i, j in [sorted(bond["atoms"])] if i in at]
    if settled:
        lengths = {(i, j): d for i, j, d in bonds}
        lines += ["[ settles ]", f"1 1 {digits(lengths[1, 2], lengths[2, 3])}"]
    elif bonds:
        lines += ["[ constraints ]", *[f"{i} {j} 2 {digits(d)}" for i, j, d in bonds]]
    for site in system.get("virtual_sites", []):
        of = " ".join(str(at[a]) for a in (site["atom"], *site["of"]))
        lines += [f"[ virtual_sites{len(site['of'])} ]", f"{of} 1 {digits(*site['weights'][1:])}"]
    for force in system["forces"]:
        of = force.get("atoms", [force.get("atom")])
        if force["kind"] in BONDED and of[0] in at:
            if force["kind"] == "harmonic_position" and of[0] in sites:
                raise Unsayable("no position restraints on virtual sites")
            section, function, numbers = BONDED[force["kind"]]
            lines += [f"[ {section} ]", f"{' '.join(str(at[a]) for a in of)} {function} {digits(*numbers(force))}"]
    pairs = [f"{at[i]} {at[j]}" for i, j in nonbonded_of(case)["excluded"] if i in at]
    return lines + ["[ exclusions ]", *pairs] * bool(pairs)


def write_topology(case: Case, folder: Path, settled: bool) -> None:
    molecules = settle_molecules(case) if settled else [list(range(len(masses_of(case))))]
    pairs = nonbonded_of(case)
    types = [f"T{i} 1 0 A {digits(*of)}" for i, of in enumerate(zip(pairs["sigma_nm"], pairs["epsilon_kj_per_mol"]))]
    lines = ["[ defaults ]", "1 2 no 1 1", "[ atomtypes ]", *types, *molecule_type(case, molecules[0], settled),
             "[ system ]", "a case", "[ molecules ]", f"M0 {len(molecules)}"]
    (folder / "topol.top").write_text("\n".join(lines) + "\n")


def write_coordinates(case: Case, path: Path, x: np.ndarray, v: np.ndarray) -> None:
    lines = [f"{1:5d}{'R':<5}{'A':>5}{i % 100000:5d}" + "".join(f"{c:20.14f}" for c in at)
             + "".join(f"{c:20.15f}" for c in moves) for i, (at, moves) in enumerate(zip(x, v), 1)]
    (a, ab, ac), (ba, b, bc), (ca, cb, c) = case["system"]["box_nm"]
    box = " ".join(f"{value:.15f}" for value in (a, b, c, ab, ac, ba, bc, ca, cb))
    path.write_text("\n".join(["a case", str(len(x)), *lines, box]) + "\n")


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
