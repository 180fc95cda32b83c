import pathlib
import sys

import pytest

HERE = pathlib.Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parents[1] / "lammps/examples")]

import lammps  # noqa: E402
import systems  # noqa: E402


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "water.data").write_text(systems.water().text([15.9994, 1.008]))
    (tmp_path / "methane.data").write_text(systems.methane().text([12.0, 1.0]))
    (tmp_path / "chains.data").write_text(systems.chains(6, 40).text([1.0]))
    return tmp_path


@pytest.fixture
def run(folder):
    """run(input, ranks) → what it printed."""
    return lambda text, ranks=1, **variables: lammps.run(folder, text, ranks, **variables)
