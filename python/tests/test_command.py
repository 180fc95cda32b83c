"""The command taut is there as pip makes it, and as python -m taut."""

import subprocess
import sys
from pathlib import Path

import pytest


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
