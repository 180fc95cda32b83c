#!/usr/bin/env python3
"""Judge the study's runs: write the tables into README.md and draw the pictures.

    docs/study/judge.py            # tables and pictures
    docs/study/judge.py --check    # exit 1 if a table of README.md is not that of the data

A step is sound if at it, and at every shorter one that was run, all of these hold for the mean over seeds:
- every seed reached the end;
- the rms relative bond error is below 1e-3;
- the drift of the total energy less the heat is below 0.1 kT a nanosecond and degree of freedom;
- the mean temperature is within 1 % of the bath's;
- beside `newton` at the same step, the temperatures of translation, rotation and the rest are within 1 % of the bath's,
  the mean potential energy within 1 %.
A limit counts as kept where the mean misses it by less than three standard errors over seeds. The standard deviation of
one run is that of the cell's seeds, or the median over all cells of the system where that is larger. Where no cell of
a system has two seeds only the first two are judged.
"""
import argparse
import math
import statistics
import sys
from collections import Counter, defaultdict

from cases import HERE, METHODS, SYSTEMS, key_of, read_rows

BOLTZMANN = 0.00831446261815324  # [kJ/mol/K]
PAGE = HERE / "README.md"
LARGEST_BOND_ERROR, LARGEST_DRIFT_KT, LARGEST_SHARE = 1e-3, 0.1, 0.01
ERRORS = 3  # by which a mean may miss a limit
KINDS = ("translation_k", "rotation_k", "rest_k")
JUDGED = ("drift", "temperature_k", "potential_kj_mol", *KINDS)
GROUPS = (("chains", "melt", "decane", "tip3p", "tip4p2005"), ("dipeptide", "dipeptide-all", "dna", "dna-water"),
          ("villin", "villin-all", "villin-angles", "villin-3u", "villin-angles-3u"))
UNLISTED = ("none", "baumgarte as 4 sweeps", "baumgarte box2d")  # it stops, or is as baumgarte: not in tables
OF_EACH_KIND = ("chains", "decane", "tip3p", "dna", "villin")


def mean_and_error(values):
    """Mean and its standard error over seeds; the error of one value is not known and counts as 0."""
    mean = sum(values) / len(values)
    if len(values) < 2:
        return mean, 0.0
    return mean, math.sqrt(sum((v - mean) ** 2 for v in values) / (len(values) - 1) / len(values))


def cells(rows):
    """{system: {method: {step: [row, ...]}}}, of the system's own precision"""
    table = defaultdict(lambda: defaultdict(lambda: defaultdict(list)))
    for row in rows:
        if row["precision"] == SYSTEMS[row["system"]].precision:
            table[row["system"]][row["method"]][float(row["dt_fs"])].append(row)
    return table


def of(rows, column):
    return [float(row[column]) for row in rows if row.get(column)]


def kt(system):
    return BOLTZMANN * SYSTEMS[system].temperature_k


def whole(rows):
    return rows and all(row["status"] == "ok" for row in rows)


