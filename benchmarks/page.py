"""What benchmarks/page.sh runs: measures once, adds a row to results/history.csv, and writes the page of all rows."""
import csv
import math
import os
import pathlib
import statistics
import subprocess
import sys

import machine
from medians import measure

from taut.pictures import save, styled
from taut.pictures.page import Page
from taut.pictures.style import limit, look

HERE = pathlib.Path(__file__).resolve().parent
ROWS = HERE / "results/history.csv"
METHODS = ("newton", "feedforward", "baumgarte")
ABOUT = ("date", "machine", "busy", "commit")
# The panels of the page: the beginning of a figure's name, the panel's title, the axis' words, whether logarithmic.
PANELS = (("step", "A step, one thread", "ns of processor time an atom", True),
          ("bond", "Constraints, one thread", "ns a bond, or a water", True),
          ("drift", "Energy drift, water at 2 fs", "kJ/mol/ns/degree of freedom", False),
          ("error", "Bond error, rms, water at 2 fs", "relative", True),
          ("conformance", "Conformance", "passed of what cases ask [%]", False),
          ("size", "Sizes", "MB, or thousands of lines", True))


def speeds():
    build = HERE.parent / "build"
    for (_, scene, precision, _), (ns, processor, clock) in sorted(measure(
            build, "step_bench", 4, ["ns_per_atom_step", "cpu_time", "real_time"],
            ["--benchmark_filter=^step/(water1728/double|(water1728|pme1728|chain|decane|melt)/mixed)/1(/|$)"])):
        yield f"step {scene}, {precision}", ns * processor / clock  # what waits for a core does not count
    for (method, system, *_), (ns,) in sorted(measure(
            build, "constraints_bench", 4, ["ns_per_unit"],
            ["--benchmark_filter=^((newton|feedforward|rattle)/chains-100x20|(newton|feedforward|settle)/water-1000)/fast/1(/|$)"])):
        yield f"bond {method}, {system}", ns


def drifts():
    """Means over three seeds of 8 ps, with their standard errors, and bond errors."""
    text = subprocess.run([HERE / "drift.sh", "water", "8", "2", "1 2 3", "--set", "forcefield.switch_nm=0.75"], check=True,
                          capture_output=True, text=True).stdout
    rows = list(csv.DictReader(text.splitlines()))
    for method in METHODS:
        of = [row for row in rows if row["method"] == method]
        if any(row["drift"] == "failed" for row in of):
            continue  # a gap in the curve
        values = [float(row["drift"]) for row in of]
        yield f"drift {method}", statistics.mean(values)
        yield f"± {method}", statistics.stdev(values) / math.sqrt(len(values))
        yield f"error {method}", statistics.mean(float(row["rms_rel_bond_error"]) for row in of)


def conformance():
    """Counts what conformance/results has, as conformance/MATRIX.md does."""
    sys.path.insert(0, str(HERE.parent / "conformance"))
    from matrix import label, read_all

    for result in read_all():
        if result["about"]["runner"] == "taut_python" and result["about"]["variant"] in METHODS:
            verdicts = [one["verdict"] for one in result["verdicts"] if one["verdict"] != "not offered"]
            yield f"conformance {label(result).split(':')[1]}", 100 * verdicts.count("passed") / len(verdicts)


def sizes():
    build = HERE.parent / "build"
    yield "size command [MB]", (build / "taut").stat().st_size / 1e6
    if (build / "lab/index.html").exists():
        yield "size laboratory [MB]", sum(file.stat().st_size for file in (build / "lab").iterdir()) / 1e6
    files = subprocess.run(["git", "ls-files", "*.cpp", "*.hpp", "*.py", "*.js"], check=True, capture_output=True, text=True,
                           cwd=HERE.parent).stdout.split()
    lines = {file: (HERE.parent / file).read_bytes().count(b"\n") for file in files}
    tests = sum(n for file, n in lines.items() if "tests/" in file)
    yield "size code [1000 lines]", (sum(lines.values()) - tests) / 1000
    yield "size tests [1000 lines]", tests / 1000


def new_row():
    busy = os.getloadavg()[0] > 0.5
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], check=True, capture_output=True, text=True).stdout.strip()
    date, _, host = machine.describe().partition("; ")
    row = {"date": date, "machine": host.rpartition(", load")[0], "busy": "busy" if busy else "", "commit": commit}
    for measured in (speeds, drifts, conformance, sizes):
        row.update({name: f"{value:.4g}" for name, value in measured()})
        print(f"{measured.__name__} measured", file=sys.stderr)
    return row


def figures(rows, panel):
    return list(dict.fromkeys(name for row in rows for name in row if name.partition(" ")[0] == panel and row[name]))


def draw(rows):
    with styled():
        page = Page(len(PANELS), 170, columns=2, height_mm=48)
        for axis, (panel, title, words, log) in zip(page.axes, PANELS):
            ends, drawn = [], []
            for n, name in enumerate(figures(rows, panel)):
                curve = {**look("", n), "markersize": 2.5}
                runs = [k for k, row in enumerate(rows, 1) if row.get(name)]
                values = [float(rows[k - 1][name]) for k in runs]
                errors = [float(rows[k - 1].get(name.replace("drift", "±")) or 0) for k in runs] if panel == "drift" else None
                axis.errorbar(runs, values, errors, **curve)
                ends.append((runs[-1], values[-1], name.partition(" ")[2], curve["color"]))
                drawn += values
            limit(axis, "y", drawn, log)
            axis.set(title=title, ylabel=words, xlim=(0.5, len(rows) + 0.5))
            axis.set_xticks(range(1, len(rows) + 1), [row["date"][2:] + ("*" if row["busy"] else "") for row in rows], rotation=30, ha="right")
            page.name_ends(axis, ends)
        save(page.finish(), ROWS.with_suffix(""), "svg")


def write_page(rows):
    new, before = rows[-1], next((row for row in rows[-2::-1] if row["machine"] == rows[-1]["machine"]), {})
    lines = ["# Speeds, drifts, conformance and sizes", "",
             "Written by `benchmarks/page.sh` from `results/history.csv`, which has a row for each run. Compare times of one machine,",
             "and none of a busy one (*). Drifts are of 8 ps of 216 TIP3P waters, three seeds, for a look; the",
             "[study](../docs/study/README.md) has long runs, and [costs](README.md) times beside other programs.", "",
             "![all figures, run by run](results/history.svg)", "",
             f"{new['date']}, {new['machine']}{', busy' if new['busy'] else ''}; commit {new['commit']}.",
             f"Before: {before['date'] + ', commit ' + before['commit'] if before else 'no run on this machine'}."]
    for panel, title, words, _ in PANELS:
        lines += ["", f"| {title} | {words} | before |", "|---|---|---|"]
        for name in figures([new], panel):
            error = f" ± {float(new[name.replace('drift', '±')]):.2g}" if panel == "drift" else ""
            lines.append(f"| {name.partition(' ')[2]} | {new[name]}{error} | {before.get(name, '')} |")
    (HERE / "HISTORY.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main():
    rows = list(csv.DictReader(ROWS.open(encoding="utf-8"))) if ROWS.exists() else []
    if "--draw" not in sys.argv:
        rows.append(new_row())
        names = list(dict.fromkeys([*ABOUT, *(name for row in rows for name in row)]))
        with ROWS.open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, names, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    draw(rows)
    write_page(rows)
    print("benchmarks/HISTORY.md written")


if __name__ == "__main__":
    main()
