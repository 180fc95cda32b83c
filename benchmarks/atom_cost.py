#!/usr/bin/env python3
"""Measures the time of a step per atom from 648 to 331,776 atoms, and the ratio of the largest to the least.

    benchmarks/atom_cost.py [--build build] [--systems water pme] [--precisions double mixed] [--repeats 3]

Water with a reaction field and with PME (step_bench's step/water..., step/pme...), whole steps on one thread, the least
processor time of the repeats, which take turns. Other programs on the machine disturb it only by shared caches.
"""

import json, subprocess

import machine

MOLECULES = (216, 1728, 5832, 46656, 110592)


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--systems", nargs="+", default=["water", "pme"], choices=["water", "pme"])
    parser.add_argument("--precisions", nargs="+", default=["double", "mixed"], choices=["double", "mixed"])
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    pattern = f"^step/({'|'.join(options.systems)})[0-9]+/({'|'.join(options.precisions)})/1/"
    least = {}
    for _ in range(options.repeats):
        out = subprocess.run([options.build / "step_bench", f"--benchmark_filter={pattern}", "--benchmark_min_time=0.1",
                              "--benchmark_format=json"], check=True, capture_output=True, text=True).stdout
        for run in json.loads(out)["benchmarks"]:
            name, us = "/".join(run["name"].split("/")[1:3]), run["cpu_time"] / 20
            least[name] = min(us, least.get(name, us))
    print(f"# {machine.describe()}; ns an atom and step")
    print(f"{'':14}", *(f"{3 * m:>8}" for m in MOLECULES), "  most over least")
    for system in options.systems:
        for precision in options.precisions:
            ns = [1e3 * least[f"{system}{m}/{precision}"] / (3 * m) for m in MOLECULES]
            print(f"{system + ', ' + precision:14}", *(f"{n:8.0f}" for n in ns), f"{max(ns) / min(ns):17.2f}")


if __name__ == "__main__":
    main()
