"""MuJoCo: bonds as spatial tendons of fixed length, held by equality constraints, which MuJoCo makes soft on purpose.

Atoms are bodies with three slides; forces are handed over wherever MuJoCo asks for them. RK4 keeps energy better than
the default, Euler. solref is [2h, 1], the stiffest that the manual allows; solimp [0.9999, 0.9999, 0.001] is near the
hard end of its range.
"""

from __future__ import annotations

from typing import Any, Dict, List

import mujoco
import numpy as np

from forces import force_function
from shared import Case, EngineStopped, moving, not_offered, row_steps, start_velocities, wants_refusal

VARIANTS: Dict[str, Dict[str, Any]] = {"tendons_rk4": {"integrator": "RK4"}}


def describe(variant: str) -> Dict[str, str]:
    return {"engine": "MuJoCo", "version": mujoco.__version__,
            "settings": f"equality constraints of tendons, soft by design: solref 2h, solimp 0.9999; integrator "
                        f"{VARIANTS[variant]['integrator']}, Newton's solver to 1e-12, double precision"}


def write_model(case: Case, variant: str) -> str:
    h, masses = case["run"]["step_ps"], case["system"]["masses_u"]
    bodies, tendons, equalities = [], [], []
    for i, (x, mass) in enumerate(zip(case["start"]["positions_nm"], masses)):
        slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1")) if mass else ""
        inertia = f'<inertial pos="0 0 0" mass="{mass:.17g}" diaginertia="1 1 1"/>' if mass else ""
        bodies.append(f'<body pos="{x[0]:.17g} {x[1]:.17g} {x[2]:.17g}">{slides}{inertia}<site name="s{i}"/></body>')
    for k, bond in enumerate(case["system"]["bonds"]):
        i, j = bond["atoms"]
        # the tendon is held at its length in the start, plus polycoef's first number
        off = bond["length_nm"] - float(np.linalg.norm(np.subtract(*[case["start"]["positions_nm"][a] for a in (i, j)])))
        tendons.append(f'<spatial name="t{k}"><site site="s{i}"/><site site="s{j}"/></spatial>')
        equalities.append(f'<tendon tendon1="t{k}" polycoef="{off:.17g} 0 0 0 0" solref="{2 * h:.17g} 1" '
                          'solimp="0.9999 0.9999 0.001 0.5 2"/>')
    return (f'<mujoco><compiler boundmass="0" boundinertia="0"/>'
            f'<option timestep="{h:.17g}" gravity="0 0 0" integrator="{VARIANTS[variant]["integrator"]}" '
            f'solver="Newton" tolerance="1e-12" iterations="200"><flag energy="enable"/></option>'
            f'<worldbody>{"".join(bodies)}</worldbody><tendon>{"".join(tendons)}</tendon>'
            f'<equality>{"".join(equalities)}</equality></mujoco>')


def run(case: Case, variant: str) -> Case:
    system, moves = case["system"], moving(case)
    for key, word in (("virtual_sites", "no virtual sites"), ("box_nm", "no periodic boxes")):
        if key in system:
            return not_offered(word)
    if "langevin" in case["run"]:
        return not_offered("no thermostat")
    try:
        model = mujoco.MjModel.from_xml_string(write_model(case, variant))
    except ValueError as said:
        return {"refused": str(said)}
    data, evaluate = mujoco.MjData(model), force_function(case)
    start = np.array(case["start"]["positions_nm"], dtype=float)
    data.qvel[:] = start_velocities(case)[moves].ravel()
    place = start.copy()

    def push(of_model, of_data) -> None:  # called wherever MuJoCo asks for forces, the stages of RK4 among them
        place[moves] = start[moves] + of_data.qpos.reshape(-1, 3)
        of_data.qfrc_passive[:] += evaluate(place)[1][moves].ravel()

    rows: Dict[str, List[Any]] = {key: [] for key in ("step", "positions_nm", "velocities_nm_per_ps",
                                                      "potential_kj_per_mol", "tensions_kj_per_mol_nm")}
    mujoco.set_mjcb_passive(push)
    try:
        done = 0
        for row in row_steps(case):
            for _ in range(row - done):
                mujoco.mj_step(model, data)
            done = row
            mujoco.mj_forward(model, data)
            x, v = start.copy(), np.zeros_like(start)
            x[moves] += data.qpos.reshape(-1, 3)
            v[moves] = data.qvel.reshape(-1, 3)
            if not np.isfinite(x).all() or any(w.number for w in data.warning):
                if wants_refusal(case):
                    return {"refused": "MuJoCo's warning of a bad acceleration or position"}
                raise EngineStopped("MuJoCo's warning of a bad acceleration or position")
            for key, value in zip(rows, (row, x, v, evaluate(x)[0], -data.efc_force[: len(system["bonds"])].copy())):
                rows[key].append(value)
    finally:
        mujoco.set_mjcb_passive(None)
    if len(rows["tensions_kj_per_mol_nm"][-1]) != len(system["bonds"]):
        del rows["tensions_kj_per_mol_nm"]
    return {"rows": rows}
