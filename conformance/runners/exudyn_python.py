"""Exudyn, of multibody dynamics: mass points and distance connectors, by its implicit solver of generalized α.

Constraints are solved with positions, at index 3; the spectral radius of 0.9 damps a little. Forces are handed over by
a user function.
"""

from __future__ import annotations

from typing import Any, Dict, List

import exudyn
import exudyn.itemInterface as items
import numpy as np

from forces import force_function
from shared import Case, EngineStopped, moving, not_offered, row_steps, start_velocities, wants_refusal

VARIANTS: Dict[str, Dict[str, Any]] = {"generalized_alpha": {"radius": 0.9}}


def describe(variant: str) -> Dict[str, str]:
    return {"engine": "Exudyn", "version": exudyn.GetVersionString(),
            "settings": f"MassPoint and DistanceConstraint, generalized α, spectral radius {VARIANTS[variant]['radius']}, "
                        "index 3, Newton to 1e-12, double precision"}


def run_case(case: Case, variant: str) -> Case:
    system, run_, radius = case["system"], case["run"], VARIANTS[variant]["radius"]
    for key, word in (("virtual_sites", "no virtual sites"), ("box_nm", "no periodic boxes")):
        if key in system:
            return not_offered(word)
    if "langevin" in run_:
        return not_offered("no thermostat")
    x, v, moves, evaluate = (np.array(case["start"]["positions_nm"], dtype=float), start_velocities(case), moving(case),
                             force_function(case))
    container = exudyn.SystemContainer()
    mbs = container.AddSystem()
    nodes, markers = [], []
    for i, mass in enumerate(system["masses_u"]):
        if moves[i] or mass < 0:
            nodes.append(mbs.AddNode(items.NodePoint(referenceCoordinates=x[i], initialVelocities=v[i])))
            body = mbs.AddObject(items.ObjectMassPoint(physicsMass=mass, nodeNumber=nodes[-1]))
        else:
            body = mbs.AddObject(items.ObjectGround(referencePosition=x[i]))
        markers.append(mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=body, localPosition=[0, 0, 0])))
    for bond in system["bonds"]:
        mbs.AddObject(items.ObjectConnectorDistance(
            markerNumbers=[markers[a] for a in bond["atoms"]], distance=bond["length_nm"]))
    if system["forces"]:
        place = x.copy()

        def push(mbs_, t, items_, q, q_t):  # generalised forces of all free coordinates
            place[moves] = x[moves] + np.array(q).reshape(-1, 3)
            return evaluate(place)[1][moves].ravel()

        size = 3 * int(moves.sum())
        mbs.AddObject(items.ObjectGenericODE2(
            nodeNumbers=nodes, massMatrix=np.zeros((size, size)), forceVector=np.zeros(size), forceUserFunction=push))
    mbs.Assemble()
    settings, rows = exudyn.SimulationSettings(), {key: [] for key in (
        "step", "positions_nm", "velocities_nm_per_ps", "potential_kj_per_mol")}
    integration = settings.timeIntegration
    integration.verboseMode = 0
    settings.solutionSettings.writeSolutionToFile = False
    integration.newton.relativeTolerance = integration.newton.absoluteTolerance = 1e-12
    integration.generalizedAlpha.spectralRadius = radius
    integration.generalizedAlpha.computeInitialAccelerations = True
    wanted, done = row_steps(case), 0
    for row in wanted:
        if row > done:
            integration.numberOfSteps, integration.startTime = row - done, done * run_["step_ps"]
            integration.endTime = row * run_["step_ps"]
            try:
                finished = mbs.SolveDynamic(settings, solverType=exudyn.DynamicSolverType.GeneralizedAlpha, updateInitialValues=True)
            except (ValueError, RuntimeError) as said:
                finished, why = False, str(said).split("\n")[0]
            else:
                why = "the solver did not finish"
            if not finished:
                if wants_refusal(case):
                    return {"refused": why}
                raise EngineStopped(why)
        done = row
        at, speed = x.copy(), np.zeros_like(x)
        kind = exudyn.ConfigurationType.Initial  # updateInitialValues: the end of a part is the start of the next
        at[moves] += np.array(mbs.systemData.GetODE2Coordinates(kind)).reshape(-1, 3)
        speed[moves] = np.array(mbs.systemData.GetODE2Coordinates_t(kind)).reshape(-1, 3)
        for key, value in zip(rows, (row, at, speed, evaluate(at)[0])):
            rows[key].append(value)
    return {"rows": rows}


def run(case: Case, variant: str) -> Case:
    try:
        return run_case(case, variant)
    except ValueError as said:  # parameters that Exudyn does not take
        if wants_refusal(case):
            return {"refused": str(said)}
        raise
