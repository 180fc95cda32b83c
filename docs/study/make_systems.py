#!/usr/bin/env python3
"""Makes the study's protein: the headpiece of villin in water, which OpenMM's package brings (8867 atoms).

    docs/study/make_systems.py FOLDER [--taut build/taut]

Needs OpenMM and ParmEd (pip install openmm parmed). FOLDER/villin.top and .gro are GROMACS's, FOLDER/KIND.system.xml and
.state.xml the same for taut and OpenMM with other rigid bonds and masses: ff14SB and TIP3P, PME to 0.9 nm, no dispersion
correction, minimised, and each kind 5 ps at 300 K by taut at 1 fs with a friction of 5/ps.
"""
import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "benchmarks"))


def make(folder, taut):
    import openmm.app as app
    import parmed
    import real_systems

    kinds = {"villin": app.HBonds, "villin-all": app.AllBonds, "villin-angles": app.HAngles, "villin-3u": app.HBonds,
             "villin-angles-3u": app.HAngles}
    pdb = app.PDBFile(str(pathlib.Path(app.__file__).parent / "data" / "test.pdb"))
    described = real_systems.from_forcefield(pdb, "amber14-all.xml", "amber14/tip3p.xml")
    for suffix, precision in (("top", {}), ("gro", {"precision": 7})):
        described.save(str(folder / f"villin.{suffix}"), overwrite=True, **precision)
    real_systems.settle_down(folder, "villin", taut)
    for heavy in (False, True):
        if heavy:  # takes the mass from the atom that the hydrogen is bonded to; not in waters
            parmed.tools.HMassRepartition(described, 3).execute()
        for kind in (kind for kind in kinds if kind.endswith("-3u") == heavy):
            if kind != "villin":
                described.save(str(folder / f"{kind}.top"), overwrite=True)
                shutil.copy(folder / "villin.gro", folder / f"{kind}.gro")
            real_systems.write_xml(folder, kind, kinds[kind])
            bring_to_bath(folder, kind, taut)
            real_systems.write_xml(folder, kind, kinds[kind])


def bring_to_bath(folder, kind, taut):
    import real_systems
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([taut, "run", "--openmm", folder / f"{kind}.system.xml", folder / f"{kind}.state.xml", "--threads", "1",
                        "--steps", "5000", "--dt-fs", "1", "--set", "run.thermostat=langevin", "run.friction_per_ps=5",
                        "run.temperature_k=300", "--out", out], check=True, stdout=subprocess.DEVNULL)
        real_systems.write_gro_of(folder / f"{kind}.gro", out)


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("folder", type=pathlib.Path)
    ask.add_argument("--taut", default=str(ROOT / "build/taut"))
    asked = ask.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    make(asked.folder, asked.taut)


if __name__ == "__main__":
    main()
