"""What an installed wheel must do where there is Python alone. Run it in the environment that the wheel is in."""

import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import unittest

import numpy as np

import taut

COMMAND = os.path.join(sysconfig.get_path("scripts"), "taut")


def run(*words):
    return subprocess.run([COMMAND, *words], check=True, capture_output=True, text=True).stdout


class Wheel(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def test_module_runs_a_scene(self):
        simulation = taut.Simulation("water", method="newton")
        simulation.run(100)
        self.assertTrue(np.isfinite(simulation.positions).all())
        self.assertLess(simulation.summary["max_rel_bond_error"], 1e-9)

    def test_command_writes_dcd_and_h5md_and_reads_them(self):
        out = self.folder / "water"
        run("run", "water", "--steps", "200", "--set", "run.trajectory_every=20", "--set", "run.trajectory=both", "--out", out)
        self.assertEqual((out / "trajectory.h5md").read_bytes()[:8], b"\x89HDF\r\n\x1a\n")
        self.assertIn("O", run("measure", out))  # reads the DCD
        size = (out / "trajectory.h5md").stat().st_size
        run("resume", out, "--steps", "1200")  # reads the H5MD and goes on in it
        self.assertGreater((out / "trajectory.h5md").stat().st_size, size)

    def test_chart(self):
        out = self.folder / "chart"
        run("chart", "pair", "--quick", "--out", out)
        self.assertTrue(list(out.glob("*.csv")))

    def test_python_dash_m(self):
        by_module = subprocess.run([sys.executable, "-m", "taut", "--version"], check=True, capture_output=True, text=True)
        self.assertEqual(by_module.stdout, run("--version"))

    def test_scenes_pages_and_completions(self):
        for scene in taut.scenes():
            self.assertIn(scene, run("scenes"))
        data = pathlib.Path(sysconfig.get_path("data")) / "share"
        for name in ("man/man1/taut.1", "bash-completion/completions/taut", "zsh/site-functions/_taut"):
            self.assertGreater((data / name).stat().st_size, 2000, name)

    def test_nothing_else_comes_along(self):
        package = pathlib.Path(taut.__file__).parent
        for library in (package.parent / "taut.libs").iterdir():
            self.assertRegex(library.name, "^lib(gomp|hwy)")


if __name__ == "__main__":
    unittest.main()
