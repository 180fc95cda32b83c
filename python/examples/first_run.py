"""A first run: 216 waters for 2 ps, their temperature and energy. Draws first_run.png."""

from matplotlib import pyplot

import taut

sim = taut.Simulation("water", method="feedforward", dt_fs=2)
sim.run(1000, every=50, callback=print)
print(f"bonds off by {sim.summary['max_rel_bond_error']:.1e} at most")

log, (figure, (above, below)) = sim.log, pyplot.subplots(2, 1, sharex=True, layout="constrained")
above.plot(log["time_ps"], log["temperature_k"])
above.set(ylabel="temperature [K]")
below.plot(log["time_ps"], log["total_kj_mol"] - log["total_kj_mol"][0])
below.set(xlabel="time [ps]", ylabel="total energy − start [kJ/mol]")
figure.savefig("first_run.png", dpi=150)
