#!/usr/bin/env python3
"""Judge the study's runs: write the tables into README.md and draw the pictures.

    docs/study/judge.py            # tables and pictures
    docs/study/judge.py --check    # exit 1 if a table of README.md is not that of data/runs.csv

A step is sound if at it, and at every shorter one that was run, all of these hold for the mean over seeds:
- every seed reached the end;
- the rms relative bond error is below 1e-3;
- the drift of the total energy less the heat is below 0.1 kT a nanosecond and degree of freedom;
- the mean temperature is within 1 % of the bath's, the mean potential energy within 1 % of the reference's. The
  reference is `newton` at the shortest step.
A limit counts as kept where the mean misses it by less than two standard errors over seeds. The standard deviation of
one run is that of the cell's seeds, or the median over all cells of the system where that is larger. With one seed
alone only the first two are judged.
"""
import argparse
import csv
import math
import statistics
import subprocess
import sys
from collections import defaultdict

from study import DATA, HERE, METHODS, REFERENCE, SYSTEMS, read_rows

BOLTZMANN = 0.00831446261815324  # [kJ/mol/K]
PAGE = HERE / "README.md"
LARGEST_BOND_ERROR, LARGEST_DRIFT_KT, LARGEST_SHARE = 1e-3, 0.1, 0.01


def mean_and_error(values):
    """Mean and its standard error over seeds; the error of one value is not known and counts as 0."""
    mean = sum(values) / len(values)
    if len(values) < 2:
        return mean, 0.0
    return mean, math.sqrt(sum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values))


def cells(rows, precision="double"):
    """{system: {method: {step: [row, ...]}}}"""
    table = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for row in rows:
        if row["precision"] == precision:
            table[row["system"]][row["method"]][float(row["dt_fs"])].append(row)
    return table


def of(rows, column):
    return [float(row[column]) for row in rows if row.get(column)]


