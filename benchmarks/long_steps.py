#!/usr/bin/env python3
"""Runs a protein in water at longer steps: hydrogens of 3 u, rigid H-X-H and H-O-X angles.

    benchmarks/long_steps.py FOLDER [--build build] [--system dhfr] [--ps 100] [--threads 2]
      [--methods newton feedforward] [--kinds h-bonds …] [--precisions mixed double]

FOLDER is real_systems.py's. Each kind of molecule (bonds of hydrogen rigid, or these and the angles, as OpenMM's HBonds
and HAngles have it; hydrogens of 1 or 3 u, the mass taken from the atom they are bonded to; waters always rigid) is
brought to 300 K for 10 ps at 1 fs, friction 5/ps; then it runs PS at constant energy, default PME.
Prints as CSV nanoseconds a day, the drift in kJ/mol/ns per degree of freedom with the part that the bonds' work has in
it, and temperatures of the protein's and of the waters' motions. Errors are taut's, of blocks. Needs OpenMM's reader.
"""
import csv
import itertools
import json
import pathlib
import subprocess
import sys
import tempfile

import openmm.app as app
import openmm.unit as unit

import machine
import real_systems

KINDS = {  # constraints, mass of hydrogen [u] and steps [fs]
    "h-bonds": (app.HBonds, None, (2, 3)),
    "h-bonds, 3 u": (app.HBonds, 3, (4, 5)),
    "h-angles": (app.HAngles, None, (2, 3)),
    "h-angles, 3 u": (app.HAngles, 3, (4, 5)),
}


def run(taut, files, out, *more):
    command = [taut, "run", "--openmm", *files, "--json", "--out", out, *map(str, more)]
    done = subprocess.run(command, capture_output=True, text=True)
    return json.loads(done.stdout) if done.returncode == 0 else {"failed": done.stderr.strip().splitlines()[0]}


def of(estimate):
    return f"{estimate['value']:.2f} ± {estimate['error'] or float('nan'):.2f}"


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--system", default="dhfr")
    parser.add_argument("--ps", type=float, default=100)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--methods", nargs="+", default=["newton", "feedforward"])
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=KINDS)
    parser.add_argument("--precisions", nargs="+", default=["mixed"])
    told = parser.parse_args()
    taut = told.build / "taut"
    print(f"# {machine.describe()}; {told.threads} threads, {told.ps:g} ps of {told.system}")
    table = csv.writer(sys.stdout)
    table.writerow(["rigid", "step_fs", "method", "precision", "bonds", "ns_per_day", "constraints_percent", "drift",
                    "of_the_bonds", "potential", "protein_inside_k", "water_translation_k", "water_rotation_k", "largest_bond_error"])
    for kind in told.kinds:
        constraints, mass, steps = KINDS[kind]
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            for suffix in ("top", "gro"):
                (work / f"x.{suffix}").write_text((told.folder / f"{told.system}.{suffix}").read_text())
            real_systems.write_xml(work, "x", constraints=constraints, hydrogenMass=mass and mass * unit.dalton)
            files = work / "x.system.xml", work / "x.state.xml"
            threads = "--threads", told.threads
            warm = run(taut, files, work / "warm", *threads, "--precision", "mixed", "--steps", 10_000, "--dt-fs", 1,
                       "--set", "run.thermostat=langevin", "run.temperature_k=300", "run.friction_per_ps=5",
                       "run.log_every=10000")
            if "failed" in warm:
                raise SystemExit(f"{kind}: {warm['failed']}")
            real_systems.write_gro_of(work / "x.gro", work / "warm")
            real_systems.write_xml(work, "x", constraints=constraints, hydrogenMass=mass and mass * unit.dalton)
            for dt_fs, method, precision in itertools.product(steps, told.methods, told.precisions):
                seen = run(taut, files, work / f"{dt_fs}{method}{precision}", *threads, "--precision", precision,
                           "--method", method, "--steps", int(told.ps * 1000 / dt_fs), "--dt-fs", dt_fs,
                           "--set", "run.log_every=20")
                if "failed" in seen:
                    table.writerow([kind, dt_fs, method, precision, seen["failed"]])
                    continue
                protein, water = seen["temperatures_k"].values()
                table.writerow([kind, dt_fs, method, precision, seen["bonds"], f"{seen['ns_per_day']:.1f}",
                                f"{100 * seen['constraint_us_per_step'] / seen['us_per_step']:.1f}",
                                f"{seen['energy_drift_kj_mol_ns_dof']:.3f} ± {seen['energy_drift_standard_error']:.3f}",
                                f"{seen['constraint_drift_kj_mol_ns_dof']:.3f}", f"{seen['potential_kj_mol']:.0f}",
                                of(protein["rest"]), of(water["translation"]), of(water["rotation"]),
                                f"{seen['max_rel_bond_error']:.1e}"])
                sys.stdout.flush()


if __name__ == "__main__":
    main()
