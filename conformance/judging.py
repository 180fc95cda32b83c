"""Whether an engine gives what a case asks for: one verdict an ask, with the error and what was allowed."""

from __future__ import annotations

import copy
import functools
import re
from typing import Any, Callable, Dict, List

import numpy as np

from quantities import Case, NotTold, Rows, measure

Result = Dict[str, Any]
Verdict = Dict[str, Any]

# What a run without motion has as it should be.
CONSERVED = {"bond_error", "momentum_u_nm_per_ps", "angular_momentum_u_nm2_per_ps", "energy_kj_per_mol",
             "energy_range_kj_per_mol", "drift_kt_per_ns_dof", "reversal_nm"}
LEAST_MOTION = 1e-9  # nm, rounding of files


class Runs:
    """The runs of a case that its asks need, each made once."""

    def __init__(self, case: Case, run: Callable[[Case], Result]) -> None:
        self.case = case
        self._run = run
        self.of = functools.lru_cache(maxsize=None)(self._make)

    def _make(self, halvings: int, seed: int) -> Result:
        case = copy.deepcopy(self.case)
        case["run"]["step_ps"] /= 2**halvings
        case["run"]["steps"] *= 2**halvings
        if "rows_every" in case["run"]:
            case["run"]["rows_every"] *= 2**halvings
        case["run"]["seed"] = seed
        return self._with_arrays(case)

    def reversed(self) -> Result:
        forward = self.of(0, 1)
        if "rows" not in forward:
            return forward
        case = copy.deepcopy(self.case)
        case["start"] = {
            "positions_nm": forward["rows"]["positions_nm"][-1].tolist(),
            "velocities_nm_per_ps": (-forward["rows"]["velocities_nm_per_ps"][-1]).tolist(),
        }
        case["run"]["seed"] = 1
        return self._with_arrays(case)

    def _with_arrays(self, case: Case) -> Result:
        result = self._run(case)
        if "rows" in result:
            result["rows"] = Rows({key: np.asarray(values, dtype=float) for key, values in result["rows"].items()})
        return result


class NoValue(Exception):
    """A run has no value for an ask: it was not offered or refused, or failed as a whole."""

    def __init__(self, verdict: str, why: str) -> None:
        super().__init__(why)
        self.verdict = verdict


def value_of(case: Case, ask: Dict[str, Any], result: Result) -> np.ndarray:
    if not result.get("offered", True):
        raise NoValue("not offered", result["why"])
    if "refused" in result:
        raise NoValue("refused", result["refused"])
    fault = find_fault(case, ask, result["rows"])
    if fault:
        raise NoValue("failed", fault)
    try:
        return measure(case, ask, result)
    except NotTold as missing:
        raise NoValue("not offered", f"the engine does not tell {missing.args[0]}") from None


def find_fault(case: Case, ask: Dict[str, Any], rows: Rows) -> str:
    """Why no value of these rows counts; empty if they do. What never moves conserves all, and would pass for it."""
    for key, values in rows.items():
        if not np.isfinite(values).all():
            return f"{key} are not finite"
    start = case["start"]
    driven = "temperature_k" in start or np.any(start["velocities_nm_per_ps"]) or bool(case["system"]["forces"])
    if ask["what"] in CONSERVED and driven and case["run"]["steps"] > 0 and "positions_nm" in rows:
        if np.abs(rows["positions_nm"] - rows["positions_nm"][0]).max() < LEAST_MOTION:
            return "nothing moves"
    return ""


def error_of(ask: Dict[str, Any], value: np.ndarray) -> float:
    right = np.asarray(ask["right"], dtype=float)
    if value.shape != right.shape:
        return float("inf")
    error = np.abs(value - right).max() if value.size else 0.0
    return float(error) if np.isfinite(error) else float("inf")


def judge_exact(case: Case, ask: Dict[str, Any], runs: Runs) -> Verdict:
    if ask["what"] == "reversal_nm":
        value_of(case, {**ask, "what": "bond_error"}, runs.of(0, 1))  # the way there must be one
        back = value_of(case, {**ask, "what": "positions_nm"}, runs.reversed())
        value = np.asarray(np.abs(back - np.asarray(case["start"]["positions_nm"])).max())
    else:
        value = value_of(case, ask, runs.of(0, 1))
    error = error_of(ask, value)
    return {"verdict": verdict(error <= ask["tolerance"]), "error": error}


def judge_convergence(case: Case, ask: Dict[str, Any], runs: Runs) -> Verdict:
    whole, half = (error_of(ask, value_of(case, ask, runs.of(halvings, 1))) for halvings in (0, 1))
    falls = np.isfinite(whole) and half <= max(whole / 3, ask.get("floor", 0.0))
    ratio = whole / half if half > 0 else float("inf")
    made = {"verdict": verdict(bool(half <= ask["tolerance"] and falls)), "error": half}
    if half > ask.get("floor", 0.0):
        made["falls_by"] = round(ratio, 2)
    return made


def judge_statistics(case: Case, ask: Dict[str, Any], runs: Runs) -> Verdict:
    values = np.array([value_of(case, ask, runs.of(0, seed + 1)) for seed in range(ask["seeds"])], dtype=float)
    off, sigma = abs(values.mean() - ask["right"]), values.std(ddof=1) / np.sqrt(values.size)
    passed = off <= max(4 * sigma, ask["tolerance"]) and sigma <= ask["tolerance"]  # few seeds: σ itself is uncertain
    return {"verdict": verdict(bool(passed)), "error": float(off), "standard_error": float(sigma)}


def judge_refusal(case: Case, ask: Dict[str, Any], runs: Runs) -> Verdict:
    result = runs.of(0, 1)
    if not result.get("offered", True):
        raise NoValue("not offered", result["why"])
    why = result.get("refused", "it ran on without a word")
    if refuses_the_masses(case, why):
        raise NoValue("not offered", why)
    broke = re.search(r"\bnan\b|non-numeric", why, re.IGNORECASE)  # it ran until numbers broke, and did not refuse
    return {"verdict": verdict("refused" in result and not broke), "why": why}


def refuses_the_masses(case: Case, why: str) -> bool:
    """Whether the message is of masses of 0, which the engine has no use for, where what is wrong is another thing."""
    system = case["system"]
    of_any = re.search(r"invalid mass value", why, re.IGNORECASE) and min(system["masses_u"]) >= 0
    return bool(of_any or re.search(r"massless|frozen", why, re.IGNORECASE))


def verdict(passed: bool) -> str:
    return "passed" if passed else "failed"


JUDGES = {
    "exact": judge_exact,
    "converges": judge_convergence,
    "statistical": judge_statistics,
    "refused": judge_refusal,
}


def judge_case(case: Case, run: Callable[[Case], Result]) -> List[Verdict]:
    """One verdict for each ask of the case, in order: passed, failed, refused or not offered."""
    runs = Runs(case, run)
    verdicts = []
    for ask in case["asks"]:
        try:
            made = JUDGES[ask["kind"]](case, ask, runs)
        except NoValue as none:
            made = {"verdict": none.verdict, "why": str(none)}
        except Exception as error:  # shown, and the other cases go on
            kind = type(error).__name__  # EngineStopped: the engine broke off in the run; else the runner's own fault
            made = {"verdict": "failed", "why": f"{'' if kind == 'EngineStopped' else f'the runner: {kind}: '}{error}"}
        verdicts.append({"case": case["name"], "what": ask["what"], "kind": ask["kind"],
                         "tolerance": ask.get("tolerance"), **made})
    return verdicts
