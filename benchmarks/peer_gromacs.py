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
nstenergy = {energies}
nstcalcenergy = {energies}
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


def put_input(m, folder, energies=1000):
    """Writes in.gro, in.top and in.mdp, but for the number of steps, of a Molecules or a Prepared; so many steps between
    energies."""
    if isinstance(m, peer_systems.Prepared):
        shutil.copy(m.file("gro"), folder / "in.gro")
        shutil.copy(m.file("top"), folder / "in.top")
        modifier, integrator, more = "none", "md", "constraints = h-bonds\ncontinuation = yes\n" + m.coupling
    else:
        (folder / "in.gro").write_text(coordinates(m))
        (folder / "in.top").write_text(topology(m))
        modifier = "potential-switch" if m.switch else "potential-shift" if m.shifted else "none"
        integrator, more = m.integrator, m.coupling
    return lambda steps: (folder / "in.mdp").write_text(MDP.format(
        dt=m.dt_fs * 1e-3, steps=steps, cutoff=m.cutoff, switch=m.switch, coulomb=coulomb(m), modifier=modifier,
        integrator=integrator, more=more, energies=energies))


def prepare_and_run(program, folder, threads, *more):
    """Runs folder's input; returns mdrun's exit code."""
    run = lambda *a, check=True: subprocess.run([program, "-nobackup", *a], cwd=folder, check=check, capture_output=True).returncode
    run("grompp", "-f", "in.mdp", "-c", "in.gro", "-p", "in.top", "-o", "in.tpr", "-maxwarn", "9")
    ranks = ["-ntmpi", "1"] if of_version(program, "MPI (?:library|version)") == "thread_mpi" else []
    return run("mdrun", "-s", "in.tpr", *ranks, "-ntomp", str(threads), "-g", "md.log", "-noconfout", "-pin", "off", *more,
               check=False)


def energies(program, m, steps, folder):
    """Returns times [ps] and total energies [kJ/mol] of a run on one thread, every twentieth step; None if it fails."""
    put_input(m, folder, 20)(steps)
    if prepare_and_run(program, folder, 1):
        return None
    subprocess.run([program, "energy", "-f", "ener.edr", "-o", "e.xvg", "-dp"], cwd=folder, input="Total-Energy\n", text=True,
                   check=True, capture_output=True)
    rows = [list(map(float, line.split())) for line in (folder / "e.xvg").read_text().splitlines() if line[0] not in "#@"]
    return tuple(zip(*rows))


def timed_run(program, m, threads, seconds):
    """Returns the log of a run whose second half takes about so many seconds, and the steps of that half."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_mdp = put_input(m, folder)

        def run(steps):
            write_mdp(steps)
            if prepare_and_run(program, folder, threads, "-resethway", "-notunepme"):
                raise SystemExit((folder / "md.log").read_text()[-500:])
            return (folder / "md.log").read_text(), steps - steps // 2 + 1

        log, steps = run(m.first_steps)
        return run(2 * max(10, int(seconds / wall_seconds(log) * steps / 2)))


def wall_seconds(log):
    return float(re.search(r"^\s+Time:\s+[\d.]+\s+([\d.]+)", log, re.M)[1])


def us_per_step(program, m, threads, seconds):
    log, steps = timed_run(program, m, threads, seconds)
    return wall_seconds(log) / steps * 1e6
