"""taut.verify: checks a constraint method."""

from __future__ import annotations

from typing import Any, Dict, Mapping, Optional

import numpy as np
import numpy.typing as npt

from . import inputs
from .simulation import Simulation


def _across_bonds(change: npt.NDArray[Any], bonds: npt.NDArray[Any], places: npt.NDArray[Any]) -> float:
    """Returns the norm of the part of changes of momentum, (n, 3), that no forces along the bonds at `places` give."""
    columns = []
    for positions in places:
        i, j = bonds.T
        r = positions[j] - positions[i]
        jacobian = np.zeros((len(bonds), *change.shape))
        k = np.arange(len(bonds))
        jacobian[k, i], jacobian[k, j] = -r, r
        columns.append(jacobian.reshape(len(bonds), -1).T)
    basis = np.hstack(columns)
    along = basis @ np.linalg.lstsq(basis, change.ravel(), rcond=None)[0]
    return float(np.linalg.norm(change.ravel() - along))


def verify(method: inputs.Method, scene: inputs.Scene = "freely_jointed", *, dt_fs: Optional[float] = None,
           steps: int = 40, set: Optional[Mapping[str, Any]] = None) -> Dict[str, Any]:
    """Runs a method and measures at every step what a constraint method must keep.

    - ``method``: a name, options, or a class of your own
    - ``scene``, ``dt_fs``, ``set``: as for ``taut.Simulation``
    - ``steps``: number of steps

    Returns a dict:

    - ``bond_error``: largest relative error of a bond's length
    - ``bond_rate``: largest relative change of a bond's length in a step that the velocities still hold, h |r·v| / d²
    - ``momentum``: change of the momentum over Σ m|v|; nan if atoms are anchored
    - ``across_bonds``: share of the method's impulses that does not lie along the bonds before and after a step; nan
      if other forces act. The scene freely_jointed has no other forces
    - ``energy``: |E − E₀| at the end over the largest kinetic energy of the run
    - ``same_again``: True if a second run has the same bits
    - ``resumes``: True if a run from a checkpoint half way has the same bits; if False, ``kept`` lacks an attribute

    Source: GROMACS's tests of constraint algorithms check lengths, direction and centre of mass likewise.
    """
    if scene == "freely_jointed":
        set = {"build.chains": 2, **(set or {})}
    sim, again = (Simulation(scene, method=method, dt_fs=dt_fs, set=set) for _ in range(2))
    masses, bonds = sim.masses[:, None], sim.bonds
    i, j = bonds.T
    free = bool(np.all(sim.masses > 0))
    first = sim.energies
    momentum, scale = (masses * sim.velocities).sum(0), (masses * abs(sim.velocities)).sum()
    found: Dict[str, Any] = {"bond_error": 0.0, "bond_rate": 0.0}
    across = impulses = 0.0
    kinetic = first["kinetic"]
    for n in range(steps):
        before = sim.positions.copy(), sim.velocities.copy()
        sim.step()
        r, v = sim.positions[j] - sim.positions[i], sim.velocities[j] - sim.velocities[i]
        rate = sim.dt_fs / 1000 * abs((r * v).sum(1)) / sim.lengths**2
        found["bond_error"] = max(found["bond_error"], abs(sim.bond_errors).max())
        found["bond_rate"] = max(found["bond_rate"], rate.max())
        energies = sim.energies
        kinetic = max(kinetic, energies["kinetic"])
        if free and energies["potential"] == 0:
            change = masses * (sim.velocities - before[1])
            across = max(across, _across_bonds(change, bonds, np.array([before[0], sim.positions])))
            impulses = max(impulses, float(np.linalg.norm(change)))
        if n + 1 == steps // 2:
            resumed = Simulation.resume(sim.checkpoint())
    again.step(steps)
    resumed.step(steps - steps // 2)
    found["momentum"] = float(np.linalg.norm((masses * sim.velocities).sum(0) - momentum) / scale) if free else np.nan
    found["across_bonds"] = across / impulses if impulses else np.nan
    found["energy"] = abs(sim.energies["total"] - first["total"]) / kinetic
    for name, other in (("same_again", again), ("resumes", resumed)):
        found[name] = bool(np.array_equal(sim.positions, other.positions)
                           and np.array_equal(sim.velocities, other.velocities))
    return found
