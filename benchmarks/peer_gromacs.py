"""Runs GROMACS on a peer_systems.Molecules or Prepared, and returns µs a step by GROMACS's own clock over the second half of a run.
The programs are gmx and gmx_d, or those that the variable GMX names, with commas. Compare a build for this machine."""
import os
import pathlib
import re
import shutil
import subprocess
import tempfile

import machine
import peer_systems

MDP = """integrator = {integrator}
dt = {dt}
nsteps = {steps}
cutoff-scheme = Verlet
{coulomb}
rcoulomb = {cutoff}
rvdw = {cutoff}
vdw-modifier = {modifier}
rvdw-switch = {switch}
nstenergy = 1000
nstcalcenergy = 1000
nstlog = 0
constraint-algorithm = lincs
{more}
"""


def topology(m):
    types = {(mass, sigma, epsilon): f"T{k}" for k, (mass, sigma, epsilon) in
             enumerate(dict.fromkeys((a[1], a[3], a[4]) for a in m.atoms))}
    atoms = "\n".join(f"{k + 1} {types[a[1], a[3], a[4]]} 1 MOL {a[0]} {k + 1} {a[2]} {a[1]}" for k, a in enumerate(m.atoms))
    if m.water:
        bonds = f"[ settles ]\n1 1 {m.bonds[0][2]} {m.bonds[2][2]}\n[ exclusions ]\n1 2 3\n2 1 3\n3 1 2"
    else:
        bonds = "[ constraints ]\n" + "\n".join(f"{i + 1} {j + 1} 1 {d}" for i, j, d in m.bonds)
        for name, of, function, numbers in (("angles", 3, 1, m.angle), ("dihedrals", 4, 3, m.torsion)):
            if numbers:
                rows = [" ".join(map(str, (*range(k + 1, k + 1 + of), function, *numbers))) for k in range(len(m.atoms) + 1 - of)]
                bonds += "\n".join([f"\n[ {name} ]", *rows])
    kinds = "\n".join(f"{name} {mass} 0 A {sigma} {epsilon}" for (mass, sigma, epsilon), name in types.items())
    return (f"[ defaults ]\n1 2 no 1 1\n[ atomtypes ]\n{kinds}\n[ moleculetype ]\nM {m.excluded}\n[ atoms ]\n{atoms}\n{bonds}\n"
            f"[ system ]\n{m.name}\n[ molecules ]\nM {m.count}\n")


def coordinates(m):
    lines = [f"{n // len(m.atoms) % 99999 + 1:5d}MOL  {m.atoms[n % len(m.atoms)][0]:>5}{n % 99999 + 1:5d}"
             + "".join(f"{c:12.7f}" for c in x) + "".join(f"{c:12.7f}" for c in v) for n, (x, v) in enumerate(zip(m.x, m.v))]
    return "\n".join([m.name, str(len(m.x)), *lines, " ".join(f"{edge:.7f}" for edge in m.box)]) + "\n"


def engines():
    named = os.environ.get("GMX", "gmx,gmx_d").split(",")
    return [program for program in named if shutil.which(program)]


def of_version(program, key):
    text = subprocess.run([program, "--version"], capture_output=True, text=True).stdout
    return re.search(key + r":\s*(\S+)", text).group(1)


def precision(program):
    return of_version(program, "Precision")


def version(program):
    simd = of_version(program, "SIMD instructions")
    lacking = "" if simd == machine.simd() else f", not built for this machine's {machine.simd()}"
    return f"GROMACS {of_version(program, 'GROMACS version')} ({precision(program)}, {simd}{lacking})"


def coulomb(m):
    if not m.mesh:
        return "coulombtype = reaction-field\nepsilon-rf = 78.3"
    return "coulombtype = PME\npme-order = 4\newald-rtol = 1e-5\n" + "\n".join(f"fourier-n{d} = {n}" for d, n in zip("xyz", m.mesh))


def put_input(m, folder):
    """Writes in.gro, in.top and in.mdp, but for the number of steps, of a Molecules or a Prepared."""
    if isinstance(m, peer_systems.Prepared):
        shutil.copy(m.file("gro"), folder / "in.gro")
        shutil.copy(m.file("top"), folder / "in.top")
        modifier, integrator, more = "none", "md", "constraints = h-bonds\ncontinuation = yes"
    else:
        (folder / "in.gro").write_text(coordinates(m))
        (folder / "in.top").write_text(topology(m))
        modifier = "potential-switch" if m.switch else "potential-shift" if m.shifted else "none"
        integrator, more = m.integrator, m.coupling
    return lambda steps: (folder / "in.mdp").write_text(MDP.format(
        dt=m.dt_fs * 1e-3, steps=steps, cutoff=m.cutoff, switch=m.switch, coulomb=coulomb(m), modifier=modifier,
        integrator=integrator, more=more))


def us_per_step(program, m, threads, seconds):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_mdp = put_input(m, folder)

        def measure(steps):
            write_mdp(steps)
            run = lambda *a: subprocess.run([program, "-nobackup", *a], cwd=folder, check=True, capture_output=True)
            run("grompp", "-f", "in.mdp", "-c", "in.gro", "-p", "in.top", "-o", "in.tpr", "-maxwarn", "9")
            ranks = ["-ntmpi", "1"] if of_version(program, "MPI (?:library|version)") == "thread_mpi" else []
            run("mdrun", "-s", "in.tpr", *ranks, "-ntomp", str(threads), "-g", "md.log", "-noconfout", "-pin", "off",
                "-resethway", "-notunepme")
            core, wall = map(float, re.search(r"^\s+Time:\s+([\d.]+)\s+([\d.]+)", (folder / "md.log").read_text(), re.M).groups())
            return wall / (steps - steps // 2 + 1) * 1e6

        return measure(2 * max(10, int(seconds * 1e6 / measure(m.first_steps) / 2)))