class Judge:
    """What is sound, of the rows of data/runs.csv."""

    def __init__(self, rows):
        self.table = cells(rows)
        self.systems = [name for name in SYSTEMS if name in self.table]
        self.usual = {}  # (system, column): the median over cells of the standard deviation over seeds
        for system, methods in self.table.items():
            for column in JUDGED:
                columns = [of(rows, column) for steps in methods.values() for rows in steps.values()]
                deviations = [statistics.stdev(values) for values in columns if len(values) > 1]
                if deviations:
                    self.usual[system, column] = statistics.median(deviations)

    def error(self, system, column, values):
        """The standard error of a mean; None where no cell of the system has two seeds."""
        usual = self.usual.get((system, column))
        own = statistics.stdev(values) if len(values) > 1 else 0
        return usual and max(own, usual) / math.sqrt(len(values))

    def misses(self, system, column, rows, target, limit):
        """Whether the mean is further from the target than the limit and its errors; target: a number or rows."""
        values = of(rows, column)
        others = of(target, column) if isinstance(target, list) else None
        error = self.error(system, column, values) if values and others != [] else None
        if error is None:
            return False
        if others is not None:
            target, error = statistics.mean(others), math.hypot(error, self.error(system, column, others))
        return abs(statistics.mean(values) - target) > limit + ERRORS * error

    def flaws(self, system, method, step):
        """What is wrong with the runs of one cell, in a word; empty if it is sound."""
        rows, bath = self.table[system][method][step], SYSTEMS[system].temperature_k
        if not whole(rows):
            status = next(row["status"] for row in rows if row["status"] != "ok")
            return "stops" if status.startswith("failed") else status.split(":")[0]
        if statistics.mean(of(rows, "rms_bond")) > LARGEST_BOND_ERROR:
            return "bonds"
        if self.misses(system, "drift", rows, 0, LARGEST_DRIFT_KT * kt(system)):
            return "drift"
        if not SYSTEMS[system].at_rest:
            return ""
        if self.misses(system, "temperature_k", rows, bath, LARGEST_SHARE * bath):
            return "temperature"
        newton = self.table[system].get("newton", {}).get(step, [])
        if whole(newton):
            if any(self.misses(system, kind, rows, newton, LARGEST_SHARE * bath) for kind in KINDS):
                return "kinds"
            energies = of(newton, "potential_kj_mol")
            limit = LARGEST_SHARE * abs(statistics.mean(energies)) if any(energies) else math.inf
            if self.misses(system, "potential_kj_mol", rows, newton, limit):
                return "potential"
        return ""

    def largest(self, system, method, wrong):
        """The largest step up to which nothing is wrong, 0 if there is none, and what is at the next one."""
        sound = 0.0
        for step in sorted(self.table[system].get(method, {})):
            if found := wrong(system, method, step):
                return sound, found
            sound = step
        return sound, ""

    def sound_step(self, system, method):
        return self.largest(system, method, self.flaws)


def rows_of(title, heads, lines):
    heads = list(heads)
    return [f"| {title} | " + " | ".join(heads) + " |", "|---" * (len(heads) + 1) + "|",
            *(f"| {name} | " + " | ".join(line) + " |" for name, line in lines), ""]


def grouped(title, judge, cell, groups, head=lambda name: name):
    """A table for each group of systems, a row a method; cell(system, method) gives a text, head(system) a title."""
    lines = []
    for group in groups:
        systems = [name for name in group if name in judge.systems]
        if systems:
            made = [(method, [cell(name, method) for name in systems]) for method in METHODS if method not in UNLISTED]
            lines += rows_of(title, map(head, systems), [(method, line) for method, line in made if any(line)])
    return lines[:-1]


def read_times():
    """{(system, method): [(step, time of a step, constraints' part of it), ...]} [µs], steps ascending"""
    times = defaultdict(list)
    for row in read_rows("times.csv"):
        times[row["system"], row["method"]].append(tuple(float(row[column]) for column in ("dt_fs", "us", "constraint_us")))
    return {key: sorted(values) for key, values in times.items()}


def cost_at(times, system, method, step):
    """Processor seconds a nanosecond, or None: times change linearly between steps timed."""
    timed = times.get((system, method))
    if not timed or not step:
        return None
    (s0, t0, _), (s1, t1, _) = timed[0], timed[-1]
    return (t0 + (t1 - t0) * (step - s0) / (s1 - s0) if s1 > s0 else t0) / step


def steps_table(judge):
    times = read_times()

    def cell(system, method):
        if method not in judge.table[system]:
            return ""
        sound, wrong = judge.sound_step(system, method)
        timed = [step for step, *_ in times.get((system, method), [])]
        cost = timed and timed[0] <= sound <= timed[-1] and cost_at(times, system, method, sound)
        return (f"**{sound:g}**" if sound else "–") + (f" {wrong}" if wrong else "") + (f"; {cost:.3g} s" if cost else "")
    return grouped("[fs]; [s/ns]", judge, cell, GROUPS)


def usual_table(judge):
    """Bond error and drift at the usual step, of a system of each kind."""
    def cell(system, method):
        runs = judge.table[system].get(method, {}).get(float(SYSTEMS[system].dt_fs), [])
        if not whole(runs):
            return "stops" if runs else ""
        drift, error = mean_and_error([v / kt(system) for v in of(runs, "drift")])
        spread = f" ± {error:.1g}" if error else ""
        return f"{mean_and_error(of(runs, 'rms_bond'))[0]:.0e}; {drift:.2g}{spread}"
    return grouped("rms bond error; drift [kT/ns/dof]", judge, cell, [OF_EACH_KIND],
                   lambda name: f"{name}, {SYSTEMS[name].dt_fs:g} fs")


