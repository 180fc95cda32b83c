"""A protein from a PDB file: its RMSD in water, with rigid bonds to hydrogen, by feedforward at 3 fs. Draws
protein.png.

Needs OpenMM and MDAnalysis: pip install openmm MDAnalysis
"""

import os

import numpy as np
from matplotlib import pyplot
from MDAnalysis.analysis.rms import rmsd
from openmm import app, unit

import taut

pdb = app.PDBFile(os.path.join(os.path.dirname(app.__file__), "data", "test.pdb"))
field = app.ForceField("amber14-all.xml", "amber14/tip3pfb.xml")
system = field.createSystem(pdb.topology, nonbondedMethod=app.PME, nonbondedCutoff=0.8 * unit.nanometer,
                            constraints=app.HBonds, hydrogenMass=3 * unit.dalton)
sim = taut.Simulation.from_openmm(system, pdb.positions, topology=pdb.topology, method="feedforward", dt_fs=3, set={
    "run.thermostat": "langevin", "run.temperature_k": 300, "run.velocities": "draw", "run.minimise": True})
print(sim, *sim.notes, sep="\n")

backbone = np.array([atom.name in ("N", "CA", "C") for atom in pdb.topology.atoms()])
start = sim.positions[backbone].copy()
frames: "list[tuple[float, float, float]]" = []


def look(row: taut.Row) -> None:
    frames.append((row.time_ps, row.temperature_k, rmsd(sim.positions[backbone], start, superposition=True)))
    print(row)


sim.run(1000, every=50, callback=look)
time, temperature, moved = np.array(frames).T
figure, (above, below) = pyplot.subplots(2, 1, sharex=True, layout="constrained")
above.plot(time, temperature)
above.set(ylabel="temperature [K]")
below.plot(time, moved)
below.set(xlabel="time [ps]", ylabel="RMSD of the backbone\nafter superposition [nm]")
figure.savefig("protein.png", dpi=150)
