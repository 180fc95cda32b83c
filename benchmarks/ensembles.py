#!/usr/bin/env python3
"""Measures what thermostats and barostats add to a step of water, beside GROMACS's.

    GMX=/path/to/gmx benchmarks/ensembles.py [--build build] [--molecules 1728,5832] [--threads 1] [--repeats 5]

TIP3P with PME (step_peers.py's pme systems), mixed precision, 2 fs, settle. taut's Langevin thermostat stands beside
GROMACS's sd, rescaling beside v-rescale (every 10 steps), c-rescale beside c-rescale (every 10 steps, both with velocity
rescaling); the Monte Carlo barostat (a trial every 25 steps) has no peer there. Prints medians in µs a step of programs
that take turns, and what each ensemble adds to the plain step of its program.
"""
import dataclasses
import json
import statistics
import subprocess

import machine
import peer_gromacs
import peer_systems

BATH = "tcoupl = v-rescale\ntc-grps = System\ntau-t = 1\nref-t = 300\nnsttcouple = 10\n"
CELL = "pcoupl = c-rescale\npcoupltype = isotropic\ntau-p = 5\nref-p = 1\ncompressibility = 4.5e-5\nnstpcouple = 10\n"
TAUT_BATH = ["run.thermostat=rescaling", "run.temperature_k=300", "run.thermostat_ps=1"]
ENSEMBLES = {  # taut's settings; GROMACS's integrator and lines of its .mdp, if it has the like
    "constant energy": ([], ("md", "")),
    "velocity rescaling": (TAUT_BATH, ("md", BATH)),
    "Langevin": (["run.thermostat=langevin", "run.temperature_k=300"], ("sd", "tc-grps = System\ntau-t = 1\nref-t = 300\n")),
    "rescaling, c-rescale": ([*TAUT_BATH, "run.barostat=c-rescale", "run.barostat_ps=5", "run.barostat_every=10"],
                             ("md", BATH + CELL)),
    "rescaling, Monte Carlo": ([*TAUT_BATH, "run.barostat=monte-carlo", "run.barostat_every=25"], None),
}


def us_of_taut(taut, molecules, settings, threads, seconds):
    def measure(steps):
        command = [taut, "run", "water", "--json", "--steps", str(steps), "--precision", "mixed", "--threads", str(threads),
                   "--set", f"build.molecules={molecules.count}", "method.name=settle", "forcefield.coulomb=pme",
                   "forcefield.pme_order=4", "forcefield.ewald_alpha_per_nm=3.4705",
                   f"forcefield.pme_grid={list(molecules.mesh)}", f"run.log_every={steps}", *settings]
        return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["us_per_step"]
    return measure(int(seconds * 1e6 / measure(200)))


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--molecules", default="1728,5832")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=1, help="of each measurement")
    told = parser.parse_args()
    systems = peer_systems.make(told.build / "taut", [f"pme{count}" for count in told.molecules.split(",")])
    seen = {}
    for _ in range(told.repeats):
        for molecules in systems:
            for name, (settings, peer) in ENSEMBLES.items():
                us = us_of_taut(told.build / "taut", molecules, settings, told.threads, told.seconds)
                seen.setdefault((molecules.name, "taut", name), []).append(us)
                for program in peer_gromacs.engines() if peer else []:
                    coupled = dataclasses.replace(molecules, integrator=peer[0], coupling=peer[1])
                    us = peer_gromacs.us_per_step(program, coupled, told.threads, told.seconds)
                    seen.setdefault((molecules.name, "GROMACS", name), []).append(us)
    print(f"# {machine.describe()}; {'; '.join(map(peer_gromacs.version, peer_gromacs.engines()))}; {told.threads} threads; "
          f"medians of {told.repeats}, µs a step (more than at constant energy)")
    for (system, program, name), values in sorted(seen.items()):
        us, plain = statistics.median(values), statistics.median(seen[system, program, "constant energy"])
        print(f"{system:8} {program:8} {name:24} {us:9.0f}  {us - plain:+8.0f}  {us / plain - 1:+7.1%}")


if __name__ == "__main__":
    main()
