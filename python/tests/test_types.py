import inspect
import subprocess
import sys
from pathlib import Path

import pytest

import taut

PACKAGE = Path(taut.__file__).parent


def test_mypy():
    pytest.importorskip("mypy", reason="needs mypy from PyPI")
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "-p", "taut"],
                          cwd=PACKAGE.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_stubs_are_what_is_there():
    pytest.importorskip("mypy", reason="needs mypy from PyPI")
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", "taut._core", "taut.options",
                           "--ignore-missing-stub"], cwd=PACKAGE.parent, capture_output=True, text=True)
    unlike = [line for line in done.stdout.splitlines() if "is not present at runtime" in line]
    assert not unlike, done.stdout


def test_everything_says_what_it_is():
    for name in dir(taut):
        thing = getattr(taut, name)
        if not name.startswith("_") and (inspect.isclass(thing) or callable(thing)):
            assert inspect.getdoc(thing), name
    for name, member in inspect.getmembers(taut.Simulation):
        if not name.startswith("_"):
            assert inspect.getdoc(member), f"Simulation.{name}"
