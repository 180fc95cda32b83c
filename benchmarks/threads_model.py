#!/usr/bin/env python3
"""Foretells what a step takes on 16 threads, and holds the model against a measurement on 8 and 16.

    benchmarks/threads_model.py

A part of W ms on one thread takes t = W (1/e + (S - 1)/n) + R b + C c on n threads:
    e   how many times faster n busy threads of that machine are than one: of the pairs, which are shared out evenly
    S   the work of the thread that has most, over the mean; it ends alone, at the speed of one thread
    R   parallel regions a step, and b to open and close one
    C   threads that g++'s OpenMP starts anew a step, and c to start one
W is `--timings` on one thread, S the processor time of each thread in each region, R and C are calls of GOMP_parallel
and pthread_create; two cores give them for any number of threads. b and c are fitted to the measurement.
"""
START = 0.055  # c [ms]
b = lambda n: 0.001 + 0.00025 * n  # [ms]

# part: W, R; measured and S on 8 threads; measured, S and C on 16; S and R of this taut on 16. Measured of a taut before
# it: 16 virtual cores of an Intel processor with AVX-512, mixed, one run; DHFR with a mesh of 52 x 52 x 52 and order 4.
SYSTEMS = {
    "DHFR, 23,558 atoms": {
        "pairs": (4.64, 1, (1.00, 1.04), (0.70, 1.04, 0), (1.04, 1)),
        "lists": (1.15, 0.5, (0.30, 1.1), (0.20, 1.1, 0), (1.1, 0.5)),
        "cluster copies": (0.26, 2, (0.11, 1.1), (0.13, 1.1, 0), (1.1, 2)),
        "mesh spread": (0.89, 3, (0.23, 1.2), (0.18, 1.2, 0), (1.2, 3)),
        "mesh solve": (1.40, 2, (0.25, 1.25), (0.16, 1.25, 0), (1.25, 2)),
        "mesh gather": (0.55, 1, (0.13, 1.1), (0.11, 1.1, 0), (1.1, 1)),
        "exclusions": (0.25, 1, (0.13, 2.7), (0.13, 5.1, 0), (1.3, 2)),
        "bonded": (0.21, 1, (0.20, 8), (0.23, 16, 0), (1.5, 2)),
        "bonds": (0.16, 1, (0.04, 2.8), (0.05, 4.4, 0), (1.4, 1)),
        "kicks, drift": (0.09, 2, (0.04, 1.1), (0.05, 1.1, 0), (1.1, 2)),
    },
    "1728 waters": {
        "pairs": (1.00, 1, (0.26, 1.1), (0.17, 1.3, 0), (1.3, 1)),
        "lists": (0.16, 0.5, (0.06, 1.1), (0.04, 1.3, 0), (1.3, 0.5)),
        "cluster copies": (0.05, 2, (0.04, 1.3), (0.13, 1.3, 3), (1.3, 2)),
        "mesh spread": (0.24, 3, (0.08, 1.2), (0.30, 1.2, 3), (1.2, 3)),
        "mesh solve": (0.11, 2, (0.05, 1.3), (0.12, 1.5, 0), (1.5, 2)),
        "mesh gather": (0.17, 1, (0.06, 1.1), (0.07, 1.1, 0), (1.1, 1)),
        "exclusions": (0.04, 1, (0.02, 1.3), (0.03, 1.6, 0), (1.6, 1)),
        "bonds": (0.03, 1, (0.01, 1.3), (0.01, 1.6, 0), (1.6, 1)),
        "kicks, drift": (0.02, 2, (0.02, 1.3), (0.02, 1.6, 0), (1.6, 2)),
    },
}

for system, parts in SYSTEMS.items():
    work, _, (on_8, share_8), (on_16, share_16, _), _ = parts["pairs"]
    per_work = {n: (t - b(n)) / work - (share - 1) / n for n, t, share in ((8, on_8, share_8), (16, on_16, share_16))}
    foretell = lambda n, work, share, regions, started=0: (
        work * (per_work[n] + (share - 1) / n) + regions * b(n) + started * START)
    sums = [0.0] * 6
    print(f"{system}, ms a step\n{'':16}{'1 thread':>10}{'on 8':>8}{'model':>8}{'on 16':>8}{'model':>8}{'forecast':>10}")
    for part, (work, regions, (on_8, share_8), (on_16, share_16, started), now) in parts.items():
        row = (work, on_8, foretell(8, work, share_8, regions), on_16,
               foretell(16, work, share_16, regions, started), foretell(16, work, *now))
        sums = [sum(pair) for pair in zip(sums, row)]
        print(f"{part:16}{row[0]:10.2f}{row[1]:8.2f}{row[2]:8.2f}{row[3]:8.2f}{row[4]:8.2f}{row[5]:10.2f}")
    print(f"{'all':16}{sums[0]:10.2f}{sums[1]:8.2f}{sums[2]:8.2f}{sums[3]:8.2f}{sums[4]:8.2f}{sums[5]:10.2f}\n")
