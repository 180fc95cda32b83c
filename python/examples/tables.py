"""Boltzmann inversion: a distribution of angles becomes a table of energies, and chains with this table have the
distribution. Draws tables.png."""

import numpy as np
from matplotlib import pyplot

import taut

CHAINS, BEADS, KT = 200, 12, 8.314462618e-3 * 300

# p(θ), of an atomistic run for example. A free angle has p ∝ sin θ, so that the energy is −kT ln(p / sin θ).
degrees = np.arange(181.0)
density = 0.6 / 14 * np.exp(-((degrees - 105) / 14) ** 2 / 2) + 0.4 / 12 * np.exp(-((degrees - 145) / 12) ** 2 / 2)
p = density * np.sin(np.radians(degrees))
p /= p.sum()
np.savetxt("angle.csv", np.column_stack([degrees, -KT * np.log(density)]), delimiter=",")

# The metric correction gives rigid bonds the statistics of flexible ones.
sim = taut.Simulation(
    {"molecule": {"chain": {"atoms": [{"name": "B", "mass_u": 72}], "units": BEADS, "bonds": [[0, 1, 0.35]],
                            "tables": [{"file": "angle.csv", "angles": [[0, 1, 2]]}]}},
     "place": [{"molecule": "chain", "count": CHAINS}],
     "run": {"dt_fs": 10, "temperature_k": 300, "thermostat": "langevin", "metric_correction": True}})
cosines: "list[float]" = []
seen = np.zeros(36)


def look(row: taut.Row) -> None:
    bonds = np.diff(sim.positions.reshape(CHAINS, BEADS, 3), axis=1) / 0.35
    cosine = -(bonds[:, 1:] * bonds[:, :-1]).sum(axis=2)
    cosines.append(cosine.mean())
    seen[:] += np.histogram(np.degrees(np.arccos(cosine)), bins=36, range=(0, 180))[0]


sim.run(2000)
sim.run(8000, every=20, callback=look)
predicted = (p * np.cos(np.radians(degrees))).sum()
print(f"⟨cos θ⟩ = {taut.measure.mean(cosines)}; {predicted:.4f} by the distribution that was inverted")

figure, axis = pyplot.subplots(layout="constrained")
axis.plot(degrees, p, label="the distribution that was inverted")
axis.plot(np.arange(2.5, 180, 5), seen / seen.sum() / 5, "o", label="taut, rigid bonds and the table")
axis.set(xlabel="angle [°]", ylabel="p(θ) [1/°]")
axis.legend()
figure.savefig("tables.png", dpi=150)
