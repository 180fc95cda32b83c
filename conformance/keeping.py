"""How verdicts are kept in results/RUNNER.VARIANT.json: those passed and without a value in short, the others whole.

`passed` has for each case its asks with [error, tolerance], `not offered` and `not done` for each reason the cases and
asks, `verdicts` what failed or was refused, with a reason where it differs from that of the verdict before."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any, Dict, List

HERE = Path(__file__).resolve().parent
LONGEST_REASON = 120  # characters
WITHOUT_VALUE = ("not offered", "not done")
Verdict = Dict[str, Any]


def rounded(value: Any) -> Any:
    """A number to three digits, so that results differ where the engine does; what JSON has no word for is null."""
    if isinstance(value, float):
        return float(f"{value:.3g}") if math.isfinite(value) else None
    return value


def shown(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def without_paths(said: str) -> str:
    """A message in one line, without the folders of the machine that it was said on."""
    return re.sub(r"\s*(?<![^\s('])\(?/\S+/\S+", "", " ".join(said.split()))


def read_results(path: Path) -> Dict[str, Any]:
    """`about`, and all verdicts in one list."""
    kept = json.loads(path.read_text(encoding="utf-8"))
    verdicts: List[Verdict] = [
        {"case": case, "what": what, "verdict": "passed", "error": error, "tolerance": tolerance}
        for case, asks in kept["passed"].items() for what, (error, tolerance) in asks.items()]
    verdicts += [{"case": case, "what": what, "verdict": word, "why": why}
                 for word in WITHOUT_VALUE for why, cases in kept.get(word, {}).items()
                 for case, asks in cases.items() for what in asks]
    before: Verdict = {}
    for one in kept["verdicts"]:
        if "error" not in one and "why" not in one and one["case"] == before.get("case"):
            one["why"] = before["why"]
        verdicts.append(one)
        before = one
    return {"about": kept["about"], "verdicts": verdicts}


def write_results(path: Path, about: Dict[str, Any], verdicts: List[Verdict]) -> None:
    passed: Dict[str, Dict[str, Any]] = {}
    missing: Dict[str, Dict[str, Dict[str, List[str]]]] = {word: {} for word in WITHOUT_VALUE}
    others, before = [], {}
    for one in verdicts:
        one = {key: rounded(value) for key, value in one.items()}
        if one["verdict"] == "passed":
            passed.setdefault(one["case"], {})[one["what"]] = [one.get("error"), one["tolerance"]]
            continue
        why = without_paths(one.get("why", ""))[:LONGEST_REASON]
        if one["verdict"] in WITHOUT_VALUE:
            missing[one["verdict"]].setdefault(why, {}).setdefault(one["case"], []).append(one["what"])
            continue
        made = {key: one[key] for key in ("case", "what", "verdict", "error", "standard_error", "tolerance") if key in one}
        if why and (one["case"], why) != (before.get("case"), before.get("why")):
            made["why"] = why
        before = {"case": one["case"], "why": why}
        others.append(made)
    lines = [f'{{"about": {shown(about)},', '"passed": {' + ",\n".join(
        f"{shown(case)}:{shown(asks)}" for case, asks in passed.items()) + "},"]
    lines += [f'"{word}": {{' + ",\n".join(f"{shown(why)}:{shown(asks)}" for why, asks in missing[word].items()) + "},"
              for word in WITHOUT_VALUE]
    lines += ['"verdicts": [' + ",\n".join(map(shown, others)) + "]}"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def put_beside(path: Path, about: Dict[str, Any], verdicts: List[Verdict], names: List[str]) -> None:
    """Writes the verdicts of a run over some of the cases called names, and keeps those of the others."""
    made = {one["case"] for one in verdicts}
    old = read_results(path)["verdicts"] if path.exists() else []
    place = {name: k for k, name in enumerate(names)}
    kept = [one for one in old if one["case"] in place and one["case"] not in made]
    write_results(path, about, sorted(kept + verdicts, key=lambda one: place[one["case"]]))
