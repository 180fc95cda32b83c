"""The command taut is there as pip makes it, and as python -m taut."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import taut


def said(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def test_the_module_is_the_command(command, tmp_path):
    assert said(sys.executable, "-m", "taut", "--version") == said(command, "--version")
    arguments = ["run", "pair", "--steps", "20", "--json", "--out"]
    said(sys.executable, "-m", "taut", *arguments, tmp_path / "module")
    said(command, *arguments, tmp_path / "command")
    of_module, of_command = ((tmp_path / by / "final.start.toml").read_text() for by in ("module", "command"))
    assert of_module == of_command
    refused = subprocess.run([sys.executable, "-m", "taut", "run", "nowhere"], capture_output=True, text=True)
    assert refused.returncode == 2 and refused.stderr.startswith("taut: ")


def test_pip_brings_the_command(command):
    script = Path(sys.executable).parent / "taut"
    if not script.exists():
        pytest.skip("taut is not installed by pip here")
    assert said(script, "--version") == said(command, "--version")


def imported(folder):
    """What `import taut` says in another Python, of a package whose files lie in this folder."""
    (folder / "taut").mkdir()
    package = Path(taut.__file__).parent
    for file in package.glob("*.py"):
        (folder / "taut" / file.name).symlink_to(file)
    (folder / "numpy.py").write_text('__version__ = "2.4.6"')
    return lambda: subprocess.run([sys.executable, "-c", "import taut"], env={**os.environ, "PYTHONPATH": str(folder)},
                                  capture_output=True, text=True).stderr.splitlines()[-1]


def test_a_module_for_another_python_says_so(tmp_path):
    import_it = imported(tmp_path)
    assert "cannot import name '_core'" in import_it()
    (tmp_path / "taut" / "_core.cpython-42-x86_64-linux-gnu.so").touch()
    said = import_it()
    assert said.startswith("ImportError: this taut was built for cpython-42-x86_64-linux-gnu, and this Python is cpython-3")
    assert "pip install ." in said


def test_a_module_for_numpy_1_says_so(tmp_path):
    import_it = imported(tmp_path)
    (tmp_path / "taut" / "_core.py").write_text("knows_numpy_2 = False")
    said = import_it()
    assert said.startswith("ImportError: this taut was built for numpy 1") and "numpy here is 2.4.6" in said
    assert "pip install ." in said and "numpy<2" in said
