#!/usr/bin/env python3
"""Whole steps of taut beside OpenMM's CPU platform, on the same systems, in the same run.

    benchmarks/step_peers.py build/step_bench [--scenes water1728,lj_chains] [--repeats 5]

Medians of repeats in random order. Prints µs a step and the ratio to OpenMM at equal threads, and writes
benchmarks/results/step_peers.csv. `cpu` is what all threads together spent on a processor: at one thread it is
the time a step takes, on a busy machine too. `wall` is the clock.
"""
import argparse
import csv
import json
import os
import pathlib
import statistics
import subprocess

STEPS = 20  # a benchmark's iteration
TO_US = {"ns": 1e-3, "us": 1.0, "ms": 1e3, "s": 1e6}


def measure(program, scenes, repeats):
    """{(part, scene, precision, threads): (wall, cpu)}, medians [µs a step]."""
    command = [program, f"--benchmark_filter=^(step|openmm)/({'|'.join(scenes)})/",
               f"--benchmark_repetitions={repeats}", "--benchmark_enable_random_interleaving=true",
               "--benchmark_min_time=0.2", "--benchmark_format=json"]
    environment = {"OMP_WAIT_POLICY": "passive", **os.environ}
    report = json.loads(subprocess.run(command, check=True, capture_output=True, text=True, env=environment).stdout)
    runs = {}
    for run in report["benchmarks"]:
        if run["run_type"] != "iteration":
            continue
        part, scene, precision, threads = run["name"].split("/")[:4]
        scale = TO_US[run["time_unit"]] / STEPS
        runs.setdefault((part, scene, precision, int(threads)), []).append(
            (run["real_time"] * scale, run["cpu_time"] * scale))
    medians = {key: tuple(statistics.median(column) for column in zip(*rows)) for key, rows in runs.items()}
    return report["context"], medians


def cpu_name():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return "unknown"


def openmm_version():
    query = subprocess.run(["dpkg-query", "-W", "-f=${Version}", "libopenmm-dev"], capture_output=True, text=True)
    return query.stdout or "unknown"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--scenes", default="water216,water1728,water5832,lj_chains,decane")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--out", default=pathlib.Path(__file__).parent / "results" / "step_peers.csv")
    arguments = parser.parse_args()
    context, medians = measure(arguments.program, arguments.scenes.split(","), arguments.repeats)

    rows = []
    for (part, scene, precision, threads), (wall, cpu) in sorted(medians.items(), key=lambda m: m[0][1:]):
        peer = medians.get(("openmm", scene, "single", threads))
        name = "taut" if part == "step" else "openmm-cpu"
        ratios = [round(peer[0] / wall, 2), round(peer[1] / cpu, 2)] if peer else ["", ""]
        rows.append([scene, name, precision, threads, round(wall, 1), round(cpu, 1), *ratios])
        print("{:<12}{:<12}{:<8}{} threads  wall {:>9} µs  cpu {:>9} µs  OpenMM/this: {} {}".format(*rows[-1]))
    pathlib.Path(arguments.out).parent.mkdir(exist_ok=True)
    with open(arguments.out, "w", newline="") as file:
        file.write(f"# {context['date']}; {cpu_name()}, {context['num_cpus']} cores, load {context['load_avg']}; "
                   f"OpenMM {openmm_version()}; medians of {arguments.repeats}\n")
        writer = csv.writer(file)
        writer.writerow(["scene", "engine", "precision", "threads", "wall_us_per_step", "cpu_us_per_step",
                         "openmm_over_this_wall", "openmm_over_this_cpu"])
        writer.writerows(rows)
    print(f"wrote {arguments.out}")


if __name__ == "__main__":
    main()
