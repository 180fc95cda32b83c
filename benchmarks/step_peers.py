#!/usr/bin/env python3
"""Times whole steps of taut, OpenMM's CPU platform, GROMACS and LAMMPS on the same systems, in the same run.

    benchmarks/step_peers.py [--build build] [--systems water1728,water5832,chain,dipeptide] [--threads 1,2] [--repeats 5]

Systems pme1728, pme5832, … are waters with PME (order 4, points 0.116 nm apart, all programs alike but OpenMM, which
has order 5); decane, melt and chain are taut's own scenes, decane5120, melt6000 and chain6000 the same of so many
atoms. With --real FOLDER the systems are those that real_systems.py wrote there (dhfr, dhfr8, charmm, lipid, dna), with
PME at equal α, grid and order (OpenMM's order is 5), 2 fs, rigid bonds of hydrogen, for taut (newton) through `taut
run`, for GROMACS, and for OpenMM's CPU platform where Python has it. Prints medians in µs a step and how many times
longer than taut's each takes, at equal threads, and writes benchmarks/results/step_peers.csv, where rows of other
systems stay if they are of the same machine, programs and day: a table can be made in parts. All take turns in every
repeat, so that they meet the same machine. taut and OpenMM go through step_bench; GROMACS (gmx, gmx_d; peer_gromacs.py
says which build of it) and LAMMPS (lmp, waters only: its RATTLE takes four atoms at most) are given the same positions,
cutoffs, bonds, angles and torsions, but not the dipeptide; what is not installed is skipped. Two threads need an idle
machine: threads wait for each other spinning (OMP_WAIT_POLICY=passive makes them sleep, which costs more than a small
step takes).
"""
import csv
import json
import math
import pathlib
import re
import statistics
import subprocess
import sys
import time

import machine
import peer_gromacs
import peer_lammps
import peer_systems

STEPS = 20  # a benchmark's iteration
HANDOVERS = 1000
TO_US = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


def through_step_bench(program, systems, threads, seconds):
    """{(engine, precision, system, threads): µs a step} of taut and of OpenMM, where taut was built with it."""
    counts = "|".join(map(str, threads))
    command = [program, f"--benchmark_filter=^(step|openmm)/({'|'.join(systems)})/.*/({counts})/",
               f"--benchmark_min_time={seconds}", "--benchmark_format=json"]
    report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    runs = {}
    for run in report["benchmarks"]:
        part, system, precision, n = run["name"].split("/")[:4]
        engine = "taut" if part == "step" else "OpenMM CPU"
        runs[engine, precision if part == "step" else "mixed", system, int(n)] = run["real_time"] * TO_US[run["time_unit"]] / STEPS
    return runs


def through_run(program, systems, threads, seconds):
    """{(engine, precision, system, threads): µs a step} of `taut run` on prepared systems."""
    runs = {}
    for prepared in systems:
        for precision in ("double", "mixed"):
            for n in threads:
                def measure(steps):
                    command = [program, "run", "--openmm", prepared.file("system.xml"), prepared.file("state.xml"), "--json",
                               "--steps", str(steps), "--dt-fs", str(prepared.dt_fs), "--precision", precision,
                               "--threads", str(n), "--set", f"run.log_every={steps}", "forcefield.pme_order=4",
                               f"forcefield.ewald_alpha_per_nm={prepared.alpha}", f"forcefield.pme_grid={list(prepared.mesh)}"]
                    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["us_per_step"]
                steps = int(seconds * 1e6 / measure(prepared.first_steps))
                runs["taut", precision, prepared.name, n] = measure(max(steps, prepared.first_steps))
    return runs


def through_openmm(systems, threads, seconds):
    """{(engine, precision, system, threads): µs a step} of OpenMM's CPU platform on prepared systems."""
    try:
        import openmm
    except ImportError:
        return {}
    runs = {}
    for prepared in systems:
        system = openmm.XmlSerializer.deserialize(prepared.file("system.xml").read_text())
        state = openmm.XmlSerializer.deserialize(prepared.file("state.xml").read_text())
        for force in system.getForces():
            if isinstance(force, openmm.NonbondedForce):
                force.setPMEParameters(prepared.alpha, *prepared.mesh)
        for n in threads:
            integrator = openmm.VerletIntegrator(prepared.dt_fs * 1e-3)
            integrator.setConstraintTolerance(1e-6)
            context = openmm.Context(system, integrator, openmm.Platform.getPlatformByName("CPU"), {"Threads": str(n)})
            context.setState(state)

            def measure(steps):
                integrator.step(5)
                start = time.perf_counter()
                integrator.step(steps)
                context.getState(getEnergy=True)
                return (time.perf_counter() - start) / steps * 1e6
            runs["OpenMM CPU", "mixed", prepared.name, n] = measure(max(10, int(seconds * 1e6 / measure(5))))
    return runs


