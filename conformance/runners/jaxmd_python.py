"""jax-md: its SETTLE and CCMA functions, between the halves of a velocity Verlet.

jax-md has constraint functions and no integrator that calls them. The step is the one its functions' description (OpenMM's
reference) asks for: positions are constrained, velocities are taken from where the atoms went, and are constrained again.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import Any, Dict, List

import jax
import numpy as np

jax.config.update("jax_enable_x64", True)

import jax.numpy as jnp  # noqa: E402  (after the precision is set)
from jax_md import space  # noqa: E402
from jax_md.mm_forcefields.amber import constraints as held  # noqa: E402

from forces import force_function  # noqa: E402
from shared import (  # noqa: E402
    Case, EngineStopped, moving, nearest_images, not_offered, row_steps, start_velocities, wants_refusal,
    wants_tensions_alone)

VARIANTS: Dict[str, Dict[str, Any]] = {"settle_and_ccma": {}}


def describe(variant: str) -> Dict[str, str]:
    return {"engine": "jax-md", "version": version("jax-md"),
            "settings": "prepare_settle_ccma, settle_apply_*, ccma_apply_* with the case's tolerance and 10000 iterations, "
                        "in a velocity Verlet of the runner's, double precision"}


def run(case: Case, variant: str) -> Case:
    system, masses = case["system"], np.array(case["system"]["masses_u"], dtype=float)
    if wants_tensions_alone(case):
        return not_offered("the runner does not tell tensions")
    if "virtual_sites" in system:
        return not_offered("no virtual sites")
    if "langevin" in case["run"]:
        return not_offered("no thermostat that calls the constraints")
    if "box_nm" in system:
        return not_offered("the runner has free boundaries alone")
    if not nearest_images(case):
        return not_offered("a bond goes to the nearest image")
    pairs = np.array([bond["atoms"] for bond in system["bonds"]]).reshape(-1, 2)
    lengths = np.array([bond["length_nm"] for bond in system["bonds"]])
    settle, ccma = held.prepare_settle_ccma(pairs, lengths, masses)
    displacement, shift = space.free()
    tolerance = case["run"].get("bond_tolerance", 1e-10)
    m, h = jnp.array(masses), case["run"]["step_ps"]
    inverse = np.where(moving(case), 1 / np.where(masses != 0, masses, 1), 0)[:, None]

    @jax.jit
    def hold_positions(x, old):
        x = held.ccma_apply_positions(x, ccma, m, displacement, shift, tolerance=tolerance, max_iters=10000)
        return held.settle_apply_positions(old, x, settle, m, displacement, shift)

    @jax.jit
    def hold_velocities(x, v):
        v = held.ccma_apply_velocities(x, v, ccma, m, displacement, tolerance=tolerance, max_iters=10000)
        return held.settle_apply_velocities(x, v, settle, m, displacement)

    evaluate = force_function(case)
    x, v = np.array(case["start"]["positions_nm"], dtype=float), start_velocities(case)
    potential, f = evaluate(x)
    rows: Dict[str, List[Any]] = {key: [] for key in ("step", "positions_nm", "velocities_nm_per_ps",
                                                      "potential_kj_per_mol")}
    wanted = set(row_steps(case))
    for step in range(case["run"]["steps"] + 1):
        if step:
            v = v + 0.5 * h * inverse * f
            old, x = x, np.array(hold_positions(x + h * v, x))
            v = (x - old) / h
            potential, f = evaluate(x)
            v = np.array(hold_velocities(x, v + 0.5 * h * inverse * f))
        if not np.isfinite(x).all():
            if wants_refusal(case):
                return {"refused": "positions are NaN"}
            raise EngineStopped(f"positions are NaN after step {step}")
        if step in wanted:
            for key, value in zip(rows, (step, x, v, potential)):
                rows[key].append(value)
    return {"rows": rows}
