"""What the tests share. They need pytest and numpy; what needs more skips, with a reason."""

import os

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy: small matrices alone
from pathlib import Path

import pytest

import taut


@pytest.fixture(scope="session")
def command():
    """The command `taut` of the same build."""
    path = os.environ.get("TAUT_COMMAND") or str(Path(taut._core.__file__).parents[2] / "taut")
    if not os.access(path, os.X_OK):
        pytest.skip("the command taut is not here: TAUT_COMMAND names it")
    return path


@pytest.fixture(scope="session")
def data():
    """The test data of the sources: systems as OpenMM writes them."""
    return Path(__file__).resolve().parents[2] / "tests" / "data"
