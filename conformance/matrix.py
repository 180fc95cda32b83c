#!/usr/bin/env python3
"""Makes MATRIX.md from results/*.json, telling.md and reasons.json: who passes which case, by how much, and why not.

reasons.json says why an engine fails: the first entry whose patterns of runner:variant, case and what fit a failure.
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any, Dict, List

HERE = Path(__file__).resolve().parent
Verdict = Dict[str, Any]
ORDER = ("taut_python", "taut_command", "openmm", "lammps", "gromacs", "ase", "sander", "cp2k", "jaxmd", "mujoco", "exudyn")
WORSE = ("passed", "undecided", "not offered", "refused", "failed")


def read_results() -> List[Dict[str, Any]]:
    results = [json.loads(path.read_text(encoding="utf-8")) for path in sorted((HERE / "results").glob("*.json"))]
    place = {name: k for k, name in enumerate(ORDER)}
    results.sort(key=lambda one: min(
        [k for name, k in place.items() if one["about"]["runner"].startswith(name)], default=99))
    for one in results:
        for verdict in one["verdicts"]:
            verdict["verdict"] = judge_again(verdict)
    return results


def judge_again(verdict: Verdict) -> str:
    """What the runs of all engines need to be counted alike.

    A mean that is right within four of its errors, which are larger than allowed, settles nothing. A run that an engine
    breaks off at some step is no refusal of the input.
    """
    if verdict["verdict"] == "refused" and re.match(r"step [1-9]", verdict.get("why", "")):
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
        return f"**{times:.0e}×**".replace("e+0", "e").replace("e+", "e") if 0 < times < float("inf") else "**✗**"
    return {"passed": "✓", "undecided": "?", "refused": "r", "not offered": "–"}[worst["verdict"]]


def over(verdict: Verdict) -> float:
    """By how much an error is larger than allowed; an error without a number is infinite."""
    if verdict["verdict"] != "failed" or verdict["kind"] == "refused":
        return 0.0
    error = verdict.get("error")
    return error / verdict["tolerance"] if error is not None else float("inf")


def read_groups() -> Dict[str, List[str]]:
    groups: Dict[str, List[str]] = {}
    for path in sorted(HERE.glob("cases/*/*.json")):
        groups.setdefault(path.parent.name, []).append(path.stem)
    return groups


def count_table(results: List[Dict[str, Any]], groups: Dict[str, List[str]]) -> List[str]:
    lines = ["| | engine | version | settings | passed | failed | undecided | refused | not offered | cases run |",
             "|---|---|---|---|---|---|---|---|---|---|"]
    for number, one in enumerate(results, 1):
        about, counts = one["about"], [sum(v["verdict"] == word for v in one["verdicts"])
                                       for word in ("passed", "failed", "undecided", "refused", "not offered")]
        known = {case for cases in groups.values() for case in cases}
        done = len({v["case"] for v in one["verdicts"]} & known)
        lines.append(f"| {number} | {about['engine']} `{about['variant']}` | {about['version']} | {about['settings']} | "
                     + " | ".join(map(str, counts)) + f" | {done} of {len(known)} |")
    return lines


def case_table(results: List[Dict[str, Any]], group: str, cases: List[str]) -> List[str]:
    lines = [f"### {group}", "", f"| case | {' | '.join(str(k) for k in range(1, len(results) + 1))} |",
             "|---|" + "---|" * len(results)]
    for case in cases:
        signs = [cell([v for v in one["verdicts"] if v["case"] == case]) for one in results]
        lines.append(f"| {case} | {' | '.join(signs)} |")
    return [*lines, ""]


def reason_of(reasons: List[Dict[str, str]], name: str, verdict: Verdict) -> Dict[str, str]:
    for one in reasons:
        if (re.search(one.get("who", ""), name) and re.search(one.get("case", ""), verdict["case"])
                and re.search(one.get("what", ""), verdict["what"])
                and re.search(one.get("said", ""), verdict.get("why", ""))):
            return one
    return {"why": "not looked into"}


def failures(results: List[Dict[str, Any]], reasons: List[Dict[str, str]]) -> List[str]:
    """For each engine its failures, gathered by their reason."""
    lines = []
    for number, one in enumerate(results, 1):
        gathered: Dict[str, List[str]] = {}
        for verdict in one["verdicts"]:
            if verdict["verdict"] == "failed":
                reason = reason_of(reasons, label(one), verdict)
                by = (f"{verdict['error']:.1e} of {verdict['tolerance']:.0e}" if verdict.get("error") is not None
                      else re.sub(r"^the runner: EngineStopped: ", "", verdict.get("why", "not finite"))[:70])
                gathered.setdefault(reason["why"], []).append(f"{verdict['case']} ({verdict['what']}: {by})")
        if gathered:
            lines += [f"**{number}. {one['about']['engine']} `{one['about']['variant']}`**", ""]
            for why, cases in gathered.items():
                shown = "; ".join(cases[:4]) + (f"; and {len(cases) - 4} more" if len(cases) > 4 else "")
                lines.append(f"- {why} — {shown}")
            lines.append("")
    return lines


def main() -> int:
    results, groups = read_results(), read_groups()
    reasons = json.loads((HERE / "reasons.json").read_text(encoding="utf-8"))
    text = ["# Who holds rigid bonds right: the matrix", "", "Made by `matrix.py` from `results/`; the cases and what they ask are "
            "described in [README.md](README.md).", "", (HERE / "telling.md").read_text(encoding="utf-8").strip(), "",
            "## Who was run", "", "Numbers count what the cases ask. Not offered: the engine has no words for it, or its runner "
            "does not write them. Signs: `–` not offered, `r` refused with a message, `?` the mean is right within four standard errors, which are larger than the case allows.", "",
            *count_table(results, groups), "", "## Cases", "", "A number is how many times the error is larger than the case "
            "allows, of the worst that it asks; ✗ has no number: NaN, an engine that broke off, or no refusal. Empty: not run.", ""]
    for group, cases in groups.items():
        text += case_table(results, group, cases)
    text += ["## Why they fail", "", *failures(results, reasons)]
    (HERE / "MATRIX.md").write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")
    open_ones = [f"{label(one)} {v['case']} {v['what']}" for one in results for v in one["verdicts"]
                 if v["verdict"] == "failed" and reason_of(reasons, label(one), v)["why"] == "not looked into"]
    print(f"{len(results)} results; {len(open_ones)} failures without a reason")
    print("\n".join(open_ones[:40]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
