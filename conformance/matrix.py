#!/usr/bin/env python3
"""Makes MATRIX.md anew from results/*.json and reasons.json, but for its ten rows: who passes what, and why not.

reasons.json says why an engine fails, and where that is `reported`: the first entry whose patterns of runner:variant,
case and what fit a failure.
"""

from __future__ import annotations

import json
import re
import sys
import textwrap
from collections import Counter, defaultdict
from pathlib import Path
from typing import Any, Dict, List, Tuple

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from keeping import read_results  # noqa: E402  (its folder is no package)

Verdict = Dict[str, Any]
ORDER = ("taut_python", "taut_command", "openmm", "lammps", "gromacs", "ase", "sander", "cp2k", "jaxmd", "mujoco", "exudyn")
USUAL = ("double precision", "double precision of forces", "double precision of pair forces", "defaults", "tolerance of the case",
         "constraint tolerance of the case", "fix nve", "leapfrog", "VerletIntegrator", "up to 1000 iterations",
         "LangevinMiddleIntegrator with a thermostat", "integrator md (sd with a thermostat)")
SOFT = ("taut_python:none", "taut_python:penalty", "mujoco_python:tendons_rk4")
WORSE = ("passed", "undecided", "not done", "not offered", "refused", "failed")


def read_all() -> List[Dict[str, Any]]:
    results = [read_results(path) for path in sorted((HERE / "results").glob("*.json"))]
    place = {name: k for k, name in enumerate(ORDER)}
    results.sort(key=lambda one: min(
        [k for name, k in place.items() if one["about"]["runner"].startswith(name)], default=99))
    for number, one in enumerate(results, 1):
        one["number"] = number
        for verdict in one["verdicts"]:
            verdict["verdict"] = judge_again(verdict)
    return results


def judge_again(verdict: Verdict) -> str:
    """What the runs of all engines need to be counted alike.

    A mean that is right within four of its errors, which are larger than allowed, settles nothing. A run that an engine
    breaks off at some step is no refusal of the input.
    """
    if verdict["verdict"] == "refused" and re.search(r"step [1-9]|NaN|Non-numeric", verdict.get("why", "")):
        return "failed"
    error, sigma = verdict.get("error"), verdict.get("standard_error")
    if verdict["verdict"] == "failed" and sigma is not None and error is not None:
        if error <= max(4 * sigma, verdict["tolerance"]):
            return "passed" if sigma <= verdict["tolerance"] else "undecided"
    return verdict["verdict"]


def label(result: Dict[str, Any]) -> str:
    return f"{result['about']['runner']}:{result['about']['variant']}"


def cell(verdicts: List[Verdict]) -> str:
    """One sign for a case: of the worst of its asks. What is asked and not offered does not count beside what is."""
    if not verdicts:
        return ""
    asked = [one for one in verdicts if one["verdict"] != "not offered"] or verdicts
    worst = max(asked, key=lambda one: (WORSE.index(one["verdict"]), over(one)))
    if worst["verdict"] == "failed":
        times = over(worst)
        if times == float("inf") or worst["what"] == "refusal":
            return "✗"
        if times < 1:
            return "o"
        return f"{times:.1f}" if times < 9.95 else f"{times:.0e}".replace("e+0", "e").replace("e+", "e")
    return {"passed": "✓", "undecided": "?", "refused": "r", "not offered": "–", "not done": ""}[worst["verdict"]]


def over(verdict: Verdict) -> float:
    """By how much an error is larger than allowed; an error without a number is infinite."""
    if verdict["verdict"] != "failed":
        return 0.0
    error = verdict.get("error")
    return error / verdict["tolerance"] if error is not None else float("inf")


def read_groups() -> Dict[str, List[str]]:
    groups: Dict[str, List[str]] = {}
    for path in sorted(HERE.glob("cases/*/*.json")):
        groups.setdefault(path.parent.name, []).append(path.stem)
    return groups


def count_table(results: List[Dict[str, Any]], asked: int) -> List[str]:
    words = ("passed", "failed", "undecided", "refused", "not offered")
    lines = [f"|no.|engine and settings|{'|'.join(words)}|not done|", "|---|---|---|---|---|---|---|---|"]
    before = {"engine": "", "version": ""}
    for one in results:
        about = one["about"]
        counts = [sum(v["verdict"] == word for v in one["verdicts"]) for word in words]
        called = "" if about["engine"] == before["engine"] and about["version"] == before["version"] else (
            f"{about['engine']} {about['version']} ")
        said = ", ".join(part for part in re.split("[,;] ", about["settings"]) if part not in USUAL)
        settings = f": {said}" if said else ""
        lines.append(f"|{one['number']}|{called}`{about['variant']}`{settings}|"
                     + "|".join(map(str, [*counts, asked - sum(counts)])) + "|")
        before = about
    return lines


