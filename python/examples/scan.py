"""A scan: the energy drift of water against the step, for three methods. Draws scan.png."""

from matplotlib import pyplot

import taut

STEPS_FS = [1, 2, 3, 4, 5]
figure, axis = pyplot.subplots(layout="constrained")
for method in (taut.Feedforward(), taut.Rattle(tolerance=1e-8), taut.Shake(tolerance=1e-4)):
    name = f"{type(method).__name__}, tolerance {method.tolerance:g}"
    drifts, errors = [], []
    for dt_fs in STEPS_FS:
        with taut.Simulation("water", method=method, dt_fs=dt_fs, set={"run.seed": 7}) as sim:
            sim.run(4000 // dt_fs, every=10)
            drifts.append(sim.summary["energy_drift_kj_mol_ns_dof"])
            errors.append(sim.summary["energy_drift_standard_error"])
            print(f"{name}, {dt_fs} fs: {drifts[-1]:.3f} ± {errors[-1]:.3f} kJ/mol/ns/dof")
    axis.errorbar(STEPS_FS, drifts, errors, marker="o", label=name)
axis.set(xlabel="step [fs]", ylabel="energy drift [kJ/mol/ns/degree of freedom]")
axis.set_yscale("symlog", linthresh=0.1)
axis.legend()
figure.savefig("scan.png", dpi=150)
