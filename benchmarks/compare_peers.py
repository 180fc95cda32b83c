#!/usr/bin/env python3
"""What peers pay for rigid bonds on this machine, beside benchmarks/results/constraints.csv.

    benchmarks/compare_peers.py [steps]

GROMACS (`gmx`, Debian: gromacs): its own cycle accounting, the row "Constraints" of one `mdrun` on one thread,
leap-frog (constraints applied once a step, to positions; ours are applied to positions and velocities), mixed
precision, the same molecules as ours without forces between them: LINCS as it comes (order 4, 1 iteration) on 100
chains of 20, SETTLE on 1000 waters. What is not installed is skipped.
"""

import csv, math, pathlib, random, re, shutil, subprocess, sys, tempfile

HERE = pathlib.Path(__file__).parent
MDP = """integrator = md
dt = 0.001
nsteps = {steps}
cutoff-scheme = Verlet
coulombtype = cut-off
rcoulomb = 0.9
rvdw = 0.9
nstenergy = 10000
nstlog = 10000
gen-vel = yes
gen-temp = 300
gen-seed = 1
constraint-algorithm = lincs
"""
TOP = """[ defaults ]
1 1 no 1 1
[ atomtypes ]
B 14.0 0 A 0 0
O 15.99943 0 A 0 0
H 1.007947 0 A 0 0
[ moleculetype ]
M {exclusions}
[ atoms ]
{atoms}
{bonds}
[ system ]
bench
[ molecules ]
M {count}
"""


def chains(count, bonds):
    rng, places = random.Random(1), []
    for c in range(count):
        x = [2.0 * (c % 5), 2.0 * (c // 5 % 5), 2.0 * (c // 25)]
        home = x[:]
        for b in range(bonds + 1):
            places.append(x)
            while True:
                z, phi = rng.uniform(-1, 1), rng.uniform(0, 2 * math.pi)
                s = math.sqrt(1 - z * z)
                step = [0.15 * s * math.cos(phi), 0.15 * s * math.sin(phi), 0.15 * z]
                y = [p + q for p, q in zip(x, step)]
                if math.dist(y, home) < 0.9:
                    break
            x = y
    atoms = "\n".join(f"{i + 1} B 1 CHN B{i + 1} {i + 1} 0 14.0" for i in range(bonds + 1))
    pairs = "[ constraints ]\n" + "\n".join(f"{i + 1} {i + 2} 1 0.15" for i in range(bonds))
    return places, TOP.format(exclusions=bonds, atoms=atoms, bonds=pairs, count=count), bonds + 1


def waters(count):
    oh, half = 0.09572, 0.5 * math.radians(104.52)
    side, places = math.ceil(count ** (1 / 3)), []
    for w in range(count):
        o = [0.31 * (w % side), 0.31 * (w // side % side), 0.31 * (w // side // side)]
        places += [o] + [[o[0] + oh * math.cos(half), o[1] + s * oh * math.sin(half), o[2]] for s in (1, -1)]
    atoms = "1 O 1 SOL OW 1 0 15.99943\n2 H 1 SOL HW1 1 0 1.007947\n3 H 1 SOL HW2 1 0 1.007947"
    settle = f"[ settles ]\n1 1 {oh} {2 * oh * math.sin(half):.6f}\n[ exclusions ]\n1 2 3\n2 1 3\n3 1 2"
    return places, TOP.format(exclusions=2, atoms=atoms, bonds=settle, count=count), 3


def gromacs(molecules, units, steps):
    """ns a unit and step of the row "Constraints"."""
    places, top, per_molecule = molecules
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        side = 12.0
        lines = [f"{n // per_molecule % 99999 + 1:5d}MOL  {'X':>5}{n % 99999 + 1:5d}" + "".join(f"{c + 0.5:8.3f}" for c in x)
                 for n, x in enumerate(places)]
        (folder / "in.gro").write_text("bench\n%d\n%s\n%g %g %g\n" % (len(places), "\n".join(lines), side, side, side))
        (folder / "in.top").write_text(top)
        (folder / "in.mdp").write_text(MDP.format(steps=steps))
        run = lambda *a: subprocess.run(["gmx", "-nobackup", *a], cwd=folder, check=True, capture_output=True)
        run("grompp", "-f", "in.mdp", "-c", "in.gro", "-p", "in.top", "-o", "in.tpr", "-maxwarn", "9")
        run("mdrun", "-s", "in.tpr", "-nt", "1", "-g", "md.log", "-noconfout", "-pin", "off")
        log = (folder / "md.log").read_text()
    row = re.search(r"^ Constraints\s+\d+\s+\d+\s+(\d+)\s+([\d.]+)", log, re.M)
    simd = re.search(r"SIMD instructions:\s*(\S+)", log).group(1)
    return float(row.group(2)) / int(row.group(1)) / units * 1e9, simd


def ours(system, method):
    lines = [line for line in (HERE / "results/constraints.csv").open() if not line.startswith("#")]
    for row in csv.DictReader(lines):
        if (row["system"], row["method"], row["form"], row["threads"]) == (system, method, "fast", "1"):
            return float(row["ns_per_unit"])
    return math.nan


def main():
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 20000
    rows = []
    if shutil.which("gmx"):
        for name, molecules, system, units, algorithm in (
            ("a bond, 100 chains of 20", chains(100, 20), "chains-100x20", 2000, "LINCS"),
            ("a water, 1000 waters", waters(1000), "water-1000", 1000, "SETTLE"),
        ):
            times = sorted(gromacs(molecules, units, steps) for _ in range(5))
            rows.append((name, system, f"GROMACS {algorithm} ({times[2][1]})", times[2][0]))
    else:
        print("gmx is not installed: GROMACS skipped", file=sys.stderr)
    for name, system, peer, ns in rows:
        print(f"{name}: {peer} {ns:.1f} ns")
        for method in ("baumgarte", "feedforward", "newton", "settle"):
            mine = ours(system, method)
            if mine == mine:
                print(f"    {method:12} {mine:6.1f} ns   {ns / mine:5.1f} times faster")


if __name__ == "__main__":
    main()
