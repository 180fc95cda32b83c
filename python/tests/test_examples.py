"""Every example makes the picture it promises."""

import ast
import importlib.util
import json
import os
import re
import shutil
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
    for mean, error, closed_form in re.findall(r"= (\S+) ± (\S+); (\S+) by", done.stdout):
        assert abs(float(mean) - float(closed_form)) < 4 * float(error), done.stdout
    promised = re.search(r"Draws\s+(\w+\.png)", text).group(1)
    assert (tmp_path / promised).stat().st_size > 10_000
    if "TAUT_GALLERY" in os.environ:
        keep = FOLDER.parents[1] / os.environ["TAUT_GALLERY"]
        shutil.copy(tmp_path / promised, keep / f"{example.stem}.png")


def test_the_gallery_has_every_example():
    page = (FOLDER.parents[1] / "docs" / "gallery.md").read_text()
    spec = importlib.util.spec_from_file_location("notebook", FOLDER / "notebook.py")
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    assert set(made.ORDER) == {path.stem for path in EXAMPLES}
    assert len(json.loads(made.notebook())["cells"]) == 1 + 2 * len(EXAMPLES)
    for path in EXAMPLES:
        title = ast.get_docstring(ast.parse(path.read_text())).partition(": ")[0]
        assert f"## {title}\n" in page and f"(../python/examples/{path.name})" in page
        assert f"(pictures/gallery/{path.stem}.png)" in page
        assert (FOLDER.parents[1] / "docs" / "pictures" / "gallery" / f"{path.stem}.png").stat().st_size > 10_000
