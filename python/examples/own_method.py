"""Your own method: SHAKE in Python, charted beside the built-in. Draws own_method.png."""

from dataclasses import dataclass
from functools import partial

import numpy as np

import taut


dots = partial(np.einsum, "ij,ij->i")  # of rows


@dataclass
class MyShake(taut.ConstraintMethod):
    """SHAKE (Ryckaert, Ciccotti, Berendsen 1977), overrelaxed (Barth et al. 1995, doi:10.1002/jcc.540161003)"""

    tolerance: float = 1e-8
    relaxation: float = 1.25  # 1: plain SHAKE
    holds = "positions"

    def prepare(self, system, h):
        self.promised_error, w = self.tolerance, system.inverse_masses[system.bonds]
        pull = self.relaxation / 2 * w / w.sum(1, keepdims=True) * [1, -1]
        self.groups = [(system.bonds[k].T, pull[k].T[:, :, None], system.lengths[k]**2) for k in system.groups]

    def project_positions(self, system, h, state):
        x, (i, j), before = state.positions, system.bonds.T, state.positions - h * state.velocities
        start, r0 = x.copy(), [before[b] - before[a] for (a, b), _, _ in self.groups]
        for sweep in range(500):
            r = x.take(j, 0) - x.take(i, 0)
            if abs(dots(r, r) / system.lengths**2 - 1).max() < 2 * self.tolerance:
                state.velocities += (x - start) / h
                return sweep
            for (ends, pull, d2), along in zip(self.groups, r0):  # bonds of a group share no atom
                pair = x.take(ends, 0)
                r = pair[1] - pair[0]
                x[ends] = pair + pull * ((dots(r, r) - d2) / dots(r, along))[:, None] * along
        return taut.NotConverged(500)


charted = taut.chart("freely_jointed", methods=["shake", "rattle", MyShake], quick=True, panels="work", draw=True)
charted["figure"].savefig("own_method.png", dpi=150)
print("own_method.png: constraint time against bond error; MyShake holds bonds as shake does, at Python's cost")
