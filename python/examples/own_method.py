"""Your own method: SHAKE in Python, charted beside the built-in. Draws own_method.png."""

from dataclasses import dataclass

import taut


@dataclass
class MyShake(taut.ConstraintMethod):
    """SHAKE (Ryckaert, Ciccotti, Berendsen 1977), overrelaxed (Barth et al. 1995, doi:10.1002/jcc.540161003)"""

    tolerance: float = 1e-8
    relaxation: float = 1.25  # 1: plain SHAKE
    holds = "positions"

    def prepare(self, system: taut.System, h: float) -> None:
        self.promised_error, w = self.tolerance, system.inverse_masses[system.bonds]
        pull = self.relaxation / 2 * w / w.sum(1, keepdims=True) * [1, -1]
        self.groups = [(system.bonds[k].T, pull[k].T, system.lengths[k]**2) for k in system.groups]

    def project_positions(self, system: taut.System, h: float, state: taut.State) -> "int | taut.NotConverged":
        x, before = state.positions.T.copy(), (state.positions - h * state.velocities).T  # (3, n): numpy's fast way
        (i, j), r0 = system.bonds.T, [before[:, b] - before[:, a] for (a, b), _, _ in self.groups]
        for sweep in range(500):
            r = x.take(j, 1) - x.take(i, 1)
            if abs((r * r).sum(0) / system.lengths**2 - 1).max() < 2 * self.tolerance:
                state.positions, state.velocities = x.T, state.velocities + (x.T - state.positions) / h
                return sweep
            for (ends, pull, d2), along in zip(self.groups, r0):  # bonds of a group share no atom
                pair = x.take(ends, 1)  # (3, 2, bonds)
                r = pair[:, 1] - pair[:, 0]
                g = ((r * r).sum(0) - d2) / (r * along).sum(0)
                x[:, ends] = pair + pull * g * along[:, None]
        return taut.NotConverged(500)


charted = taut.chart("freely_jointed", methods=["shake", "rattle", MyShake], quick=True, panels="work", draw=True)
taut.pictures.save(charted["figures"]["work"], "own_method")
print("own_method.png: constraint time against bond error; MyShake holds bonds as shake does, at Python's cost")
