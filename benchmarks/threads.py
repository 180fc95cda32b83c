#!/usr/bin/env python3
"""Predicts the speed-up of more threads from counts, and measures it if the machine has the cores.

    benchmarks/threads.py [--build build] [--scenes water1728 chain] [--precisions mixed] [--threads 2 8 16 64]
                          [--wake 2] [--predict] [--csv FILE]

step_bench measures each thread's processor time (`account/`): that of serial parts, and in each parallel region that of
the thread with most work. Other programs on the machine, and more threads than cores, do not change it. It does not
include the effect of shared caches and memory. The prediction for a step on T threads is

    serial + longest + regions x wake

The imbalance is `longest` less the work of all threads over T. `wake` is the time of an empty region [us]. It, and the
speed-up itself, are measured if there are T cores; otherwise `wake` is that of --wake. --predict uses no clock, for a
machine on which other programs run.
"""

import csv, json, os, pathlib, statistics, subprocess, sys

import machine

HERE = pathlib.Path(__file__).parent


def run(bench, names, policy, seconds):
    """{name without its suffixes: row}, medians of three."""
    pattern = "^(" + "|".join(names) + ")/process_time"
    rows = {}
    for _ in range(3):
        out = subprocess.run([bench, f"--benchmark_filter={pattern}", f"--benchmark_min_time={seconds}",
                              "--benchmark_format=json"], capture_output=True, text=True,
                             env={**os.environ, "OMP_WAIT_POLICY": policy})
        if out.returncode != 0:
            sys.exit(f"{bench}: {out.stderr.strip()}")
        for row in json.loads(out.stdout)["benchmarks"]:
            rows.setdefault(row["name"].split("/process_time")[0], []).append(row)
    keys = ("real_time", "regions", "serial", "longest", "busy")
    return {name: {k: statistics.median(r[k] for r in of) for k in keys if k in of[0]} for name, of in rows.items()}


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--scenes", nargs="+", default=["water1728", "water5832", "water46656",
                                                              "chain", "decane", "chain6000", "melt6000", "decane5120"])
    parser.add_argument("--precisions", nargs="+", default=["double", "mixed"])
    parser.add_argument("--threads", nargs="+", type=int, default=[2, 8, 16, 64])
    parser.add_argument("--wake", type=float, default=2, help="us, where it cannot be measured")
    parser.add_argument("--seconds", type=float, default=0.5, help="of each measurement")
    parser.add_argument("--predict", action="store_true")
    parser.add_argument("--csv", type=pathlib.Path)
    options = parser.parse_args()
    bench, cores = options.build / "step_bench", len(os.sched_getaffinity(0))
    out = []
    for scene in options.scenes:
        for precision in options.precisions:
            name = lambda part, threads: f"{part}/{scene}/{precision}/{threads}"
            one = run(bench, [name("account", 1)], "passive", options.seconds)[name("account", 1)]["serial"]
            for threads in options.threads:
                account = run(bench, [name("account", threads)], "passive", options.seconds)[name("account", threads)]
                wake, measured = options.wake, ""
                if threads <= cores and not options.predict:
                    wake = run(bench, [f"wake/none/double/{threads}"], "active", 0.1).popitem()[1]["real_time"]
                    clock = {t: run(bench, [name("account", t)], "active", options.seconds)[name("account", t)]["real_time"]
                             for t in (1, threads)}
                    measured = clock[1] / clock[threads]
                step = account["serial"] + account["longest"] + account["regions"] * wake
                row = {"scene": scene, "precision": precision, "threads": threads, "one_us": one,
                       "regions": account["regions"], "serial_us": account["serial"],
                       "imbalance_us": account["longest"] - account["busy"] / threads, "busy_us": account["busy"],
                       "wake_us": wake, "foretold": one / step, "measured": measured}
                out.append({k: f"{v:.4g}" if isinstance(v, float) else v for k, v in row.items()})
                print("  ".join(f"{k} {v}" for k, v in out[-1].items() if v != ""), flush=True)
    if options.csv:
        with options.csv.open("w", newline="") as file:
            file.write(f"# {machine.describe()}; us a step\n")
            writer = csv.DictWriter(file, out[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows(out)


if __name__ == "__main__":
    main()
