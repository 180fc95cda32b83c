#!/usr/bin/env python3
"""Measures the constraint time of taut, GROMACS, OpenMM and LAMMPS on the same molecules, in the same run.

    benchmarks/compare_peers.py [--steps 20000] [--build build] [--repeats 5]

There are no forces between molecules, and one thread. The programs take turns in every repeat, and medians count. A
program that is not installed is skipped. Writes benchmarks/results/peers.csv.
- taut: `constraints_bench`, positions and velocities, double precision.
- GROMACS (`gmx`, Debian: gromacs; the variable GMX names another, such as one built for this machine's SIMD, which is
  the fair rival; the table says what it was built for): its own cycle accounting, the row "Constraints" of one `mdrun`, leap-frog
  (constraints applied once a step, to positions; ours are applied to positions and velocities), mixed precision: LINCS
  as it comes (order 4, 1 iteration) on 100 chains of 20, SETTLE on 1000 waters.
- OpenMM (`openmm_bonds` of the build): whole steps with bonds less whole steps without, positions and velocities, CPU
  and Reference platform: CCMA on the chains, SETTLE on the waters, in double precision, tolerance 1e-5 (its default).
- LAMMPS (`lmp`, Debian: lammps): fix rattle at 1e-6 on the waters, positions and velocities: the row "Modify" of its own
  timing, less that of the same run without the fix. It holds clusters of at most four atoms: no chains.
"""

import csv, json, math, os, pathlib, random, re, shutil, statistics, subprocess, sys, tempfile

import machine
import peer_gromacs

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


def gromacs(program, molecules, units, steps):
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
        run = lambda *a: subprocess.run([program, "-nobackup", *a], cwd=folder, check=True, capture_output=True)
        run("grompp", "-f", "in.mdp", "-c", "in.gro", "-p", "in.top", "-o", "in.tpr", "-maxwarn", "9")
        run("mdrun", "-s", "in.tpr", "-nt", "1", "-g", "md.log", "-noconfout", "-pin", "off")
        log = (folder / "md.log").read_text()
    row = re.search(r"^ Constraints\s+\d+\s+\d+\s+(\d+)\s+([\d.]+)", log, re.M)
    return float(row.group(2)) / int(row.group(1)) / units * 1e9


LAMMPS = """units real
atom_style molecular
boundary p p p
pair_style zero 4.0
bond_style harmonic
angle_style harmonic
read_data in.data
pair_coeff * *
neigh_modify every 20 delay 0 check yes
velocity all create 300 1 loop geom
timestep 1.0
fix move all nve
{rattle}
thermo 1000000
run {steps}
"""


def lammps_data(places):
    """TIP3P's shape, 1000 waters, in Å; bonds and angles only name what fix rattle holds."""
    side, waters = 120.0, len(places) // 3
    lines = ["bench", "", f"{3 * waters} atoms", f"{2 * waters} bonds", f"{waters} angles", "", "2 atom types",
             "1 bond types", "1 angle types", ""]
    lines += [f"0 {side} {c}lo {c}hi" for c in "xyz"]
    lines += ["", "Masses", "", "1 15.99943", "2 1.007947", "", "Bond Coeffs", "", "1 450 0.9572", "", "Angle Coeffs", "",
              "1 55 104.52", "", "Atoms", ""]
    lines += [f"{n + 1} {n // 3 + 1} {1 if n % 3 == 0 else 2} " + " ".join(f"{10 * c + 5:.6f}" for c in x)
              for n, x in enumerate(places)]
    lines += ["", "Bonds", ""] + [f"{2 * w + k + 1} 1 {3 * w + 1} {3 * w + k + 2}" for w in range(waters) for k in (0, 1)]
    lines += ["", "Angles", ""] + [f"{w + 1} 1 {3 * w + 2} {3 * w + 1} {3 * w + 3}" for w in range(waters)]
    return "\n".join(lines) + "\n"


def lammps(molecules, units, steps):
    """ns a unit and step of the row "Modify", with fix rattle less without."""
    def modify(rattle):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "in.data").write_text(lammps_data(molecules[0]))
            (folder / "in.lmp").write_text(LAMMPS.format(rattle=rattle, steps=steps))
            run = subprocess.run(["lmp", "-in", "in.lmp", "-log", "none"], cwd=folder, check=True, capture_output=True,
                                 text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
        return float(re.search(r"^Modify\s*\|\s*([\d.e+-]+)", run.stdout, re.M).group(1))

    return (modify("fix rigid all rattle 1e-6 100 0 b 1 a 1") - modify("")) / steps / units * 1e9


def openmm(program):
    """[(platform, system, ns a unit and step)]"""
    run = subprocess.run([program], capture_output=True, text=True)
    if run.returncode != 0:
        print(f"openmm_bonds: {run.stderr.strip() or 'built without OpenMM'}: OpenMM skipped", file=sys.stderr)
        return []
    return [(platform, system, float(ns)) for platform, system, ns in csv.reader(run.stdout.splitlines())]


UNIT = {"chains-100x20": "bond", "water-1000": "water"}
METHODS = ("baumgarte", "feedforward", "newton", "settle")


def ours(program):
    """[(method, system, ns a unit and step)]"""
    run = subprocess.run([program, f"--benchmark_filter=^({'|'.join(METHODS)})/({'|'.join(UNIT)})/fast/1/",
                          "--benchmark_min_time=0.1", "--benchmark_format=json"], check=True, capture_output=True, text=True)
    return [(*row["name"].split("/")[:2], row["ns_per_unit"]) for row in json.loads(run.stdout)["benchmarks"]]


def measure(steps, build):
    """[(engine, system, ns a unit and step)], each once."""
    rows = ours(build / "constraints_bench")
    for gmx in peer_gromacs.engines():
        if peer_gromacs.precision(gmx) != "mixed":
            continue
        name = peer_gromacs.version(gmx)
        rows.append((f"LINCS, {name}", "chains-100x20", gromacs(gmx, chains(100, 20), 2000, steps)))
        rows.append((f"SETTLE, {name}", "water-1000", gromacs(gmx, waters(1000), 1000, steps)))
    if (build / "openmm_bonds").exists():
        for platform, system, ns in openmm(build / "openmm_bonds"):
            algorithm = "SETTLE" if system.startswith("water") else "CCMA"
            rows.append((f"{algorithm}, OpenMM {platform}", system, ns))
    if shutil.which("lmp"):
        rows.append(("RATTLE, LAMMPS", "water-1000", lammps(waters(1000), 1000, steps // 10)))
    return rows


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--steps", type=int, default=20000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "results" / "peers.csv")
    options = parser.parse_args()
    seen = {}
    for _ in range(options.repeats):
        for engine, system, ns in measure(options.steps, options.build):
            seen.setdefault((system, engine), []).append(ns)
    median = {key: statistics.median(times) for key, times in seen.items()}
    with options.out.open("w", newline="") as file:
        file.write(f"# {machine.describe()}; ns a unit and step, and over each method's; medians of {options.repeats}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["system", "unit", "engine", "ns", *(f"over_{m}" for m in METHODS)])
        for (system, engine), ns in sorted(median.items(), key=lambda item: (item[0][0], item[1])):
            over = [f"{ns / median[system, m]:.2f}" if (system, m) in median else "" for m in METHODS]
            writer.writerow([system, UNIT[system], engine, f"{ns:.1f}", *over])
    print(options.out.read_text(), end="")


if __name__ == "__main__":
    main()
