"""Your own method: SHAKE in Python, charted beside the built-in. Draws own_method.png."""

from dataclasses import dataclass

import numpy as np

import taut


@dataclass
class MyShake(taut.ConstraintMethod):
    """SHAKE, bond after bond along the bonds before (Ryckaert, Ciccotti, Berendsen 1977)"""

    tolerance: float = 1e-8
    holds = "positions"

    def prepare(self, system, h):
        self.promised_error = self.tolerance

    def project_positions(self, system, h, state):
        x, v, w, d2 = state.positions, state.velocities, system.inverse_masses, system.lengths**2
        start, (I, J) = x.copy(), system.bonds.T
        r0 = (x - h * v)[J] - (x - h * v)[I]
        for sweep in range(500):
            r = x[J] - x[I]
            if np.max(abs((r * r).sum(1) - d2) / (2 * d2)) < self.tolerance:
                state.velocities += (x - start) / h
                return sweep
            for k in system.groups:
                i, j, r = I[k], J[k], x[J[k]] - x[I[k]]
                g = (d2[k] - (r * r).sum(1)) / (2 * (w[i] + w[j]) * (r * r0[k]).sum(1))
                x[i] -= (g * w[i])[:, None] * r0[k]
                x[j] += (g * w[j])[:, None] * r0[k]
        return taut.NotConverged(500)


charted = taut.chart("freely_jointed", methods=["shake", "rattle", MyShake], quick=True, panels="work", draw=True)
charted["figure"].savefig("own_method.png", dpi=150)
print("own_method.png: constraint time against bond error; MyShake holds bonds as shake does, at Python's cost")
