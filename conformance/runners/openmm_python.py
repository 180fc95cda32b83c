"""OpenMM: its own integrators and constraints (SETTLE, SHAKE and CCMA, which it chooses itself), and taut's plug-in.

VerletIntegrator is a leapfrog: its velocities are half a step behind. A run starts from the velocity of half a step
before, which the integrator itself finds by a step backwards, and a row has the mean of the velocities around it.
`velocity_verlet` is the integrator of that name in OpenMM's manual, written with CustomIntegrator.
LangevinMiddleIntegrator is what the manual recommends for a thermostat; its velocities are taken as they are.
"""

from __future__ import annotations

import io
import types
from typing import Any, Dict, List

import numpy as np
import openmm as mm
from openmm.app import StateDataReporter
from openmm_system import fill_sites, make_system, read, step_back

from shared import EngineStopped, not_offered, row_steps, start_velocities, wants_refusal

VARIANTS: Dict[str, Dict[str, Any]] = {
    "reference": {"platform": "Reference"},
    "reference_default_tolerance": {"platform": "Reference", "tolerance": 1e-5},
    "reference_velocity_verlet": {"platform": "Reference", "scheme": "velocity_verlet"},
    "cpu": {"platform": "CPU", "properties": {"Threads": "1"}},
    "opencl_double": {"platform": "OpenCL", "properties": {"Precision": "double"}},
    "taut_newton": {"platform": "Reference", "scheme": "newton"},
    "taut_feedforward": {"platform": "Reference", "scheme": "feedforward"},
}
TAUTS = ("newton", "feedforward")
KEYS = ("positions_nm", "velocities_nm_per_ps", "potential_kj_per_mol", "kinetic_kj_per_mol")
Result = Dict[str, Any]


def describe(variant: str) -> Dict[str, str]:
    of = VARIANTS[variant]
    tolerance = "1e-5, the default" if "tolerance" in of else "of the case"
    scheme = of.get("scheme", "VerletIntegrator")
    if scheme in TAUTS:
        scheme = f"taut.openmm.Integrator, method {scheme}"
    thermostat = "" if "taut" in scheme else ", LangevinMiddleIntegrator with a thermostat"
    precision = of.get("properties", {}).get("Precision", "double" if of["platform"] == "Reference" else "single")
    return {"engine": "OpenMM" + (" with taut's plug-in" if "taut" in scheme else ""), "version": mm.__version__,
            "settings": f"{of['platform']} platform, {precision} precision of forces; {scheme}{thermostat}; "
                        f"constraint tolerance {tolerance}"}


def make_integrator(case: Result, of: Result) -> mm.Integrator:
    h, bath, scheme = case["run"]["step_ps"], case["run"].get("langevin"), of.get("scheme")
    tolerance = of.get("tolerance", case["run"].get("bond_tolerance", 1e-10))
    if scheme in TAUTS:
        import taut.openmm
        made = taut.openmm.Integrator(h, method=scheme, seed=case["run"]["seed"], **(
            {"temperature": bath["temperature_k"], "friction": bath["friction_per_ps"]} if bath else {}))
        if scheme == "newton":
            made.setConstraintTolerance(tolerance)
        return made
    if bath:
        made = mm.LangevinMiddleIntegrator(bath["temperature_k"], bath["friction_per_ps"], h)
        made.setRandomNumberSeed(case["run"]["seed"])
    elif scheme == "velocity_verlet":
        made = mm.CustomIntegrator(h)
        made.addPerDofVariable("x1", 0)
        made.addUpdateContextState()
        made.addComputePerDof("v", "v+0.5*dt*f/m")
        made.addComputePerDof("x", "x+dt*v")
        made.addComputePerDof("x1", "x")
        made.addConstrainPositions()
        made.addComputePerDof("v", "v+0.5*dt*f/m+(x-x1)/dt")
        made.addConstrainVelocities()
    else:
        made = mm.VerletIntegrator(h)
    made.setConstraintTolerance(tolerance)
    return made


def run_context(case: Result, of: Result) -> Result:
    system, h, bath = make_system(case), case["run"]["step_ps"], "langevin" in case["run"]
    barostat = None
    if any(ask["what"] == "pressure_bar" and ask["kind"] == "statistical" for ask in case["asks"]):
        barostat = mm.MonteCarloBarostat(0, 300, 0)  # of frequency 0: it only tells the pressure, of molecules
        system.addForce(barostat)
        system.addForce(mm.HarmonicBondForce())  # of no bonds: it says that the box counts, for the barostat to work
        system.getForces()[-1].setUsesPeriodicBoundaryConditions(True)
    counter = StateDataReporter(io.StringIO(), 1, temperature=True)
    counter._initializeConstants(types.SimpleNamespace(system=system))
    context = mm.Context(system, make_integrator(case, of), mm.Platform.getPlatformByName(of["platform"]),
                         of.get("properties", {}))
    x = np.array(case["start"]["positions_nm"], dtype=float)
    context.setPositions(x)
    if "temperature_k" in case["start"]:
        context.setVelocitiesToTemperature(case["start"]["temperature_k"], case["run"]["seed"])
        v = read(context)[1]
    else:
        v = start_velocities(case)
    leapfrog = "scheme" not in of and not bath
    rows: Dict[str, List[Any]] = {key: [] for key in ("step", *KEYS, *["pressure_bar"][: barostat is not None])}
    if leapfrog and case["run"]["steps"]:
        v = step_back(context, case, x, v, h)
    context.setVelocities(v)
    done = 0
    for step in row_steps(case):
        context.getIntegrator().step(step - done)
        now = read(context)
        if leapfrog and case["run"]["steps"]:  # the mean of the velocities half a step before and after
            state = context.getState(positions=True, velocities=True)
            context.getIntegrator().step(1)
            now[1] = 0.5 * (now[1] + read(context)[1])
            context.setPositions(state.getPositions())
            context.setVelocities(state.getVelocities())
        if barostat is not None:
            rows["pressure_bar"].append(barostat.computeCurrentPressure(context)._value)
        fill_sites(case, now[1])
        for key, value in zip(("step", *KEYS), (step, *now)):
            rows[key].append(value)
        done = step
    if not np.isfinite(rows["positions_nm"][-1]).all():
        raise mm.OpenMMException("Particle coordinate is NaN")
    return {"rows": rows, "degrees_of_freedom": counter._dof}


def run(case: Result, variant: str) -> Result:
    of = VARIANTS[variant]
    if any("image" in bond for bond in case["system"]["bonds"]):
        return not_offered("constraints do not go to periodic images")
    try:
        return run_context(case, of)
    except mm.OpenMMException as error:
        said = str(error)
        if "massless" in said and not wants_refusal(case):
            return not_offered(said)
        if "NaN" in said and not wants_refusal(case):
            raise EngineStopped(said.split(".")[0]) from None
        return {"refused": said}
