#!/usr/bin/env python3
"""Measure what a step of each method takes, on an idle machine: data/times.csv.

    docs/study/times.py [--systems NAME,...] [--repeats 2] [--seconds 0.25]

Each method is timed at the system's usual step and at its largest sound one, in turns, on one thread: taut's own clock
over so many seconds, the least of the repeats [µs], and what constraints take of it.
"""
import json
import subprocess
import sys

from cases import DATA, SYSTEMS, read_rows
from judge import Judge, whole
from study import Study, open_rows, options

COLUMNS = ["system", "method", "dt_fs", "us", "constraint_us"]


def timed(study, name, method, step, steps):
    found = study.of_cell(name, method, step, SYSTEMS[name].precision)
    if found is None:
        return None
    words, keys = found
    done = subprocess.run([*words, "--steps", str(steps), "--set", *keys, f"run.log_every={steps}"],
                          capture_output=True, text=True)
    if done.returncode:
        return None
    seen = json.loads(done.stdout)
    return seen["us_per_step"], seen["constraint_us_per_step"]


def main():
    ask = options(__doc__)
    ask.add_argument("--repeats", type=int, default=2)
    ask.add_argument("--seconds", type=float, default=0.25)
    asked = ask.parse_args()
    study, judge = Study(asked.taut, asked.work), Judge(read_rows())
    names = [name for name in asked.systems.split(",") if name in judge.systems]
    todo = []
    for name in names:
        for method, steps in judge.table[name].items():
            wanted = {judge.sound_step(name, method)[0], float(SYSTEMS[name].dt_fs)}
            todo += [(name, method, step) for step in sorted(wanted & set(steps)) if whole(steps[step])]
    length = {}  # steps in so many seconds
    for name in names:
        timed(study, name, "newton", SYSTEMS[name].dt_fs, 20)  # the equilibrated start is there now
        length[name] = max(20, round(asked.seconds * 1e6 / timed(study, name, "newton", SYSTEMS[name].dt_fs, 50)[0]))
    best = {}
    for turn in range(asked.repeats):
        for n, (name, method, step) in enumerate(todo):
            print(f"\rturn {turn + 1}, {n} of {len(todo)}: {name}, {method}".ljust(80), end="", file=sys.stderr, flush=True)
            if seen := timed(study, name, method, step, length[name]):
                best[name, method, step] = min(seen, best.get((name, method, step), seen))
    kept = [row for row in read_rows("times.csv") if row["system"] not in names]
    (DATA / "times.csv").unlink(missing_ok=True)
    write = open_rows(DATA / "times.csv", COLUMNS)
    for row in kept:
        write(row)
    for (name, method, step), (us, constraint_us) in best.items():
        write(dict(zip(COLUMNS, (name, method, f"{step:g}", f"{us:.1f}", f"{constraint_us:.2f}"))))
    print(file=sys.stderr)


if __name__ == "__main__":
    main()
