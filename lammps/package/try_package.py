"""Tries a LAMMPS that was built with the package TAUT as a shared library: python3 try_package.py SOURCE BUILD [-g]

Runs water with BUILD/lmp and with build/taut-lammps, and compares; builds LAMMPS's own tester of fixes,
test_fix_timestep, and runs it on this folder's unittest/*.yaml, and on fix rattle's for comparison. -g: has the tester
write these files anew. Needs libgtest-dev, libgmock-dev, libyaml-dev.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
TREE = HERE.parents[1]
sys.path[:0] = [str(TREE / "tests/lammps"), str(TREE / "lammps/examples")]
import inputs  # noqa: E402
import lammps  # noqa: E402
import systems  # noqa: E402


def compare(lmp, folder):
    (folder / "water.data").write_text(systems.water().text([15.9994, 1.008]))
    text = inputs.of(inputs.WATER, rest=inputs.THERMO + "thermo 1\nrun 20\n")
    ours = lammps.table(lammps.run(folder, text))
    lammps.PROGRAM = str(lmp)
    theirs = lammps.table(lammps.run(folder, text))
    for name in ("Temp", "PotEng", "TotEng", "Press"):
        off = np.abs(theirs[name] - ours[name]).max() / np.abs(ours[name]).max()
        print(f"water, 20 steps, {name}: within {off:.1e} of taut-lammps")


def tester(source, build, folder):
    styles = source / "unittest/force-styles"
    parts = [str(styles / f"{part}.cpp") for part in
             ("test_fix_timestep", "test_main", "test_config_reader", "yaml_writer", "error_stats")]
    made = folder / "test_fix_timestep"
    subprocess.run(["mpicxx", "-std=c++14", f"-DTEST_INPUT_FOLDER={styles / 'tests'}", f"-I{source / 'src'}", *parts,
                    f"-L{build}", f"-Wl,-rpath,{build}", "-llammps", "-lgtest", "-lgmock", "-lyaml", "-o", str(made)],
                   check=True)
    return made


def main(source, build, *words):
    source, build = (pathlib.Path(folder).resolve() for folder in (source, build))
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        compare(build / "lmp", folder)
        test = tester(source, build, folder)
        ours = sorted((HERE / "unittest").glob("*.yaml"))
        if "-g" in words:
            for file in ours:
                subprocess.run([test, file, "-g", folder / file.name], cwd=folder, check=True, stdout=subprocess.DEVNULL)
                file.write_text((folder / file.name).read_text())
        failed = 0
        for file in [*ours, source / "unittest/force-styles/tests/fix-timestep-rattle_angle.yaml"]:
            done = subprocess.run([test, file], cwd=folder, capture_output=True, text=True)
            failed += done.returncode != 0
            lines = [line for line in done.stdout.splitlines() if line.startswith(("[  PASSED", "[  SKIPPED", "[  FAILED"))]
            print(f"{file.name}:", *lines[:3])
    sys.exit(failed)


if __name__ == "__main__":
    main(*sys.argv[1:])
