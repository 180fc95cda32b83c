"""What MDAnalysis finds in taut's output: the persistence length of stiff chains beside its closed form, water's
structure, its coordination and its dielectric constant. Draws analysis.png.

Needs MDAnalysis: pip install MDAnalysis
"""

import numpy as np
from matplotlib import pyplot
from MDAnalysis.analysis.dielectric import DielectricConstant
from MDAnalysis.analysis.polymer import PersistenceLength
from MDAnalysis.analysis.rdf import InterRDF

import taut

# Chains of rigid bonds with angles of energy K(1 + cos θ) have ⟨cos⟩ = coth κ − 1/κ from bond to bond, κ = K/kT, and
# the persistence length −b/ln⟨cos⟩. The metric correction gives rigid bonds these statistics of flexible ones.
BEADS, BOND, KAPPA, KELVIN = 30, 0.4, 4.0, 300
sim = taut.Simulation(
    {"molecule": {"chain": {"atoms": [{"name": "B", "mass_u": 72}], "units": BEADS, "bonds": [[0, 1, BOND]],
                            "cosine_angles": [[0, 1, 2, KAPPA * 8.314462618e-3 * KELVIN]]}},
     "place": [{"molecule": "chain", "count": 500}],
     "run": {"dt_fs": 10, "temperature_k": KELVIN, "thermostat": "langevin", "metric_correction": True}})
sim.reporters.append(taut.DCD("chains.dcd", every=500))  # the start has the angles' weight already
sim.run(2000)
universe = sim.universe()
universe.load_new("chains.dcd")
chains = [residue.atoms for residue in universe.residues]
stiff = PersistenceLength(chains).run()
cosine = 1 / np.tanh(KAPPA) - 1 / KAPPA
predicted = -BOND / np.log(cosine)
print(f"persistence length {stiff.results.lp / 10:.3f} nm; {predicted:.3f} nm by the closed form")

sim = taut.Simulation("water", method="feedforward", precision="mixed",
                      set={"run.thermostat": "langevin", "run.temperature_k": KELVIN, "forcefield.coulomb": "pme"})
sim.run(1000)
sim.reporters.append(taut.DCD("water.dcd", every=50))
sim.run(20_000)
universe = sim.universe()
universe.load_new("water.dcd")
universe.add_TopologyAttr("charges", np.tile([-0.834, 0.417, 0.417], 216))  # TIP3P's
oxygen = universe.select_atoms("element O")
pairs = InterRDF(oxygen, oxygen, nbins=90, range=(0, 9), exclusion_block=(1, 1)).run()
r, shell = pairs.results.bins / 10, pairs.results.count / len(oxygen) / pairs.n_frames
neighbours = np.interp(0.35, r + 0.005, np.cumsum(shell))
epsilon = DielectricConstant(universe.atoms, temperature=KELVIN, make_whole=False).run().results.eps_mean
print(f"{neighbours:.2f} neighbours within 0.35 nm; dielectric constant {epsilon:.0f} from {universe.trajectory.n_frames} "
      "frames")

figure, (left, right) = pyplot.subplots(1, 2, figsize=(10, 4), layout="constrained")
bonds = np.arange(12)
left.semilogy(bonds, stiff.results.bond_autocorrelation[:12], "o", label="MDAnalysis on taut's frames")
left.semilogy(bonds, cosine**bonds, label="(coth κ − 1/κ)ⁿ")
left.set(xlabel="bonds apart", ylabel="⟨cos⟩", title=f"chains of κ = {KAPPA:g}")
left.legend()
right.plot(r, pairs.results.rdf, label="g(r) of two oxygens")
right.plot(r, np.cumsum(shell), label="neighbours within r")
right.set(xlabel="distance [nm]", ylim=(0, 8), xlim=(0.2, 0.6), title=f"water: dielectric constant {epsilon:.0f}")
right.legend()
figure.savefig("analysis.png", dpi=150)
