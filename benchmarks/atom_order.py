#!/usr/bin/env python3
"""Measures what sorting atoms in memory would gain: µs a step with molecules sorted in space, shuffled, and as built.

    benchmarks/atom_order.py [--build build] [--systems water17496 chain6000 melt6000] [--threads 1 2] [--repeats 5]

Equal molecules swap places in the start: sorted by cells of 1 nm along x, as threads share them, or at random, as after
a long run. The orders take turns. A cache line takes 15 to 300 ns from core to core, since the host moves virtual cores.
This time is measured beside each run, and runs with less and more than 100 ns have separate medians.
"""

import collections, json, pathlib, random, re, statistics, subprocess, tempfile

import machine

SYSTEMS = {  # scene, settings, steps, atoms a molecule
    "water5184": ("water", ["build.molecules=1728", "method.name=settle"], 1500, 3),
    "water17496": ("water", ["build.molecules=5832", "method.name=settle"], 400, 3),
    "water139968": ("water", ["build.molecules=46656", "method.name=settle"], 50, 3),
    "chain6000": ("chain", ["build.chains=300", "method.name=newton"], 2000, 20),
    "melt6000": ("melt", ["build.chains=120", "method.name=newton"], 3000, 50),
}
ORDERS = ("built", "space", "shuffled")


def start_of(text):
    """Its head, and the rows of its atoms, each with where it is."""
    head, rows = text.split("atoms = [", 1)
    lines = [line for line in rows.splitlines() if line.strip().startswith("[")]
    edges = [float(e) for e in re.search(r"box_nm = \[([^\[\]]*)\]", head).group(1).split(",")]
    return head, lines, edges


def reordered(text, molecule, order):
    if order == "built":
        return text
    head, lines, edges = start_of(text)
    molecules = [lines[n:n + molecule] for n in range(0, len(lines), molecule)]
    if order == "shuffled":
        random.Random(1).shuffle(molecules)
    else:
        molecules.sort(key=lambda rows: cell_of(rows, edges))
    return head + "atoms = [\n" + "\n".join(line for rows in molecules for line in rows) + "\n]\n"


def cell_of(rows, edges):
    """Of the molecule's middle, in the box: numbers that grow on a way through all cells."""
    places = [[float(n) for n in row.strip(" [],").split(",")[:3]] for row in rows]
    i, j, k = (int(sum(p[d] for p in places) / len(places) % edges[d]) for d in range(3))
    j = -j if i % 2 else j
    return i, j, -k if (i + j) % 2 else k


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--systems", nargs="+", default=["water17496", "chain6000", "melt6000"], choices=SYSTEMS)
    parser.add_argument("--precisions", nargs="+", default=["mixed"], choices=["double", "mixed"])
    parser.add_argument("--threads", nargs="+", type=int, default=[1, 2])
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    taut, bench = options.build / "taut", options.build / "step_bench"

    def run(system, steps, *settings, threads=1):
        scene, own, *_ = SYSTEMS[system]
        with tempfile.TemporaryDirectory() as folder:
            out = pathlib.Path(folder) / "run"
            subprocess.run([taut, "--quiet", "--threads", str(threads), "run", scene, "--steps", str(steps), "--out", out,
                            "--set", "run.log_every=100000", *own, *settings], check=True)
            return json.loads((out / "summary.json").read_text())["us_per_step"], (out / "final.start.toml").read_text()

    def handover():
        out = subprocess.run([bench, "--benchmark_filter=handover", "--benchmark_min_time=0.01"], check=True,
                             capture_output=True, text=True).stdout
        return float(re.search(r"ns_per_atom_step=([\d.]+)n?", out).group(1))

    print(f"# {machine.describe()}; µs a step, medians; in brackets how many runs")
    print(f"{'':32}" + "".join(f"{order:>16}" for order in ORDERS))
    with tempfile.TemporaryDirectory() as folder:
        for system in options.systems:
            text = run(system, 20)[1]
            starts = {order: pathlib.Path(folder) / f"{system}.{order}.start.toml" for order in ORDERS}
            for order, path in starts.items():
                path.write_text(reordered(text, SYSTEMS[system][3], order))
            for precision in options.precisions:
                for threads in options.threads:
                    times = collections.defaultdict(list)
                    for _ in range(options.repeats):
                        for order, path in starts.items():
                            far = threads > 1 and handover() > 100
                            us, _ = run(system, SYSTEMS[system][2], f"build.start={path}",
                                        f"forcefield.precision={precision}", threads=threads)
                            times[far, order].append(us)
                    for far in sorted({far for far, _ in times}):
                        name = f"{system}, {precision}, {threads}" + ("" if threads == 1 else ", far" if far else ", near")
                        cells = [times[far, order] for order in ORDERS]
                        print(f"{name:32}" + "".join(
                            f"{f'{statistics.median(c):.0f} ({len(c)})' if c else '–':>16}" for c in cells), flush=True)


if __name__ == "__main__":
    main()
