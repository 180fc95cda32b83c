#!/usr/bin/env python3
"""Checks all cases by schema.json, and what a schema cannot say: sizes, names, starts that fulfil their bonds; and that
results are of what the cases ask today."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any, Dict, List, Tuple

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
    for list_name, of in (("bonds", system["bonds"]), ("forces", system["forces"])):
        for number, one in enumerate(of):
            for atom in [*one.get("atoms", []), *([one["atom"]] if "atom" in one else [])]:
                if atom >= n:
                    faults.append(f"{list_name}/{number} names atom {atom} of {n}")
    for ask in case["asks"]:
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
