"""Water's structure: the g(r) of oxygen that MDAnalysis finds in a trajectory that taut has written. Draws water.png.

Needs MDAnalysis: pip install MDAnalysis
"""

from matplotlib import pyplot
from MDAnalysis.analysis.rdf import InterRDF

import taut

sim = taut.Simulation("water", method="feedforward", set={"run.thermostat": "langevin", "run.temperature_k": 300})
sim.run(1000)  # forget the start
sim.reporters.append(taut.DCD("water.dcd", every=20))
sim.run(2000, every=50)
print(f"{sim.log['temperature_k'].mean():.0f} K")

universe = sim.universe()
universe.load_new("water.dcd")
oxygen = universe.select_atoms("element O")
pairs = InterRDF(oxygen, oxygen, nbins=80, range=(1.5, 9), exclusion_block=(1, 1)).run()
figure, axis = pyplot.subplots(layout="constrained")
axis.plot(pairs.results.bins / 10, pairs.results.rdf)
axis.set(xlabel="distance of two oxygens [nm]", ylabel="g(r)")
figure.savefig("water.png", dpi=150)
