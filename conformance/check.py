#!/usr/bin/env python3
"""Checks all cases by schema.json, and what a schema cannot say: sizes, names, starts that fulfil their bonds; and that
results are of what the cases ask today."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, Dict, Iterator, List, Tuple

import jsonschema
import numpy as np

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from keeping import read_results  # noqa: E402  (its folder is no package)
from quantities import bond_vectors  # noqa: E402

LARGEST_FILE = 30_000  # bytes


def find_faults(path: Path, validator: Any) -> List[str]:
    text = path.read_text(encoding="utf-8")
    case = json.loads(text)
    faults = [f"{'/'.join(map(str, error.absolute_path))}: {error.message[:200]}"
              for error in validator.iter_errors(case)]
    if faults:
        return faults
    if len(text) > LARGEST_FILE:
        faults.append(f"{len(text)} bytes, at most {LARGEST_FILE}")
    if case["name"] != path.stem:
        faults.append(f"the name {case['name']} is not the file's")
    return faults + find_faults_of_numbers(case)


def find_faults_of_numbers(case: Dict[str, Any]) -> List[str]:
    system, start = case["system"], case["start"]
    n = len(system["masses_u"])
    faults = [f"{key} has {len(start[key])} atoms, masses_u {n}"
              for key in ("positions_nm", "velocities_nm_per_ps") if key in start and len(start[key]) != n]
    faults += [f"{place} names atom {atom} of {n}" for place, atoms in atoms_named(case) for atom in atoms if atom >= n]
    faults += find_faults_of_system(system)
    for number, ask in enumerate(case["asks"]):
        faults += [f"asks/{number}: {fault}" for fault in find_faults_of_ask(case, ask)]
        script = ask.get("made_by")
        if script and not (HERE / script).exists():
            faults.append(f"there is no {script}")
    if faults or any(ask["what"] == "refusal" for ask in case["asks"]) or not system["bonds"]:
        return faults
    x = np.array(start["positions_nm"], dtype=float)
    along = bond_vectors(case, x)
    lengths = np.array([bond["length_nm"] for bond in system["bonds"]])
    off = np.abs(np.linalg.norm(along, axis=1) / lengths - 1)
    if off.max() > 1e-9 and "off its length" not in case["words"]:
        faults.append(f"bond {off.argmax()} is off its length by {off.max():.1e} at the start")
    if "velocities_nm_per_ps" in start:
        v = np.array(start["velocities_nm_per_ps"], dtype=float)
        for site in system.get("virtual_sites", []):  # whose velocity is that of their parents
            v[site["atom"]] = np.array(site["weights"]) @ v[site["of"]]
        i, j = np.array([bond["atoms"] for bond in system["bonds"]]).T
        along_bonds = np.abs(np.einsum("bi,bi->b", along, v[j] - v[i]) / lengths)
        if along_bonds.max() > 1e-9 and "along the bond" not in case["words"]:
            faults.append(f"the velocities stretch bond {along_bonds.argmax()} by {along_bonds.max():.1e} nm/ps")
    return faults


def find_stale(path: Path, asked: Dict[Tuple[str, str], Any]) -> List[str]:
    """What results/*.json have of asks that are no more, or had another tolerance."""
    faults = []
    for one in read_results(path)["verdicts"]:
        key = one["case"], one["what"]
        if key not in asked:
            faults.append(f"no case asks for {one['what']} of {one['case']}")
        elif one.get("tolerance") and abs(one["tolerance"] / asked[key] - 1) > 0.01:
            faults.append(f"{one['case']}: {one['what']} is judged by {one['tolerance']:g}, the case has {asked[key]:g}: "
                          "run it again")
    return faults


def atoms_named(case: Dict[str, Any]) -> Iterator[Tuple[str, List[int]]]:
    """Each place of the case that names atoms, with those."""
    system = case["system"]
    for key in ("bonds", "forces", "virtual_sites"):
        for number, one in enumerate(system.get(key, [])):
            yield f"{key}/{number}", [*one.get("atoms", []), *([one["atom"]] if "atom" in one else []), *one.get("of", [])]
            for pair in one.get("excluded", []):
                yield f"{key}/{number}/excluded", pair
    for number, atoms in enumerate(system.get("molecules", [])):
        yield f"molecules/{number}", atoms
    for number, ask in enumerate(case["asks"]):
        of = ask.get("of", [])
        while of and of[0] == "square":
            of = of[1]
        each = ask.get("each", 0)  # the last shift is the largest
        last = (len(system["masses_u"]) - 1) // each * each if each else 0
        yield f"asks/{number}/of", [atom + last for atom in of[1:]]


def find_faults_of_system(system: Dict[str, Any]) -> Iterator[str]:
    n = len(system["masses_u"])
    for number, bond in enumerate(system["bonds"]):
        if "image" in bond and "box_nm" not in system:
            yield f"bonds/{number} has an image, but there is no box_nm"
    for number, force in enumerate(system["forces"]):
        for key in ("sigma_nm", "epsilon_kj_per_mol", "charges_e"):
            if key in force and len(force[key]) != n:
                yield f"forces/{number}/{key} has {len(force[key])} numbers, masses_u {n}"
    for number, site in enumerate(system.get("virtual_sites", [])):
        if len(site["of"]) != len(site["weights"]):
            yield f"virtual_sites/{number} has {len(site['of'])} parents and {len(site['weights'])} weights"


def find_faults_of_ask(case: Dict[str, Any], ask: Dict[str, Any]) -> Iterator[str]:
    what, system = ask["what"], case["system"]
    if (what == "refusal") != (ask["kind"] == "refused"):
        yield f"{what} cannot be of kind {ask['kind']}"
        return
    n, bonds = len(system["masses_u"]), len(system["bonds"])
    shape = {"positions_nm": (n, 3), "velocities_nm_per_ps": (n, 3), "tensions_kj_per_mol_nm": (bonds,)}.get(what, ())
    found = np.shape(ask["right"])
    if found != shape:
        yield f"right of {what} has the shape {found}, not {shape}"
    if what == "drift_kt_per_ns_dof" and "reference_k" not in case["run"]:
        yield f"{what} needs reference_k in run"
    if what.startswith("temperature_") and not system.get("molecules"):
        yield f"{what} needs molecules in system"


def main() -> int:
    validator = jsonschema.Draft202012Validator(json.loads((HERE / "schema.json").read_text(encoding="utf-8")))
    paths = sorted(HERE.glob("cases/*/*.json"))
    faulty = 0
    for path in paths:
        for fault in find_faults(path, validator):
            faulty += 1
            print(f"{path.relative_to(HERE)}: {fault}")
    asked = {(case["name"], ask["what"]): ask.get("tolerance")
             for case in (json.loads(path.read_text(encoding="utf-8")) for path in paths) for ask in case["asks"]}
    for path in sorted(HERE.glob("results/*.json")):
        for fault in find_stale(path, asked):
            faulty += 1
            print(f"{path.relative_to(HERE)}: {fault}")
    print(f"{len(paths)} cases, {sum(path.stat().st_size for path in paths) // 1000} kB, {faulty} faults")
    return 1 if faulty else 0


if __name__ == "__main__":
    sys.exit(main())
