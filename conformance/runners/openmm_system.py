"""A case's system as OpenMM's System, which takes its units and nearly all its forces as they are; and its state, read."""

from __future__ import annotations

from typing import Any, Dict, List

import numpy as np
import openmm as mm

from shared import inverse_masses

Result = Dict[str, Any]


def add_forces(case: Result, system: mm.System) -> None:
    masses = case["system"]["masses_u"]
    for force in case["system"]["forces"]:
        kind = force["kind"]
        if kind in ("gravity", "constant_force", "harmonic_position", "external"):
            energy = {"gravity": "-m*(ax*x+ay*y+az*z)", "constant_force": "-(ax*x+ay*y+az*z)",
                      "harmonic_position": "0.5*k*((x-ax)^2+(y-ay)^2+(z-az)^2)"}.get(kind)
            made = mm.CustomExternalForce(energy or force["energy_kj_per_mol"])
            vector = force.get("acceleration_nm_per_ps2") or force.get("force_kj_per_mol_nm") or force.get("centre_nm")
            names = [] if kind == "external" else ["m", "ax", "ay", "az", "k"]
            for name in names:
                made.addPerParticleParameter(name)
            every = [i for i, m in enumerate(masses) if m > 0]
            for atom in [force["atom"]] if "atom" in force else force.get("atoms", every):
                values = [masses[atom], *vector, force.get("k_kj_per_mol_nm2", 0)] if names else []
                made.addParticle(atom, values)
        elif kind == "harmonic_bond":
            made = mm.HarmonicBondForce()
            made.addBond(*force["atoms"], force["length_nm"], force["k_kj_per_mol_nm2"])
        elif kind == "harmonic_angle":
            made = mm.HarmonicAngleForce()
            made.addAngle(*force["atoms"], force["angle_rad"], force["k_kj_per_mol_rad2"])
        elif kind == "periodic_torsion":
            made = mm.PeriodicTorsionForce()
            made.addTorsion(*force["atoms"], force["periodicity"], force["phase_rad"], force["k_kj_per_mol"])
        else:
            made = mm.NonbondedForce()
            made.setUseDispersionCorrection(False)
            for charge, sigma, epsilon in zip(
                    force["charges_e"], force["sigma_nm"], force["epsilon_kj_per_mol"]):
                made.addParticle(charge, sigma, epsilon)
            for i, j in force["excluded"]:
                made.addException(i, j, 0, 1, 0)
            if "cutoff_nm" in force:
                periodic = "box_nm" in case["system"]
                made.setNonbondedMethod(made.CutoffPeriodic if periodic else made.CutoffNonPeriodic)
                made.setCutoffDistance(force["cutoff_nm"])
                made.setReactionFieldDielectric(force.get("solvent_dielectric", 78.3))
        system.addForce(made)


def make_system(case: Result) -> mm.System:
    system = mm.System()
    for mass in case["system"]["masses_u"]:
        system.addParticle(mass)
    for bond in case["system"]["bonds"]:
        system.addConstraint(*bond["atoms"], bond["length_nm"])
    for site in case["system"].get("virtual_sites", []):
        kind = mm.TwoParticleAverageSite if len(site["of"]) == 2 else mm.ThreeParticleAverageSite
        system.setVirtualSite(site["atom"], kind(*site["of"], *site["weights"]))
    if "box_nm" in case["system"]:
        system.setDefaultPeriodicBoxVectors(*[mm.Vec3(*row) for row in case["system"]["box_nm"]])
    add_forces(case, system)
    return system


def read(context: mm.Context) -> List[Any]:
    state = context.getState(positions=True, velocities=True, energy=True)
    return [np.array(state.getPositions(asNumpy=True)._value), np.array(state.getVelocities(asNumpy=True)._value),
            state.getPotentialEnergy()._value, state.getKineticEnergy()._value]


def step_back(context: mm.Context, case: Result, x: np.ndarray, v: np.ndarray, h: float) -> np.ndarray:
    """The velocity half a step before: minus that of half a step after in the motion turned round."""
    f = np.array(context.getState(forces=True).getForces(asNumpy=True)._value)
    context.setVelocities(-v - 0.5 * h * f * inverse_masses(case)[:, None])
    context.getIntegrator().step(1)
    before = -read(context)[1]
    context.setPositions(x)
    return before


def fill_sites(case: Result, velocities: np.ndarray) -> np.ndarray:
    """Gives virtual sites the velocity of the mean that they are, for engines that have none for them."""
    for site in case["system"].get("virtual_sites", []):
        velocities[site["atom"]] = np.array(site["weights"]) @ velocities[site["of"]]
    return velocities
