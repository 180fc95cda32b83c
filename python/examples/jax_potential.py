"""A potential of your own, whose forces jax finds: a double well for an end-to-end distance. Draws jax_potential.png.

Needs jax: pip install jax
"""

import os

os.environ["JAX_ENABLE_X64"] = "1"  # before jax comes

import jax
import numpy as np
import numpy.typing as npt
from matplotlib import pyplot

import taut


def well(x: jax.Array) -> jax.Array:
    r = jax.numpy.linalg.norm(x[-1] - x[0])
    energy: jax.Array = 4 * ((r - 1) * (r - 3)) ** 2  # [kJ/mol], wells at 1 and 3 nm
    return energy


class Potential(taut.Force):
    with_slope = staticmethod(jax.jit(jax.value_and_grad(well)))

    def add(self, positions: npt.NDArray[np.float64], forces: npt.NDArray[np.float64]) -> float:
        value, slope = self.with_slope(positions)
        forces -= np.asarray(slope)
        return float(value)


sim = taut.Simulation("freely_jointed", method="newton", forces=[Potential()], set={
    "build.chains": 1, "build.beads": 5, "run.thermostat": "langevin", "run.velocities": "draw"})
distances: "list[float]" = []
sim.run(20000, every=20, callback=lambda row: distances.append(
    float(np.linalg.norm(sim.positions[-1] - sim.positions[0]))))
figure, axis = pyplot.subplots(layout="constrained")
axis.hist(distances, 60)
axis.set(xlabel="end-to-end distance [nm]", ylabel="frames")
figure.savefig("jax_potential.png", dpi=150)
