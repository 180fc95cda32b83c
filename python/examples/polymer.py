"""A freely jointed chain's end-to-end distance: its distribution beside the Gaussian chain's, and ⟨R²⟩ beside
N b². Draws polymer.png."""

import numpy as np
import numpy.typing as npt
from matplotlib import pyplot

import taut

CHAINS, BEADS = 200, 21
sim = taut.Simulation("freely_jointed", method="feedforward", dt_fs=10, set={
    "build.chains": CHAINS, "build.beads": BEADS, "run.thermostat": "langevin", "run.temperature_k": 300,
    "run.velocities": "draw"})
length = sim.lengths[0]
distances: "list[npt.NDArray[np.float64]]" = []


def look(row: taut.Row) -> None:
    chains = sim.positions.reshape(CHAINS, BEADS, 3)
    distances.append(np.linalg.norm(chains[:, -1] - chains[:, 0], axis=1))


sim.run(4000, every=100, callback=look)
mean = (np.array(distances) ** 2).mean() / ((BEADS - 1) * length**2)
print(f"<R²> = {mean:.3f} N b², {CHAINS} chains, {len(distances)} frames")

figure, axis = pyplot.subplots(layout="constrained")
axis.hist(np.array(distances).ravel(), 40, density=True, label="taut")
r = np.linspace(0, (BEADS - 1) * length, 200)
s2 = (BEADS - 1) * length**2 / 3
axis.plot(r, 4 * np.pi * r**2 * (2 * np.pi * s2) ** -1.5 * np.exp(-r**2 / (2 * s2)), label="Gaussian chain")
axis.set(xlabel="end-to-end distance [nm]", ylabel="density [1/nm]")
axis.legend()
figure.savefig("polymer.png", dpi=150)
