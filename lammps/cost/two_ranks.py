"""Time of fix taut on one processor and on two, each on a core of its own, of a machine that does nothing else.

    TAUT_LAMMPS=build/taut-lammps python3 two_ranks.py [TURNS [ilves]]      # 3; two to three minutes

Melts of in.melt, relaxed first, and water of in.water beside fix shake: medians over turns of `Modify` (fixes and what
they wait for) and of the whole loop, ns a bond or water and step. `ilves`: melts alone, beside fix ilves, which LAMMPS
has since June 2026.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

import numpy as np

import count

EXAMPLES = count.HERE.parent / "examples"
sys.path.insert(0, str(EXAMPLES))
import systems  # noqa: E402

MPIRUN = os.environ.get("TAUT_MPIRUN", "mpirun --allow-run-as-root --bind-to core").split()
STEPS = 100


def run(folder, script, ranks, **variables):
    """Seconds of Modify and of the loop, of the last run."""
    command = [*MPIRUN, "-np", str(ranks), os.path.abspath(count.PROGRAM), "-in", str(script), "-log", "none"]
    for name, value in variables.items():
        command += ["-var", name, str(value)]
    environment = dict(os.environ, OMP_NUM_THREADS="1", OMPI_MCA_btl_vader_single_copy_mechanism="none")
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(done.stdout[-500:] + done.stderr[-500:])
    return [float(re.findall(line, done.stdout, re.M)[-1])
            for line in (r"^Modify +\| \S+ +\| (\S+)", r"^Loop time of (\S+)")]


def show(what, folder, script, turns, count_of, holds):
    """A row for each of `holds`: name → variables."""
    found = {}
    for _ in range(turns):
        for name, variables in holds.items():
            for ranks in (1, 2):
                found.setdefault((name, ranks), []).append(run(folder, script, ranks, steps=STEPS, **variables))
    for name in holds:
        modify, loop = np.transpose([np.median(found[name, ranks], axis=0) for ranks in (1, 2)]) * 1e9 / STEPS / count_of
        print(f"| {what}, {name} | {modify[0]:.0f} | {modify[1]:.0f} | {modify[1] / modify[0]:.2f} | {loop[0]:.0f} | "
              f"{loop[1]:.0f} | {loop[1] / loop[0]:.2f} |", flush=True)


def main(turns=3, beside=""):
    print("| | Modify, one | two | ratio | loop, one | two | ratio |\n|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "water.data").write_text(systems.water(10).text([15.9994, 1.008]))
        if not beside:
            show("1000 waters", folder, count.HERE / "in.water", turns, 1000,
                 {fix: {"hold": f"{fix} b 1 a 1"} for fix in ("taut feedforward", "taut baumgarte", "shake 1e-4 500 0")})
        for chains, beads in ((20, 500), (50, 1000), (5, 10_000)):
            (folder / "melt.data").write_text(systems.chains(chains, beads, bond=0.97, density=0.85).text([1.0]))
            relax = (EXAMPLES / "in.melt").read_text() + "thermo_style one\nunfix hold\nwrite_data melt.data nocoeff\n"
            (folder / "in.relax").write_text(relax)
            run(folder, "in.relax", 2, relax=500, steps=0)
            of = {"relax": 0, **({"cutoff": 2.5, "move": "nvt temp 1 1 0.5"} if chains == 5 else {})}
            holds = {"taut feedforward": of}
            if beside:
                holds |= {f"ilves {tol}": {**of, "hold": f"ilves {tol} 100 0", "columns": "pe"} for tol in ("1e-4", "1e-8")}
            else:
                holds["taut feedforward overlap 3"] = {**of, "hold": "taut feedforward overlap 3", "reach": 5}
            show(f"{chains} × {beads}", folder, EXAMPLES / "in.melt", turns, chains * (beads - 1), holds)


if __name__ == "__main__":
    main(int(sys.argv[1]) if sys.argv[1:] else 3, *sys.argv[2:])