def usual_deviations(table):
    """{(system, column): the median over cells of the standard deviation over seeds}"""
    found = {}
    for system, methods in table.items():
        for column in ("drift", "temperature_k", "potential_kj_mol"):
            columns = [of(rows, column) for steps in methods.values() for rows in steps.values()]
            deviations = sorted(statistics.stdev(values) for values in columns if len(values) > 1)
            if deviations:
                found[system, column] = deviations[len(deviations) // 2]
    return found


def flaws(system, rows, reference, usual):
    """What is wrong with the runs of one cell, in words; empty if it is sound."""
    failed = [row for row in rows if row["status"] != "ok"]
    if failed:
        return "stops" if failed[0]["status"].startswith("failed") else failed[0]["status"].split(":")[0]
    bath = SYSTEMS[system].temperature_k

    def misses(column, target, limit):
        values = of(rows, column)
        if len(values) < 2:
            return False
        error = max(statistics.stdev(values), usual[system, column]) / math.sqrt(len(values))
        return abs(statistics.mean(values) - target) > limit + 2 * error

    if statistics.mean(of(rows, "rms_bond")) > LARGEST_BOND_ERROR:
        return "bonds"
    if misses("drift", 0, LARGEST_DRIFT_KT * BOLTZMANN * bath):
        return "drift"
    if misses("temperature_k", bath, LARGEST_SHARE * bath):
        return "temperature"
    if reference and any(of(reference, "potential_kj_mol")):
        target = statistics.mean(of(reference, "potential_kj_mol"))
        own = 2 * usual.get((system, "potential_kj_mol"), 0) / math.sqrt(len(reference))
        if misses("potential_kj_mol", target, LARGEST_SHARE * abs(target) + own):
            return "potential"
    return ""


def soundness(system, steps, reference, usual):
    """The largest sound step [fs], 0 if there is none, and what is wrong at the next one."""
    sound = 0.0
    for step in sorted(steps):
        wrong = flaws(system, steps[step], reference, usual)
        if wrong:
            return sound, wrong
        sound = step
    return sound, ""


def reference_of(system, table):
    method, factor = REFERENCE
    return table[system][method].get(factor * SYSTEMS[system].dt_fs, [])


def seeds_of(table, system):
    return max((len(rows) for steps in table[system].values() for rows in steps.values()), default=0)


def steps_table(rows):
    table = cells(rows)
    usual = usual_deviations(table)
    systems = [name for name in SYSTEMS if name in table]
    lines = ["| largest sound step [fs]; what fails next | " + " | ".join(systems) + " |",
             "|---" * (len(systems) + 1) + "|"]
    for method in METHODS:
        line = []
        for system in systems:
            steps = table[system].get(method)
            if not steps:
                line.append("")
                continue
            sound, wrong = soundness(system, steps, reference_of(system, table), usual)
            line.append((f"**{sound:g}**" if sound else "–") + (f" {wrong}" if wrong else ""))
        lines.append(f"| {method} | " + " | ".join(line) + " |")
    lines.append("| seeds | " + " | ".join(str(seeds_of(table, system)) for system in systems) + " |")
    return lines


def usual_table(rows):
    """Bond error, drift and its share by the constraints at the usual step."""
    table = cells(rows)
    systems = [name for name in SYSTEMS if name in table]
    lines = ["| rms bond error; drift [kT/ns/dof], of which constraints | " + " | ".join(
        f"{system}, {SYSTEMS[system].dt_fs:g} fs" for system in systems) + " |", "|---" * (len(systems) + 1) + "|"]
    for method in METHODS:
        line = []
        for system in systems:
            runs = table[system].get(method, {}).get(float(SYSTEMS[system].dt_fs), [])
            if not runs or any(row["status"] != "ok" for row in runs):
                line.append("stops" if runs else "")
                continue
            kt = BOLTZMANN * SYSTEMS[system].temperature_k
            (drift, error), (work, _) = (mean_and_error([v / kt for v in of(runs, column)])
                                         for column in ("drift", "constraint_drift"))
            spread = f" ± {error:.1g}" if error else ""
            line.append(f"{mean_and_error(of(runs, 'rms_bond'))[0]:.0e}; {drift:.2g}{spread}, {work:.2g}")
        lines.append(f"| {method} | " + " | ".join(line) + " |")
    return lines


def read_times():
    path = DATA / "times.csv"
    if not path.exists():
        return {}
    with open(path, newline="") as file:
        return {(row["system"], row["method"]): float(row["us"]) for row in csv.DictReader(file)}


def cost_table(rows):
    """Processor time a nanosecond at the largest sound step, least first."""
    table, times = cells(rows), read_times()
    usual = usual_deviations(table)
    systems = [name for name in SYSTEMS if name in table and any(key[0] == name for key in times)]
    if not systems:
        return ["Not measured yet."]
    lines = ["| system | cheapest sound methods: processor seconds a nanosecond, at its step [fs] |", "|---|---|"]
    for system in systems:
        costs = []
        for method, steps in table[system].items():
            sound, _ = soundness(system, steps, reference_of(system, table), usual)
            if sound and (system, method) in times:
                costs.append((times[system, method] / sound, method, sound))
        costs.sort()
        cheapest = " · ".join(f"{method} {cost:.3g} at {step:g}" for cost, method, step in costs[:6])
        lines.append(f"| {system} | {cheapest} |")
    return lines


TABLES = {"steps": steps_table, "usual": usual_table, "cost": cost_table}


def with_tables(page, rows):
    for name, make in TABLES.items():
        begin, end = f"<!-- table {name} -->\n", "<!-- end -->"
        before, _, rest = page.partition(begin)
        if not rest:
            sys.exit(f"judge.py: README.md has no place for table {name}")
        after = rest.split(end, 1)[1]
        page = before + begin + "\n" + "\n".join(make(rows)) + "\n\n" + end + after
    return page


def draw(rows):
    """A picture a system: the drift against the step, a line a method."""
    table = cells(rows)
    (HERE / "pictures").mkdir(exist_ok=True)
    shown = ["penalty", "baumgarte", "baumgarte dead-beat", "baumgarte implicit", "baumgarte lagged", "feedforward",
             "shake 1e-4", "newton", "lincs", "lincs strict"]
    for system in table:
        kt = BOLTZMANN * SYSTEMS[system].temperature_k
        blocks, plots = "", []
        for n, method in enumerate(shown):
            points = [(step, *mean_and_error([abs(v) / kt for v in of(runs, "drift")]))
                      for step, runs in sorted(table[system].get(method, {}).items())
                      if all(row["status"] == "ok" for row in runs)]
            if not points:
                continue
            blocks += f"$d{n} << EOD\n" + "".join(f"{x} {y} {e}\n" for x, y, e in points) + "EOD\n"
            plots.append(f"$d{n} using 1:2 with linespoints lw 1.5 pt {n + 4} ps 0.6 lc {n + 1} title '{method}'")
        script = (f"set terminal svg size 640,460 font 'sans,11' background 'white'\nset output '{system}.svg'\n"
                  f"{blocks}"
                  f"set title '{SYSTEMS[system].title}'\nset xlabel 'step [fs]'\nset logscale xy\n"
                  "set ylabel 'energy drift, absolute [kT/ns/degree of freedom]'\nset format y '10^{{%T}}'\n"
                  "set key outside right\nset grid\n"
                  f"set arrow from graph 0, first {LARGEST_DRIFT_KT} to graph 1, first {LARGEST_DRIFT_KT} nohead dt 2\n"
                  "plot " + ", \\\n ".join(plots) + "\n").replace("{{", "{").replace("}}", "}")
        subprocess.run(["gnuplot"], input=script, text=True, check=True, cwd=HERE / "pictures")


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--check", action="store_true")
    check = ask.parse_args().check
    rows, page = read_rows(), PAGE.read_text()
    made = with_tables(page, rows)
    if check:
        sys.exit(0 if made == page else "judge.py: a table of README.md is not that of data/runs.csv; run judge.py")
    PAGE.write_text(made)
    draw(rows)


if __name__ == "__main__":
    main()
