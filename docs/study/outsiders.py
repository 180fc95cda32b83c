#!/usr/bin/env python3
"""Measure the drift of villin at constant energy under taut, GROMACS and OpenMM: data/outsiders.csv.

    GMX=gmx docs/study/outsiders.py [--seeds 2] [--ps 10] [--taut build/taut]

All programs are given the same start, 1 ps in the study's bath with other velocities for every seed, and the same PME
(order 4; OpenMM 5); one thread each. GROMACS has SETTLE for water and LINCS for the rest, at its defaults (order 4, one
iteration, a pair list for 0.005 kJ/mol/ps an atom) or strict (order 6, two iterations, 1e-4). OpenMM is its CPU platform
with VerletIntegrator at two constraint tolerances, for a fifth of the time. Rows that are there are not run again.
"""
import pathlib
import subprocess
import sys
import tempfile

from cases import DATA, ROOT, read_rows
from study import Study, open_rows, options

sys.path.insert(0, str(ROOT / "benchmarks"))
import peer_gromacs
import peer_systems
import real_systems
import sound_steps

import openmm
import openmm.app as app

STEPS = {"villin": (2, 3, 4), "villin-3u": (4, 5, 6)}  # [fs]
COLUMNS = ["system", "program", "dt_fs", "seed", "ps", "drift", "error"]


class Protein(sound_steps.System):
    """The start of one seed, as sound_steps.py gives it to all programs."""

    def __init__(self, kind, study, seed, work):
        self.name, self.taut, self.tolerance = kind, study.taut, 1e-6
        words, keys = study.of_cell(kind, "newton", 1, "mixed")
        subprocess.run([*words, "--steps", "1000", "--out", str(work / "run"), "--set", *keys, f"run.seed={seed}"], check=True,
                       capture_output=True)
        for suffix in ("top", "gro"):
            (work / f"{kind}.{suffix}").write_text((study.work / "systems" / f"{kind}.{suffix}").read_text())
        real_systems.write_gro_of(work / f"{kind}.gro", work / "run")
        real_systems.write_xml(work, kind, app.HBonds)
        self.described = peer_systems.Prepared(kind, work)
        self.scene = ["--openmm", self.described.file("system.xml"), self.described.file("state.xml")]
        self.set = ["forcefield.pme_order=4", f"forcefield.ewald_alpha_per_nm={self.described.alpha}",
                    f"forcefield.pme_grid={list(self.described.mesh)}"]
        self.freedoms = self.run_taut("newton", 1, 1)["dof"]

    def openmm_context(self, dt_fs):
        context, integrator = super().openmm_context(dt_fs)
        integrator.setConstraintTolerance(self.tolerance)
        return context, integrator


def taut_drift(system, method, dt_fs, ps):
    seen = system.run_taut(method, dt_fs, int(ps * 1000 / dt_fs))
    return seen and (seen["energy_drift_kj_mol_ns_dof"], seen["energy_drift_standard_error"] or 0)


def openmm_drift(system, tolerance, dt_fs, ps):
    system.tolerance = tolerance
    try:
        return sound_steps.drift_of_openmm(system, None, dt_fs, ps)
    except openmm.OpenMMException:  # positions that are no numbers
        return None


PROGRAMS = {**{f"taut, {method}": (taut_drift, method) for method in ("newton", "feedforward")},
            "GROMACS": (sound_steps.drift_of_gromacs, "GROMACS"),
            "GROMACS, strict": (sound_steps.drift_of_gromacs, "GROMACS, strict"),
            "OpenMM, 1e-5": (openmm_drift, 1e-5), "OpenMM, 1e-8": (openmm_drift, 1e-8)}


def main():
    ask = options(__doc__)
    ask.add_argument("--seeds", type=int, default=2)
    ask.add_argument("--ps", type=float, default=10)
    asked = ask.parse_args()
    study = Study(asked.taut, asked.work)
    write = open_rows(DATA / "outsiders.csv", COLUMNS)
    done = {(row["system"], row["program"], float(row["dt_fs"]), int(row["seed"])) for row in read_rows("outsiders.csv")}
    programs = [name for name in PROGRAMS if peer_gromacs.engines() or not name.startswith("GROMACS")]
    for seed in range(1, asked.seeds + 1):
        for kind, steps in STEPS.items():
            todo = [(name, step) for name in programs for step in steps if (kind, name, step, seed) not in done]
            if not todo:
                continue
            with tempfile.TemporaryDirectory(dir=study.work) as folder:
                system = Protein(kind, study, seed, pathlib.Path(folder))
                for name, step in todo:
                    measure, setting = PROGRAMS[name]
                    row = dict(zip(("drift", "error"), measure(system, setting, step, asked.ps) or ()))
                    write(row | {"system": kind, "program": name, "dt_fs": step, "seed": seed, "ps": asked.ps})


if __name__ == "__main__":
    main()
