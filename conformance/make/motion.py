#!/usr/bin/env python3
"""Writes cases/motion: mechanisms and molecules, with the exact motion and what a step may leave of it.

Each motion is solved twice, at relative tolerances of 1e-13 and 1e-12 with other projections, and the two must agree;
that of pendulum and rotor must agree with closed forms, too.
"""

from __future__ import annotations

import sys
from typing import Any, Dict, List, Optional

import numpy as np

from mechanisms import MECHANISMS
from molecules import MOLECULES
from solve import System, move, up, verlet, write

GROUND = ("M a = F + Jᵀλ with the bonds twice differentiated, by DOP853 to 1e-13 with projections; solved again "
          "otherwise it differs by {:.0e}")


def make(name: str, words: str, system: Dict[str, Any], x: Any, v: Any, step: float, steps: int,
         exact: Optional[Any] = None, ground: str = "", tensions: bool = False) -> Dict[str, Any]:
    """A case of motion. `exact` are positions and velocities from elsewhere, with their ground."""
    solver, made_by = System(system), "make/motion.py"
    start = solver.project(np.array(x, dtype=float), np.array(v, dtype=float))
    if exact is None:
        exact = move(solver, *start, step * steps)
        again = move(solver, *start, step * steps, parts=27, rtol=1e-12)
        apart = max(np.abs(one - other).max() for one, other in zip(exact, again))
        assert apart < 1e-8, f"{name}: two solutions differ by {apart}"
        ground = GROUND.format(max(apart, 1e-15))
    asks: List[Dict[str, Any]] = []
    plain = [verlet(solver, *start, step / times, steps * times) for times in (1, 2)]
    errors = [[float(np.abs(a - b).max()) for a, b in zip(run, exact)] for run in plain]
    for index, (what, floor) in enumerate((("positions_nm", 1e-8), ("velocities_nm_per_ps", 1e-6))):
        whole, half = errors[0][index], errors[1][index]
        assert half < floor or 3.3 < whole / half < 5, f"{name}: {what} falls by {whole / half}: no second order"
        asks.append({
            "what": what, "kind": "converges", "right": exact[index], "tolerance": up(4 * max(half, floor / 4)),
            "floor": floor, "ground": ground, "made_by": made_by
        })
    asks.append({
        "what": "bond_error", "kind": "exact", "right": 0, "tolerance": 1e-6,
        "ground": "the bonds are rigid; the runner asks for 1e-10"
    })
    if tensions:
        pulls = solver.tensions(*exact)
        lagging = np.abs(tensions_of_a_step(solver, *start, step / 2, steps * 2) - pulls).max()
        asks.append({
            "what": "tensions_kj_per_mol_nm", "kind": "converges", "right": pulls, "floor": 1e-3,
            "tolerance": up(4 * max(float(np.abs(solver.tensions(*plain[1]) - pulls).max()), lagging, 2.5e-4)),
            "made_by": made_by,
            "ground": "(J M⁻¹ Jᵀ) λ = −|ṙ|² − J M⁻¹ F at the exact positions and velocities; T = −λ d"
        })
    print(f"{name:28} {errors[0][0]:.1e} {errors[1][0]:.1e} nm  {errors[0][0] / max(errors[1][0], 1e-30):.2f}")
    return {
        "name": name, "words": words, "system": system,
        "start": {"positions_nm": start[0], "velocities_nm_per_ps": start[1]}, "run": {"step_ps": step,
                                                                                       "steps": steps}, "asks": asks
    }


def tensions_of_a_step(solver: System, x: np.ndarray, v: np.ndarray, h: float, steps: int) -> np.ndarray:
    """Those that the step itself has around its last positions: M (x₊ − 2x + x₋)/h² less the forces."""
    before = verlet(solver, x, v, h, steps - 1)
    now = verlet(solver, *before, h, 1)
    after = verlet(solver, *now, h, 1)
    pulls = solver.mass[:, None] * (after[0] - 2 * now[0] + before[0]) / h**2 - solver.forces(now[0])[1]
    pulls[~solver.moving] = 0
    along = solver.jacobian(now[0]) / solver.length[:, None, None] * solver.moving[:, None]
    return -np.linalg.lstsq(along.reshape(len(along), -1).T, pulls.ravel(), rcond=1e-11)[0]


def main() -> None:
    wanted = sys.argv[1:]
    for describe in MECHANISMS + MOLECULES:
        if not wanted or any(part in describe.__name__ for part in wanted):
            write("motion", make(describe.__name__, **describe()))


if __name__ == "__main__":
    main()