def case_tables(results: List[Dict[str, Any]], groups: Dict[str, List[str]]) -> List[str]:
    """A row for each case that some engine does not pass, a column for each engine; alike columns are one."""
    by_case = [defaultdict(list) for _ in results]
    for gathered, one in zip(by_case, results):
        for verdict in one["verdicts"]:
            gathered[verdict["case"]].append(verdict)
    columns: Dict[Tuple[str, ...], List[int]] = {}
    names = [case for cases in groups.values() for case in cases]
    for gathered, one in zip(by_case, results):
        columns.setdefault(tuple(cell(gathered[case]) for case in names), []).append(one["number"])
    rows = dict(zip(names, zip(*columns)))
    alike = {case for case, signs in rows.items() if set(signs) <= {"✓", "–", ""}}
    lines = [f"These {len(alike)} cases are passed by all that offer them:", ""]
    lines += [wrapped(f"- {group}: {', '.join(case for case in cases if case in alike)}")
              for group, cases in groups.items() if alike & set(cases)]
    lines += ["", f"The other {len(names) - len(alike)}:", "",
              f"|case|{'|'.join(', '.join(map(str, numbers)) for numbers in columns.values())}|",
              "|---|" + "---|" * len(columns)]
    for group, cases in groups.items():
        lines += [f"|**{group}**|" + "|" * len(columns)]
        lines += [f"|{case}|{'|'.join(rows[case])}|" for case in cases if case not in alike]
    return lines


def reason_of(reasons: List[Dict[str, str]], name: str, verdict: Verdict) -> Dict[str, str]:
    for one in reasons:
        if (re.search(one.get("who", ""), name) and re.search(one.get("case", ""), verdict["case"])
                and re.search(one.get("what", ""), verdict["what"])
                and re.search(one.get("said", ""), verdict.get("why", ""))):
            return one
    return {"why": "not looked into"}


def failures(results: List[Dict[str, Any]], reasons: List[Dict[str, str]]) -> List[str]:
    """The reasons, each with how many asks of which engine it explains, one of them, and where it is reported."""
    gathered: Dict[Tuple[str, str], List[Tuple[int, Verdict]]] = {}
    for one in results:
        for verdict in one["verdicts"]:
            if verdict["verdict"] == "failed":
                reason = reason_of(reasons, label(one), verdict)
                reported = "" if label(one).startswith("taut") else reason.get("reported", "")
                gathered.setdefault((reason["why"], reported), []).append((one["number"], verdict))
    lines = []
    for (why, reported), found in gathered.items():
        counts = Counter(number for number, _ in found)
        example = found[0][1]
        by = (f"{example['error']:.1e} of {example['tolerance']:.0e}" if example.get("error") is not None
              else re.sub(r"^the runner: EngineStopped: ", "", example.get("why", "not finite"))[:50])
        lines.append(wrapped(f"- {', '.join(f'**{number}** ({count})' for number, count in counts.items())}: {why}"
                             f"{f' [{reported}]' if reported else ''}. `{example['case']}`, {example['what']}: {by}"))
    return lines


def wrapped(item: str) -> str:
    return textwrap.fill(item, 120, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)


HEAD = """# Who holds rigid bonds right: the matrix

Made by `matrix.py` from `results/`, but for the ten rows; [README.md](README.md) describes the cases.

## Ten rows that tell most

{telling}

## Who was run

Numbers count what the {count} cases ask: {asked}. Double precision, the case's tolerance, the engine's usual integrator,
unless told. Undecided: right within four standard errors, which are larger than allowed. Not offered: the engine has no
words for it, or its runner writes none. Not done: not within the time that `results` name, or not run.

{counts}

## Cases

Columns have the numbers above; a cell how many times the worst error is larger than allowed. ✗: NaN, broken off, or no
refusal; `o`: small enough, but not falling with the step as it ought to; `r`: refused; `?`: undecided; `–`: not offered;
empty: not done. Left out are {soft}, which on purpose hold no bond rigid.

{tables}

## Why they fail

Bold is the engine's number, then how many asks it fails for this reason; one of them, with its error and what is allowed.
`run.py RUNNER:VARIANT CASE` makes it again; scripts of the engine alone are in `failures`. In brackets: issues and pull
requests on GitHub that report it. For the others a search there found none; GROMACS, ASE and Amber keep theirs elsewhere.

{failures}
"""


def main() -> int:
    results, groups = read_all(), read_groups()
    reasons = json.loads((HERE / "reasons.json").read_text(encoding="utf-8"))
    asked = sum(len(json.loads(path.read_text(encoding="utf-8"))["asks"]) for path in HERE.glob("cases/*/*.json"))
    text = HEAD.format(
        telling=(HERE / "MATRIX.md").read_text(encoding="utf-8").split("\n## ")[1].partition("\n")[2].strip(),
        count=sum(map(len, groups.values())), asked=asked,
        counts="\n".join(count_table(results, asked)),
        soft=", ".join(str(one["number"]) for one in results if label(one) in SOFT),
        tables="\n".join(case_tables([one for one in results if label(one) not in SOFT], groups)),
        failures="\n".join(failures(results, reasons)))
    (HERE / "MATRIX.md").write_text(text, encoding="utf-8")
    open_ones = [f"{label(one)} {v['case']} {v['what']} {v.get('error')} {v.get('why', '')}" for one in results
                 for v in one["verdicts"] if v["verdict"] == "failed"
                 and reason_of(reasons, label(one), v)["why"] == "not looked into"]
    print(f"{len(results)} results; {len(open_ones)} failures without a reason")
    print("\n".join(open_ones[:40]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
