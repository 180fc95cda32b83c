"""Runs LAMMPS on a peer_systems.Molecules, and returns µs a step. It has no reaction field: Coulomb uses a cutoff."""
import pathlib
import re
import shutil
import subprocess
import tempfile

KCAL, ANGSTROM = 1 / 4.184, 10


def data(m):
    """Atoms, bonds and angles as LAMMPS wants them; an atom kind has its own type."""
    kinds = list(dict.fromkeys(a[1:] for a in m.atoms))
    type_of = [kinds.index(a[1:]) + 1 for a in m.atoms]
    n, bonds = len(m.atoms), m.bonds[:2] if m.water else m.bonds
    lines = [m.name, "", f"{n * m.count} atoms", f"{len(bonds) * m.count} bonds", f"{len(kinds)} atom types", "1 bond types"]
    if m.water:
        lines += [f"{m.count} angles", "1 angle types"]
    lines += [f"0 {edge * ANGSTROM:.6f} {a}lo {a}hi" for edge, a in zip(m.box, "xyz")]
    lines += ["", "Masses", ""] + [f"{t + 1} {kind[0]}" for t, kind in enumerate(kinds)]
    lines += ["", "Atoms", ""] + [
        f"{k + 1} {k // n + 1} {type_of[k % n]} {m.atoms[k % n][2]} " + " ".join(f"{c * ANGSTROM:.8f}" for c in x)
        for k, x in enumerate(m.x)]
    lines += ["", "Velocities", ""] + [f"{k + 1} " + " ".join(f"{c * ANGSTROM * 1e-3:.9f}" for c in v) for k, v in enumerate(m.v)]
    lines += ["", "Bonds", ""] + [f"{c * len(bonds) + b + 1} 1 {c * n + i + 1} {c * n + j + 1}"
                                  for c in range(m.count) for b, (i, j, _) in enumerate(bonds)]
    if m.water:
        lines += ["", "Angles", ""] + [f"{c + 1} 1 {3 * c + 2} {3 * c + 1} {3 * c + 3}" for c in range(m.count)]
    return "\n".join(lines) + "\n", kinds


def script(m, kinds, steps):
    cutoff = m.cutoff * ANGSTROM
    style = f"lj/cut/coul/cut {cutoff}" if any(kind[1] for kind in kinds) else f"lj/cut {cutoff}"
    pairs = "\n".join(f"pair_coeff {t + 1} {t + 1} {kind[3] * KCAL} {max(kind[2], 0.01) * ANGSTROM}" for t, kind in enumerate(kinds))
    angle = "angle_style harmonic\nangle_coeff 1 100 104.52\n" if m.water else ""
    return f"""units real
atom_style full
bond_style harmonic
{"angle_style harmonic" if m.water else ""}
special_bonds lj/coul 0 {"0 0" if m.water else "1 1"}
read_data in.data
pair_style {style}
pair_modify mix arithmetic
{pairs}
bond_coeff 1 300 {m.bonds[0][2] * ANGSTROM}
{angle}neighbor 2 bin
neigh_modify delay 0 every 1 check yes
timestep {m.dt_fs}
fix move all nve
fix rigid all rattle 1e-6 100 0 b 1 {"a 1" if m.water else ""}
thermo 100000
run 50
run {steps}
"""


def engines():
    return ["lmp"] if shutil.which("lmp") else []


def version():
    text = subprocess.run(["lmp", "-h"], capture_output=True, text=True).stdout
    return "LAMMPS " + re.search(r"LAMMPS?[^\d]*-?\s*(\d+ \w+ \d+)|- (\d+ \w+ \d+)", text).group(0).split("- ")[-1]


def us_per_step(m, threads, seconds):
    """NaN where LAMMPS cannot: RATTLE there takes clusters of up to four atoms."""
    if not m.water:
        return float("nan")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text, kinds = data(m)
        (folder / "in.data").write_text(text)

        def measure(steps):
            (folder / "in.lmp").write_text(script(m, kinds, steps))
            launch = ["mpirun", "--allow-run-as-root", "-np", str(threads)] if threads > 1 else []
            out = subprocess.run([*launch, "lmp", "-in", "in.lmp", "-log", "none"], cwd=folder, check=True,
                                 capture_output=True, text=True).stdout
            return float(re.findall(r"Loop time of ([\d.e+-]+)", out)[-1]) / steps * 1e6

        return measure(max(20, int(seconds * 1e6 / measure(20))))
