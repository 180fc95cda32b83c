#!/usr/bin/env python3
"""Finds the steps at which programs keep the energy of water, of a melt and of a protein, and what a day gives there.

    benchmarks/sound_steps.py --real FOLDER --out drifts.csv [--build build] [--systems "pme1728;melt"] [--ps 20]
    benchmarks/sound_steps.py --real FOLDER --time drifts.csv [--repeats 3]

The first command runs taut (newton and feedforward, mixed precision), GROMACS and OpenMM's CPU platform at constant
energy from one start, at several steps, one thread each, and writes the slopes of their total energies [kJ/mol/ns per
degree of freedom] with standard errors of four blocks; OpenMM for a fifth of the time. The protein's hydrogens have
their own mass, or 3 u; its rigid angles (OpenMM's HAngles) are taut's alone, since GROMACS's LINCS does not hold them.
The second times a second of every row of such a file in turns, on an idle machine, and prints nanoseconds a day,
medians. FOLDER is real_systems.py's. GROMACS has its defaults (LINCS of order 4 with one iteration, SETTLE for water, a
pair list for a drift of 0.005 kJ/mol/ps an atom) and, strict, order 6 with two iterations and a list for 1e-4. Python
needs taut and OpenMM.
"""
import copy
import csv
import json
import pathlib
import statistics
import subprocess
import tempfile

import numpy
import openmm
import openmm.app as app
import openmm.unit as unit

import machine
import peer_gromacs
import peer_systems
import real_systems

STEPS = {"pme1728": (2, 3, 4, 5), "melt": (5, 10, 15, 20), "dhfr": (2, 3), "dhfr, 3 u": (4, 5),
         "dhfr, angles, 3 u": (4, 5)}  # [fs]
TAUT = {"taut, newton": "newton", "taut, feedforward": "feedforward"}
STRICT = "\nlincs-order = 6\nlincs-iter = 2\nverlet-buffer-tolerance = 1e-4\n"


def slope(ps, energies, freedoms):
    """Returns the slope of the energies [kJ/mol] a nanosecond and degree of freedom, and its error by four blocks."""
    of = lambda t, e: numpy.polyfit(t, e, 1)[0] * 1000 / freedoms
    t, e = numpy.array(ps), numpy.array(energies)
    parts = [of(*part) for part in zip(numpy.array_split(t, 4), numpy.array_split(e, 4))]
    return of(t, e), numpy.std(parts, ddof=1) / 2 / 4  # the slope of all has four times the lever


class System:
    """One of STEPS: the start that all programs are given."""

    def __init__(self, name, taut, real, work):
        self.name, self.taut = name, taut
        self.heavy, self.angles = name.endswith("3 u"), "angles" in name
        if name.startswith("dhfr"):
            for suffix in ("top", "gro"):
                (work / f"dhfr.{suffix}").write_text((real / f"dhfr.{suffix}").read_text())
            real_systems.write_xml(work, "dhfr", app.HAngles if self.angles else app.HBonds,
                                   **({"hydrogenMass": 3 * unit.dalton} if self.heavy else {}))
            self.described = peer_systems.Prepared("dhfr", work)
            self.described.coupling = "mass-repartition-factor = 3" if self.heavy else ""
            files = ["--openmm", self.described.file("system.xml"), self.described.file("state.xml")]
            self.scene, self.set = files, ["forcefield.pme_order=4", f"forcefield.ewald_alpha_per_nm={self.described.alpha}",
                                           f"forcefield.pme_grid={list(self.described.mesh)}"]
        else:
            self.described = peer_systems.make(taut, [name])[0]
            water = name.startswith("pme")
            self.scene = ["water" if water else "melt"]
            self.set = [f"build.molecules={self.described.count}", "forcefield.coulomb=pme", "forcefield.pme_order=4",
                        "forcefield.ewald_alpha_per_nm=3.4705", f"forcefield.pme_grid={list(self.described.mesh)}"] if water else []
        seen = self.run_taut("newton", 1, 1)
        self.atoms, self.freedoms = seen["atoms"], seen["dof"]

    def run_taut(self, method, dt_fs, steps, every=20):
        command = [self.taut, "run", *self.scene, "--json", "--method", method, "--dt-fs", dt_fs, "--steps", steps, "--precision",
                   "mixed", "--threads", 1, "--set", f"run.log_every={every}", *self.set]
        done = subprocess.run(list(map(str, command)), capture_output=True, text=True)
        return json.loads(done.stdout) if done.returncode == 0 else None

    def gromacs(self, program, dt_fs):
        described = copy.copy(self.described)
        described.dt_fs = dt_fs
        described.coupling += STRICT if program == "GROMACS, strict" else ""
        return described

    def openmm_context(self, dt_fs):
        if self.scene[0] == "--openmm":
            system, state = (openmm.XmlSerializer.deserialize(pathlib.Path(file).read_text()) for file in self.scene[1:])
        else:
            import taut
            settings = {key: json.loads(value if value[0] in "[0123456789" else f'"{value}"')
                        for key, value in (text.split("=", 1) for text in self.set) if key != "forcefield.pme_order"}  # 5
            system, state = taut.Simulation(self.scene[0], set=settings).to_openmm()
        integrator = openmm.VerletIntegrator(dt_fs * 1e-3)
        integrator.setConstraintTolerance(1e-6)
        context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": "1"})
        context.setState(state)
        return context, integrator


