#!/usr/bin/env python3
"""Writes cases/conservation: momenta, reversal of time, energies, drift, and bonds kept to the tolerance asked for.

Right values are 0. What a step may leave of energies is four times what plain velocity Verlet with bonds leaves.
"""

from __future__ import annotations

from typing import Any, Dict, List, Tuple

import numpy as np

from mechanisms import Motion, double_pendulum, hung_chain_of_20
from molecules import (butane, cholesterol_diamond, free_chain_of_20, rigid_angles_chain, ring, swinging_rotors,
                       trimer_with_an_angle, two_waters, unequal_triangle)
from solve import BOLTZMANN, System, up, verlet, write

MADE_BY = "make/conservation.py"


def case(name: str, words: str, of: Motion, steps: int, asks: List[Dict[str, Any]], **run: Any) -> None:
    solver = System(of["system"])
    x, v = solver.project(np.array(of["x"], dtype=float), np.array(of["v"], dtype=float))
    write(
        "conservation", {
            "name": name, "words": words, "system": of["system"], "start": {
                "positions_nm": x, "velocities_nm_per_ps": v
            }, "run": {"step_ps": of["step"], "steps": steps, **run}, "asks": asks
        })
    print(f"{name:32} {[ask['tolerance'] for ask in asks]}")


def energies(of: Motion, step: float, steps: int, every: int) -> Tuple[np.ndarray, np.ndarray]:
    """Times and total energies of plain velocity Verlet."""
    solver = System(of["system"])
    x, v = solver.project(np.array(of["x"], dtype=float), np.array(of["v"], dtype=float))
    found = []
    for row in range(steps // every + 1):
        found.append(solver.forces(x)[0] + 0.5 * np.einsum("a,ai,ai->", solver.mass, v, v))
        x, v = verlet(solver, x, v, step, every)
    return np.arange(len(found)) * step * every, np.array(found)


def momenta(name: str, of: Motion, words: str, steps: int = 1000) -> None:
    case(f"momenta_of_{name}", words, of, steps, [{
        "what": "momentum_u_nm_per_ps", "kind": "exact", "right": 0, "tolerance": 1e-9,
        "ground": "no force from outside"
    }, {
        "what": "angular_momentum_u_nm2_per_ps", "kind": "exact", "right": 0, "tolerance": 1e-7,
        "ground": "no torque from outside; RATTLE keeps it, since bonds pull along themselves "
         "(doi:10.1016/0021-9991(83)90014-1)"
    }], rows_every=100)


def reversal(name: str, of: Motion, words: str, steps: int) -> None:
    case(f"reversal_of_{name}", words, of, steps, [{
        "what": "reversal_nm", "kind": "exact", "right": 0, "tolerance": 1e-6,
        "ground": "the equations of motion are symmetric in time, and so is RATTLE (Leimkuhler & Skeel 1994, "
        "doi:10.1006/jcph.1994.1085)"
    }])


def energy(name: str, of: Motion, words: str, steps: int) -> None:
    every = max(1, steps // 50)
    plain = [np.ptp(energies(of, of["step"] / times, steps * times, every * times)[1]) for times in (1, 2)]
    assert 3 < plain[0] / plain[1] < 5, f"{name}: {plain}"
    case(f"energy_of_{name}", words, of, steps, [{
        "what": "energy_range_kj_per_mol", "kind": "converges", "right": 0, "tolerance": up(4 * plain[1]),
        "floor": 1e-7, "ground": "the energy is kept; bonds do no work", "made_by": MADE_BY
    }], rows_every=every)


def drift(name: str, of: Motion, words: str, steps: int, kelvin: float) -> None:
    every = steps // 200
    times, found = energies(of, of["step"], steps, every)
    freedom = 3 * int((np.array(of["system"]["masses_u"]) > 0).sum()) - len(of["system"]["bonds"])
    plain = abs(np.polyfit(times / 1000, found, 1)[0]) / (BOLTZMANN * kelvin * freedom)
    noise = 4 * np.std(found) / (times[-1] / 1000) * np.sqrt(12 / len(times)) / (BOLTZMANN * kelvin * freedom)
    case(f"drift_of_{name}", words + f" {steps} steps.", of, steps, [{
        "what": "drift_kt_per_ns_dof", "kind": "exact", "right": 0, "tolerance": up(max(4 * plain, noise, 0.05)),
        "ground": "the energy is kept. Allowed is what the energy's fluctuation leaves of a slope, and four times "
        "plain velocity Verlet's", "made_by": MADE_BY
    }], rows_every=every, reference_k=kelvin)


def tolerance(name: str, of: Motion, words: str, asked: float) -> None:
    case(f"tolerance_{name}", words, of, 1000, [{
        "what": "bond_error", "kind": "exact", "right": 0, "tolerance": 2 * asked,
        "ground": f"a relative tolerance of {asked:g} is asked for; twice of it is allowed, for engines that measure r²"
    }], rows_every=10, bond_tolerance=asked)


def main() -> None:  # half a minute
    momenta("a_chain", free_chain_of_20(), "A free chain of 20 atoms keeps both its momenta over 1000 steps.")
    momenta("a_ring", ring(), "A hinged ring keeps both its momenta over 1000 steps.")
    momenta("waters", two_waters(), "Two waters that attract each other keep the momenta of the pair.")
    momenta("a_triangle", unequal_triangle(), "A rigid triangle of three masses keeps its momenta.")
    momenta("cholesterol", cholesterol_diamond(), "Two hinged triangles keep their momenta over 1000 steps of 5 fs.")
    reversal("a_double_pendulum", double_pendulum(),
             "A double pendulum, turned round after 500 steps, goes back to where it began.", 500)
    reversal("butane", butane(), "Butane's beads, turned round after 300 steps, go back.", 300)
    reversal("waters", two_waters(), "Two waters, turned round after 300 steps, go back.", 300)
    reversal("a_ring", ring(), "A hinged ring, turned round after 500 steps, goes back.", 500)
    energy("a_double_pendulum", double_pendulum(),
           "The energy of a double pendulum swings by an amount that falls with h².", 500)
    energy("a_hung_chain", hung_chain_of_20(), "The energy of a chain of 20 that falls from its hook.", 200)
    energy("an_angle", trimer_with_an_angle(), "The energy of two rigid bonds with a harmonic angle.", 500)
    energy("butane", butane(), "The energy of butane's beads at 2 fs.", 500)
    energy("waters", two_waters(), "The energy of two waters at 1 fs.", 300)
    drift("an_angle", {**trimer_with_an_angle(), "step": 0.002}, "Two rigid bonds with a harmonic angle, at 2 fs.",
          10000, 300)
    drift("butane", butane(), "Butane's beads with rigid bonds, at 2 fs.", 10000, 300)
    drift("waters", {**two_waters(), "step": 0.002}, "Two waters bound to each other, at 2 fs.", 5000, 300)
    drift("swinging_rotors", swinging_rotors(), "Six rotors on springs to their places, at 4 fs.", 10000, 300)
    drift("rigid_angles", rigid_angles_chain(), "A chain with rigid bonds and angles on springs, at 2 fs.", 10000, 300)
    for digits in (4, 8, 12):
        tolerance(f"of_1e_{digits}", free_chain_of_20(),
                  f"A chain of 20 keeps its bonds to a relative 1e-{digits} over 1000 steps.", 10.0**-digits)
    tolerance("in_a_fall", hung_chain_of_20(),
              "A hung chain that falls keeps its bonds to a relative 1e-8 over 1000 steps.", 1e-8)


if __name__ == "__main__":
    main()
