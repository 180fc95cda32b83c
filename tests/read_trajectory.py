"""Runs taut and reads its trajectories with readers written elsewhere: MDAnalysis, and h5py for what MDAnalysis
leaves out. Usage: read_trajectory.py TAUT. What a frame must be is known from log.csv and final.start.toml, and
from Newton's law between frames a step apart."""

import csv
import pathlib
import subprocess
import sys
import tempfile
import time
import tomllib
import unittest
import warnings

warnings.simplefilter("ignore")
import h5py
import MDAnalysis
import numpy as np

TAUT = sys.argv.pop(1)


def run(folder, *words):
    subprocess.run([TAUT, *words, "--out", folder], check=True, capture_output=True)
    return pathlib.Path(folder)


class Read:
    """Everything of a folder."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        with open(folder / "log.csv") as file:
            self.log = list(csv.DictReader(file))
        self.time = np.array([float(row["Time (ps)"]) for row in self.log])
        self.step = np.array([int(row['#"Step"' if '#"Step"' in row else "#Step"]) for row in self.log])
        self.end = tomllib.loads((folder / "final.start.toml").read_text())
        atoms = np.array(self.end["atoms"])
        self.x, self.v = atoms[:, :3], atoms[:, 3:]
        pdb = str(folder / "start.pdb")
        self.start = MDAnalysis.Universe(pdb)
        self.dcd = MDAnalysis.Universe(pdb, str(folder / "trajectory.dcd"))
        self.h5md = MDAnalysis.Universe(pdb, str(folder / "trajectory.h5md"))
        self.file = h5py.File(folder / "trajectory.h5md", "r")

    def frames(self, name):
        return self.file[f"particles/all/{name}/value"][:]


class Octahedron(unittest.TestCase):
    """Waters in a box that is not rectangular."""

    def test_box(self):
        with tempfile.TemporaryDirectory() as folder:
            read = Read(run(folder, "run", "water", "--steps", "2", "--set", "build.box=octahedron", "--set",
                            "build.molecules=400", "--set", "run.trajectory_every=1", "--set", "run.trajectory=both"))
            vectors = 10 * np.array(read.end["box_nm"]).reshape(3, 3)
            edge = vectors[0, 0]
            for universe in (read.start, read.dcd, read.h5md):
                for frame in universe.trajectory:
                    np.testing.assert_allclose(frame.dimensions, [edge, edge, edge, 70.528779, 109.471221, 70.528779],
                                               rtol=1e-4)
            np.testing.assert_allclose(read.file["particles/all/box/edges/value"][-1], vectors / 10, rtol=1e-12)


class Water(unittest.TestCase):
    """216 waters in a box, a frame for every row of the log."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.read = Read(run(cls.folder.name, "run", "water", "--steps", "40", "--set", "run.log_every=10", "--set",
                            "run.trajectory_every=10", "--set", "run.trajectory=both"))

    def test_times(self):
        read = self.read
        for universe in (read.dcd, read.h5md):
            self.assertEqual(universe.trajectory.n_frames, 5)
            np.testing.assert_allclose([frame.time for frame in universe.trajectory], read.time, rtol=1e-6)
        np.testing.assert_array_equal(read.file["particles/all/position/time"], read.time)
        np.testing.assert_array_equal(read.file["particles/all/position/step"], read.step)
        self.assertEqual(read.file["particles/all/position/time"], read.file["particles/all/force/time"])

    def test_box(self):
        edges = 10 * np.array(self.read.end["box_nm"])
        for universe in (self.read.start, self.read.dcd, self.read.h5md):
            for frame in universe.trajectory:
                np.testing.assert_allclose(frame.dimensions, [*edges, 90, 90, 90], rtol=1e-6)
        self.assertEqual([str(b, "utf8") for b in self.read.file["particles/all/box"].attrs["boundary"].astype("S")],
                         ["periodic"] * 3)

    def test_last_frame(self):
        read = self.read
        for universe in (read.dcd, read.h5md):
            np.testing.assert_allclose(universe.trajectory[-1].positions, 10 * read.x, rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(read.h5md.trajectory[-1].velocities, 10 * read.v, rtol=1e-6, atol=1e-5)
        np.testing.assert_array_equal(read.frames("position")[-1], read.x)
        np.testing.assert_array_equal(read.frames("velocity")[-1], read.v)
        forces = read.frames("force")[-1] / 10  # kJ/mol/Å
        np.testing.assert_allclose(read.h5md.trajectory[-1].forces, forces, rtol=1e-5, atol=1e-4)

    def test_both_files_hold_the_same(self):
        for one, other in zip(self.read.dcd.trajectory, self.read.h5md.trajectory):
            np.testing.assert_allclose(one.positions, other.positions, rtol=2e-7, atol=1e-6)

    def test_names_and_bonds(self):
        read = self.read
        atoms = read.start.atoms
        self.assertEqual(list(atoms.names), ["OW", "HW1", "HW2"] * 216)
        self.assertEqual(list(atoms.elements), ["O", "H", "H"] * 216)
        self.assertEqual(set(atoms.resnames), {"HOH"})
        self.assertEqual(len(read.start.residues), 216)
        self.assertEqual(len(read.start.bonds), 648)
        np.testing.assert_allclose(atoms.positions, read.dcd.trajectory[0].positions, atol=6e-4)
        bonds = read.file["connectivity/bonds"]
        self.assertEqual(read.file[bonds.attrs["particles_group"]].name, "/particles/all")
        lengths = np.linalg.norm(np.diff(read.frames("position")[-1][bonds[:]], axis=1)[:, 0], axis=1)
        np.testing.assert_allclose(np.unique(lengths.round(5)), [0.09572, 0.15139], atol=1e-5)
        species = read.file["particles/all/species"]
        self.assertEqual(h5py.check_enum_dtype(species.dtype), {"OW": 0, "HW1": 1, "HW2": 2})
        self.assertEqual(list(species[:4]), [0, 1, 2, 0])
        np.testing.assert_allclose(read.file["particles/all/mass"][:3], [15.999, 1.008, 1.008], atol=0.02)

    def test_says_what_it_is(self):
        h5md = self.read.file["h5md"]
        self.assertEqual(list(h5md.attrs["version"]), [1, 1])
        self.assertEqual(h5md["creator"].attrs["name"], "taut")
        self.assertEqual(list(h5md["modules/units"].attrs["version"]), [1, 0])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()


class FreeChain(unittest.TestCase):
    """Chains without forces, Baumgarte, a frame every step: all force is the bonds'."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.read = Read(run(cls.folder.name, "run", "freely_jointed", "--steps", "20", "--method", "baumgarte",
                            "--dt-fs", "1", "--set", "run.trajectory_every=1", "--set", "run.trajectory=both"))

    def test_moves_by_newtons_law(self):
        x, v, f = (self.read.frames(name) for name in ("position", "velocity", "force"))
        a = f / self.read.file["particles/all/mass"][:][None, :, None]
        h = np.diff(self.read.file["particles/all/position/time"])[:, None, None]
        np.testing.assert_allclose(x[1:], x[:-1] + h * v[:-1] + h**2 / 2 * a[:-1], atol=1e-12)
        np.testing.assert_allclose(v[1:], v[:-1] + h / 2 * (a[:-1] + a[1:]), atol=1e-10)
        self.assertGreater(np.abs(h[0] * a).max(), 1e-3)  # there is something to see

    def test_tensions_are_the_forces(self):
        """Tensions are those of the instant, forces those of the step, which swing about them after the start by O(h)."""
        x, f = self.read.frames("position"), self.read.frames("force")
        bonds, tension = self.read.file["connectivity/bonds"][:], self.read.file["observables/tension/value"][:]
        i, j = bonds.T
        r = x[:, j] - x[:, i]
        pull = tension[:, :, None] * r / np.linalg.norm(r, axis=2)[:, :, None]
        sum_of_pulls = np.zeros_like(f)
        for frame in range(len(f)):
            np.add.at(sum_of_pulls[frame], i, pull[frame])
            np.add.at(sum_of_pulls[frame], j, -pull[frame])
        np.testing.assert_allclose(sum_of_pulls, f, atol=3e-3 * np.abs(f).max())
        for frame, row in zip(self.read.h5md.trajectory, tension):
            np.testing.assert_array_equal(frame.data["tension"], row)

    def test_has_no_box(self):
        for universe in (self.read.dcd, self.read.h5md):
            self.assertIsNone(universe.trajectory[0].dimensions)
        self.assertNotIn("edges", self.read.file["particles/all/box"])

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()


class Killed(unittest.TestCase):
    """A kill at any instant leaves files that open, and a run that goes on as if nothing had been."""

    def test_files_stay_whole(self):
        keys = ["water", "--steps", "300", "--set", "run.trajectory_every=2", "--set", "run.trajectory=both", "--set",
                "run.checkpoint_every=4", "--set", "run.log_every=300"]
        with tempfile.TemporaryDirectory() as whole, tempfile.TemporaryDirectory() as parts:
            run(whole, "run", *keys)
            words, opened = [TAUT, "run", *keys, "--continue", "--out", parts], 0
            for kill in range(6):
                process = subprocess.Popen(words, stdout=subprocess.DEVNULL)
                time.sleep(0.25 + 0.037 * kill)
                process.kill()
                process.wait()
                if not pathlib.Path(parts, "checkpoint.cbor").exists():
                    continue
                with h5py.File(pathlib.Path(parts, "trajectory.h5md"), "r") as file:
                    opened += len(file["particles/all/position/value"][:]) > 0
            self.assertGreater(opened, 0)
            subprocess.run(words, check=True, capture_output=True)
            self.assertEqual(pathlib.Path(whole, "trajectory.dcd").read_bytes(),
                             pathlib.Path(parts, "trajectory.dcd").read_bytes())
            one, other = Read(whole), Read(parts)
            for name in ("position", "velocity", "force"):
                np.testing.assert_array_equal(one.frames(name), other.frames(name))


if __name__ == "__main__":
    unittest.main()