def drift_of_taut(system, program, dt_fs, ps):
    seen = system.run_taut(TAUT[program], dt_fs, int(ps * 1000 / dt_fs))
    return seen and (seen["energy_drift_kj_mol_ns_dof"], seen["energy_drift_standard_error"] or 0)


def drift_of_gromacs(system, program, dt_fs, ps):
    with tempfile.TemporaryDirectory() as name:
        energies = peer_gromacs.energies(peer_gromacs.engines()[0], system.gromacs(program, dt_fs), int(ps * 1000 / dt_fs), pathlib.Path(name))
    return energies and slope(*energies, system.freedoms)


def drift_of_openmm(system, _, dt_fs, ps):
    context, integrator = system.openmm_context(dt_fs)
    times, energies = [], []
    for n in range(int(ps * 1000 / dt_fs / 5 / 20)):
        integrator.step(20)
        state = context.getState(getEnergy=True)
        times.append(20 * n * dt_fs * 1e-3)
        energies.append((state.getKineticEnergy() + state.getPotentialEnergy())._value)
    return slope(times, energies, system.freedoms) if numpy.isfinite(energies).all() else None


PROGRAMS = {**{program: drift_of_taut for program in TAUT}, "GROMACS": drift_of_gromacs, "GROMACS, strict": drift_of_gromacs,
            "OpenMM CPU": drift_of_openmm}


def us_a_step(system, program, dt_fs):
    if program in TAUT:
        measure = lambda steps: system.run_taut(TAUT[program], dt_fs, steps, steps)["us_per_step"]
        return measure(max(20, int(1e6 / measure(20))))
    if program.startswith("GROMACS"):
        return peer_gromacs.us_per_step(peer_gromacs.engines()[0], system.gromacs(program, dt_fs), 1, 1)
    import time
    context, integrator = system.openmm_context(dt_fs)
    integrator.step(10)
    started = time.perf_counter()
    integrator.step(20)
    context.getState(getEnergy=True)
    return (time.perf_counter() - started) / 20 * 1e6


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--real", type=pathlib.Path, required=True)
    parser.add_argument("--systems", default=";".join(STEPS), help="with semicolons between")
    parser.add_argument("--programs", nargs="+", default=list(PROGRAMS), choices=PROGRAMS)
    parser.add_argument("--ps", type=float, default=20)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--time", type=pathlib.Path)
    parser.add_argument("--repeats", type=int, default=3)
    told = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        systems = {}
        for name in told.systems.split(";"):
            (work := pathlib.Path(folder) / name).mkdir()
            systems[name] = System(name, told.build / "taut", told.real, work)
        measure(systems, told) if told.out else print_days(systems, told)


def measure(systems, told):
    with told.out.open("w") as file:
        print(f"# {machine.describe()}; {peer_gromacs.version(peer_gromacs.engines()[0])}, OpenMM {openmm.__version__}; "
              f"{told.ps:g} ps", file=file)
        table = csv.writer(file)
        table.writerow(["system", "program", "step_fs", "slope", "error"])
        for name, system in systems.items():
            for program in told.programs:
                if system.angles and program not in TAUT:
                    continue
                for dt_fs in STEPS[name]:
                    found = PROGRAMS[program](system, program, dt_fs, told.ps)
                    table.writerow([name, program, dt_fs, *(f"{number:.4f}" for number in found or ())])
                    file.flush()
                    if not found:
                        break  # it fails at longer steps, too


def print_days(systems, told):
    rows = [row for row in csv.reader(told.time.read_text().splitlines()[2:]) if row[0] in systems and len(row) == 5]
    seen = {}
    for _ in range(told.repeats):
        for n, (name, program, dt_fs, *_) in enumerate(rows):
            seen.setdefault(n, []).append(us_a_step(systems[name], program, float(dt_fs)))
    print(f"# {machine.describe()}; one thread; medians of {told.repeats} in turns")
    for us, (name, program, dt_fs, *slope) in zip(map(statistics.median, seen.values()), rows):
        print(f"{name:10} {program:18} {dt_fs:>3} fs {us:8.0f} µs {86400 * float(dt_fs) / us:8.1f} ns/day  {' ± '.join(slope)}")


if __name__ == "__main__":
    main()
