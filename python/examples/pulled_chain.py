"""Chains pulled at their ends: extension against force, beside the Langevin function. Draws pulled_chain.png."""

import numpy as np
from matplotlib import pyplot

import taut

CHAINS, BEADS, LENGTH = 50, 21, 0.4  # bonds in nm


def chains_under(force: float) -> "dict[str, object]":
    return {"molecule": {"chain": {"atoms": [{"name": "B", "mass_u": 72}], "units": BEADS, "bonds": [[0, 1, LENGTH]],
                                   "pulls": [[-BEADS, -force, 0, 0], [-1, force, 0, 0]]}},
            "place": [{"molecule": "chain", "count": CHAINS}],
            "run": {"dt_fs": 20, "temperature_k": 300, "thermostat": "langevin", "friction_per_ps": 1}}


forces = [2.0, 5.0, 10.0, 20.0, 40.0]  # [kJ/mol/nm]
extensions = []
for force in forces:
    sim = taut.Simulation(chains_under(force), method="feedforward")
    stretched: "list[float]" = []

    def look(row: taut.Row) -> None:
        ends = sim.positions.reshape(CHAINS, BEADS, 3)[:, [0, -1], 0]
        stretched.append(np.diff(ends).mean() / ((BEADS - 1) * LENGTH))

    sim.run(12000, every=20, callback=look)
    after = taut.measure.equilibration(stretched)
    extensions.append(taut.measure.mean(stretched[after:]))
    print(f"{force:3.0f} kJ/mol/nm: {extensions[-1]} of the contour length")

figure, axis = pyplot.subplots(layout="constrained")
pull = np.linspace(0.1, 40, 200)
x = pull * LENGTH / (8.314462618e-3 * 300)
axis.plot(pull, 1 / np.tanh(x) - 1 / x, label="Langevin function")
axis.errorbar(forces, [e.value for e in extensions], [e.error for e in extensions], fmt="o", label="taut, rigid bonds")
axis.set(xlabel="force [kJ/mol/nm]", ylabel="extension / contour length")
axis.legend()
figure.savefig("pulled_chain.png", dpi=150)
