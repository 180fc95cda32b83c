"""Every example makes the picture it promises."""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[1] / "examples"
EXAMPLES = sorted(path for path in FOLDER.glob("*.py") if path.stem != "notebook")


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_example(example, tmp_path):
    text = example.read_text()
    pytest.importorskip("matplotlib", reason="needs matplotlib")
    for library in re.findall(r"^(?:from|import) (openmm|MDAnalysis|jax)\b", text, re.M):
        pytest.importorskip(library, reason=f"needs {library} from PyPI: pip install {library}")
    done = subprocess.run([sys.executable, str(example)], cwd=tmp_path, capture_output=True, text=True,
                          env={**os.environ, "MPLBACKEND": "Agg"}, timeout=120)
    assert done.returncode == 0, done.stderr
    promised = re.search(r"Draws\s+(\w+\.png)", text).group(1)
    assert (tmp_path / promised).stat().st_size > 10_000


def test_the_notebook_is_the_examples():
    spec = importlib.util.spec_from_file_location("notebook", FOLDER / "notebook.py")
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    assert set(made.ORDER) == {path.stem for path in EXAMPLES}
    assert (FOLDER / "taut.ipynb").read_text() == made.notebook(), "python3 python/examples/notebook.py writes it"
