"""A protein in water as openmm.app makes it, hydrogens rigid, by feedforward at 3 fs. Draws protein.png.

Needs OpenMM: pip install openmm
"""

import os

import numpy as np
from matplotlib import pyplot
from openmm import app, unit

import taut

pdb = app.PDBFile(os.path.join(os.path.dirname(app.__file__), "data", "test.pdb"))
field = app.ForceField("amber14-all.xml", "amber14/tip3pfb.xml")
system = field.createSystem(pdb.topology, nonbondedMethod=app.PME, nonbondedCutoff=0.8 * unit.nanometer,
                            constraints=app.HBonds, hydrogenMass=3 * unit.dalton)
sim = taut.Simulation.from_openmm(system, pdb.positions, topology=pdb.topology, method="feedforward", dt_fs=3, set={
    "run.thermostat": "langevin", "run.temperature_k": 300, "run.velocities": "draw", "run.minimise": True})
print(sim, *sim.notes, sep="\n")

protein = np.array([atom.residue.name != "HOH" for atom in pdb.topology.atoms()])
start = sim.positions[protein].copy()
frames: "list[tuple[float, float, float]]" = []


def look(row):
    frames.append((row.time_ps, row.temperature_k, np.sqrt(((sim.positions[protein] - start) ** 2).sum(1).mean())))
    print(row)


sim.run(1000, every=50, callback=look)
time, temperature, moved = np.array(frames).T
figure, (above, below) = pyplot.subplots(2, 1, sharex=True, layout="constrained")
above.plot(time, temperature)
above.set(ylabel="temperature [K]")
below.plot(time, moved)
below.set(xlabel="time [ps]", ylabel="protein: rms distance\nfrom its start [nm]")
figure.savefig("protein.png", dpi=150)
