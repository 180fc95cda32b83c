#!/usr/bin/env python3
"""Makes the study's protein: the headpiece of villin in water, which OpenMM's package brings (8867 atoms).

    docs/study/make_systems.py FOLDER [--taut build/taut]

Needs OpenMM and ParmEd (pip install openmm parmed). FOLDER/villin.top and .gro are GROMACS's, FOLDER/KIND.system.xml and
.state.xml the same for taut and OpenMM with other rigid bonds and masses: ff14SB and TIP3P, PME to 0.9 nm, no dispersion
correction, 1 ps at 300 K after a minimisation. study.py brings each kind to its bath afterwards.
"""
import argparse
import pathlib
import shutil
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "benchmarks"))


def make(folder, taut):
    import openmm.app as app
    import openmm.unit as unit
    import real_systems

    kinds = {"villin": (app.HBonds, 1), "villin-all": (app.AllBonds, 1), "villin-angles": (app.HAngles, 1),
             "villin-3u": (app.HBonds, 3), "villin-angles-3u": (app.HAngles, 3)}
    pdb = app.PDBFile(str(pathlib.Path(app.__file__).parent / "data" / "test.pdb"))
    described = real_systems.from_forcefield(pdb, "amber14-all.xml", "amber14/tip3p.xml")
    for suffix, precision in (("top", {}), ("gro", {"precision": 7})):
        described.save(str(folder / f"villin.{suffix}"), overwrite=True, **precision)
    real_systems.settle_down(folder, "villin", taut)
    for kind, (constraints, mass) in kinds.items():
        for suffix in ("top", "gro") if kind != "villin" else ():
            shutil.copy(folder / f"villin.{suffix}", folder / f"{kind}.{suffix}")
        real_systems.write_xml(folder, kind, constraints, **({"hydrogenMass": mass * unit.dalton} if mass > 1 else {}))


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("folder", type=pathlib.Path)
    ask.add_argument("--taut", default=str(ROOT / "build/taut"))
    asked = ask.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    make(asked.folder, asked.taut)


if __name__ == "__main__":
    main()