def through_peers(systems, threads, seconds):
    runs = {}
    for molecules in systems:
        for n in threads:
            for program in peer_gromacs.engines():
                runs[f"GROMACS {pathlib.Path(program).name}", peer_gromacs.precision(program), molecules.name, n] = \
                    peer_gromacs.us_per_step(program, molecules, n, seconds)
            for _ in [] if molecules.mesh else peer_lammps.engines():
                runs["LAMMPS", "double", molecules.name, n] = peer_lammps.us_per_step(molecules, n, seconds)
    return {key: us for key, us in runs.items() if not math.isnan(us)}


def versions():
    if "openmm" in sys.modules:
        openmm = sys.modules["openmm"].version.full_version
    else:
        openmm = subprocess.run(["dpkg-query", "-W", "-f=${Version}", "libopenmm-dev"], capture_output=True, text=True).stdout
    return [f"OpenMM {openmm or 'unknown'}", *(peer_gromacs.version(p) for p in peer_gromacs.engines()),
            *(peer_lammps.version() for _ in peer_lammps.engines())]


def hand_over(program):
    """What a line of memory takes from one core to another [ns]: two threads gain more or less with it."""
    report = json.loads(subprocess.run([program, "--benchmark_filter=^handover/", "--benchmark_min_time=0.02",
                                        "--benchmark_format=json"], check=True, capture_output=True, text=True).stdout)
    return report["benchmarks"][0]["real_time"] * TO_US[report["benchmarks"][0]["time_unit"]] * 1e3 / HANDOVERS


def kept_rows(path, head, systems):
    """The file's rows of other systems, where it tells of the same machine, programs and day."""
    first, *lines = path.read_text().splitlines() if path.exists() else [""]
    same = lambda line: re.sub(r", load [\d.]+|; core to core.*", "", line)
    return [row for row in csv.reader(lines[1:]) if row[0] not in systems] if same(first) == same(head) else []


def main():
    parser = machine.argument_parser(__doc__)
    here = pathlib.Path(__file__).parent
    parser.add_argument("--systems", default="water1728,water5832,chain,dipeptide")
    parser.add_argument("--real", type=pathlib.Path, help="the folder that real_systems.py wrote")
    parser.add_argument("--threads", default="1,2")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=0.5, help="of each measurement")
    parser.add_argument("--out", type=pathlib.Path, default=here / "results" / "step_peers.csv")
    arguments = parser.parse_args()
    names, threads = arguments.systems.split(","), [int(n) for n in arguments.threads.split(",")]
    if arguments.real:
        systems = [peer_systems.Prepared(name, arguments.real) for name in names]
        own = [lambda *a: through_run(arguments.build / "taut", *a), through_openmm]
    else:
        systems = peer_systems.make(arguments.build / "taut", names)
        own = [lambda systems, *a: through_step_bench(arguments.build / "step_bench", names, *a)]

    seen, ns = {}, []
    for repeat in range(arguments.repeats):
        print(f"repeat {repeat + 1} of {arguments.repeats}", file=sys.stderr)
        if max(threads) > 1:
            ns.append(hand_over(arguments.build / "step_bench"))
        for measure in (*own, through_peers):
            for key, us in measure(systems, threads, arguments.seconds).items():
                seen.setdefault(key, []).append(us)

    median = {key: statistics.median(values) for key, values in seen.items()}
    head = f"# {machine.describe()}; {'; '.join(versions())}; medians of {arguments.repeats}"
    head += f"; core to core {min(ns):.0f} to {max(ns):.0f} ns" if ns else ""
    kept = kept_rows(arguments.out, head, names)
    with open(arguments.out, "w", newline="") as file:
        file.write(f"{head}\n")
        writer = csv.writer(file)
        writer.writerow(["system", "threads", "engine", "precision", "us_per_step", "over_taut_double", "over_taut_mixed"])
        writer.writerows(kept)
        for system in names:
            for n in threads:
                print(f"{system}, {n} thread{'s' * (n > 1)}")
                rows = sorted((us, engine, precision) for (engine, precision, s, t), us in median.items() if (s, t) == (system, n))
                for us, engine, precision in rows:
                    over = [us / median["taut", p, system, n] for p in ("double", "mixed")]
                    print(f"  {engine:<14} {precision:<7} {us:>10.1f} µs   {over[0]:5.2f} × taut double  {over[1]:5.2f} × taut mixed")
                    writer.writerow([system, n, engine, precision, f"{us:.1f}", *(f"{o:.2f}" for o in over)])
    print(f"wrote {arguments.out}")


if __name__ == "__main__":
    main()
