#!/usr/bin/env python3
"""Runs an engine over the cases and judges it: run.py RUNNER[:VARIANT] [PART OF A CASE'S NAME...] [--write].

RUNNER is a file of runners, VARIANT one of its VARIANTS; without it all of them run. --write puts the verdicts into
results/RUNNER.VARIANT.json, beside those of cases that did not run. --seconds 100 breaks off cases that take longer.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import json
import os
import resource
import signal
import sys
from pathlib import Path
from types import ModuleType
from typing import Any, Dict, Iterable, Iterator, List

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE / "runners")]

from judging import judge_case  # noqa: E402  (its folder is no package)
from keeping import put_beside  # noqa: E402


def read_cases(parts: Iterable[str] = ()) -> List[Dict[str, Any]]:
    """The cases whose name, or folder, has one of the parts in it; all without parts."""
    parts = list(parts)
    paths = sorted(HERE.glob("cases/*/*.json"))
    return [
        json.loads(path.read_text(encoding="utf-8"))
        for path in paths
        if not parts or any(part in f"{path.parent.name}/{path.stem}" for part in parts)
    ]


def load_runner(name: str) -> ModuleType:
    path = HERE / "runners" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"runner_{name}", path)
    if spec is None or spec.loader is None or not path.exists():
        sys.exit(f"no runner {name}: there is no {path}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class TookTooLong(BaseException):
    """No Exception: it is not for those who catch what an engine says."""


def spent() -> float:
    """Processor time of this process and of the programs that it has waited for."""
    return sum(os.times()[:4])


@contextlib.contextmanager
def time_limit(limit: int) -> Iterator[None]:
    """TookTooLong where more than limit seconds of processor time are spent; a program may take as many alone. 0: none."""
    begin, own, hard = spent(), int(sum(os.times()[:2])), resource.getrlimit(resource.RLIMIT_CPU)[1]

    def look(*_: Any) -> None:
        if spent() > begin + limit:
            raise TookTooLong

    if limit:
        signal.signal(signal.SIGALRM, look)
        signal.setitimer(signal.ITIMER_REAL, 1, 1)
        resource.setrlimit(resource.RLIMIT_CPU, (own + limit + 5, hard))  # later than the next look
    try:
        yield
        if limit:
            look()  # a program was ended for it
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        resource.setrlimit(resource.RLIMIT_CPU, (hard, hard))


def run_variant(runner: ModuleType, variant: str, cases: List[Dict[str, Any]], limit: int = 0) -> List[Dict[str, Any]]:
    """All verdicts; of a case that takes more than limit seconds of processor time that it was not done. 0: no limit."""
    verdicts = []
    for case in cases:
        begin = spent()
        try:
            with time_limit(limit):
                made = judge_case(case, lambda varied: runner.run(varied, variant))
        except TookTooLong:
            made = [{"case": case["name"], "what": ask["what"], "tolerance": ask.get("tolerance"), "verdict": "not done",
                     "why": f"not done in {limit} s of processor time"} for ask in case["asks"]]
        seconds = spent() - begin
        verdicts += made
        told = {f"{one['verdict']:11} {case['name']}{explain(one)}": one for one in made if one["verdict"] != "passed"}
        for line in told:  # what all asks of a case say alike is said once
            print(f"  {line}")
        if seconds > 10:
            print(f"              {case['name']} took {seconds:.0f} s")
    return verdicts


def explain(verdict: Dict[str, Any]) -> str:
    said = f": {verdict['what']} off by {verdict['error']:.3g}" if "error" in verdict else ""
    if "standard_error" in verdict:
        said += f" ± {verdict['standard_error']:.2g}"
    if verdict["tolerance"] is not None and "error" in verdict:
        said += f", allowed {verdict['tolerance']:.3g}"
    if "falls_by" in verdict:
        said += f", falls by {verdict['falls_by']} at half the step"
    return said + (f": {' '.join(verdict['why'].split())[:160]}" if "why" in verdict else "")


def main() -> int:
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("runner", help="RUNNER or RUNNER:VARIANT")
    arguments.add_argument("cases", nargs="*", help="parts of names of cases")
    arguments.add_argument("--write", action="store_true", help="write results/RUNNER.VARIANT.json")
    arguments.add_argument("--seconds", type=int, default=0, help="of processor time a case; 0: no limit")
    given = arguments.parse_args()
    name, _, variant = given.runner.partition(":")
    runner = load_runner(name)
    cases, names = read_cases(given.cases), [case["name"] for case in read_cases()]
    if not cases:
        sys.exit(f"no case has {' or '.join(given.cases)} in its name")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that programs which runners started are ended, too
    failed = 0
    for one in [variant] if variant else list(runner.VARIANTS):
        about = runner.describe(one)
        print(f"{about['engine']} {about['version']}, {one}: {about['settings']}")
        path, verdicts = HERE / "results" / f"{name}.{one}.json", []
        for case in cases:
            made = run_variant(runner, one, [case], given.seconds)
            verdicts += made
            if given.write and made:
                put_beside(path, {**about, "runner": name, "variant": one}, made, names)
        counts = {word: sum(v["verdict"] == word for v in verdicts)
                  for word in ("passed", "failed", "refused", "not offered", "not done")}
        print("  " + ", ".join(f"{count} {word}" for word, count in counts.items()))
        failed += counts["failed"]
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