def means_table(rows, quantities):
    """Means over seeds, a line for each method and step; quantities: {title: (column, factor)}.

    The standard deviation of one run is that of the seeds, or the root mean square over all lines where that is larger.
    """
    runs = defaultdict(list)
    for row in rows:
        runs[row["method"], float(row["dt_fs"])].append(row)

    def usual_deviation(column):
        deviations = [statistics.stdev(values) for rows in runs.values() if len(values := of(rows, column)) > 1]
        return math.sqrt(statistics.mean(d * d for d in deviations)) if deviations else 0
    usual = {column: usual_deviation(column) for column, _ in quantities.values()}

    def cell(rows, column, factor):
        values = of(rows, column)
        if not values:
            return "stops" if any(row.get(column) == "" and row["status"].startswith("failed") for row in rows) else ""
        own = statistics.stdev(values) if len(values) > 1 else 0
        mean, error = factor * statistics.mean(values), factor * max(own, usual[column]) / math.sqrt(len(values))
        digits = max(0, -math.floor(math.log10(error / 2))) if error else 2
        return f"{mean:.{digits}f}" + (f" ± {error:.{digits}f}" if error else "")
    return rows_of("method, step [fs], seeds", quantities, [
        (f"{method}, {step:g}, {len({row['seed'] for row in rows})}",
         [cell(rows, *quantity) for quantity in quantities.values()])
        for (method, step), rows in sorted(runs.items(), key=lambda item: (item[0][1], item[0][0]))])[:-1]


def transport_table():
    """Water's diffusion, viscosity and reorientation."""
    return means_table(read_rows("transport.csv"), {
        "D [10⁻³ nm²/ps]": ("diffusion_nm2_ps", 1e3), "viscosity [mPa s]": ("viscosity_mpa_s", 1),
        "τ₂ of OH [ps]": ("tau2_ps", 1), "T of translation [K]": ("translation_k", 1),
        "of rotation [K]": ("rotation_k", 1)})


def outsiders_table():
    """Drifts at constant energy of other programs beside taut's own."""
    runs, steps = defaultdict(list), {}
    for row in read_rows("outsiders.csv"):
        runs[row["system"], row["program"], float(row["dt_fs"])].append(row)
        steps.setdefault((row["system"], float(row["dt_fs"])))
    columns = sorted(steps)
    lines = []
    for program in dict.fromkeys(program for _, program, _ in runs):
        line = []
        for system, step in columns:
            rows = runs.get((system, program, step), [])
            values = [v / kt(system) for v in of(rows, "drift")]
            mean, spread = mean_and_error(values) if values else (0, 0)
            own = [v / kt(system) for v in of(rows, "error")]
            error = max(spread, math.sqrt(sum(e * e for e in own)) / len(own)) if own else 0
            line.append(f"{mean:.2g} ± {error:.1g}" if values else "stops" if rows else "")
        lines.append((program, line))
    return rows_of("drift [kT/ns/dof]", [f"{system}, {step:g} fs" for system, step in columns], lines)[:-1]


def tables(rows):
    judge = Judge(rows)
    return {"steps": steps_table(judge), "usual": usual_table(judge), "transport": transport_table(),
            "outsiders": outsiders_table()}


def with_tables(page, rows):
    for name, lines in tables(rows).items():
        begin, end = f"<!-- table {name} -->\n", "<!-- end -->"
        before, _, rest = page.partition(begin)
        if not rest:
            sys.exit(f"judge.py: README.md has no place for table {name}")
        page = before + begin + "\n" + "\n".join(lines) + "\n\n" + end + rest.split(end, 1)[1]
    return page


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("--check", action="store_true")
    check = ask.parse_args().check
    rows, page = read_rows(), PAGE.read_text()
    if twice := [key for key, count in Counter(map(key_of, rows)).items() if count > 1]:
        sys.exit(f"judge.py: data/runs.csv has two rows of {twice[0]}")
    made = with_tables(page, rows)
    if check:
        sys.exit(0 if made == page else "judge.py: a table of README.md is not that of data/; run judge.py")
    PAGE.write_text(made)
    import pictures
    pictures.draw(Judge(rows), read_times())


if __name__ == "__main__":
    main()
