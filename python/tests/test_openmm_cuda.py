"""The plug-in's kernels, compiled for CUDA by the compiler and with the definitions that OpenMM uses. None is run."""

import sys
from pathlib import Path

import pytest

pytest.importorskip("openmm", reason="needs OpenMM from PyPI: pip install openmm[cuda13]")
sys.path.insert(0, str(Path(__file__).parents[2] / "openmm_plugin"))
import compile_for_cuda  # noqa: E402

try:
    compile_for_cuda.compiler(), compile_for_cuda.of_openmm()
except SystemExit as missing:
    pytest.skip(str(missing), allow_module_level=True)


@pytest.mark.parametrize("kernel", ["drift", "free atom", "water", "CH3, ", "group of 256"])
def test_compiles_and_stays_in_registers(kernel):
    rows = list(compile_for_cuda.table(["sm_80"], only=kernel))
    assert len(rows) == (3 if kernel == "drift" else 12)  # of methods, with a thermostat or not, and precisions
    for name, precision, architecture, registers, stack, spilled in rows:
        assert (stack, spilled) == (0, 0), f"{name}, {precision}: {stack} bytes of stack, {spilled} spilled"


def test_refuses_what_is_no_cuda():
    with pytest.raises(ValueError, match="identifier .nonsense. is undefined"):
        compile_for_cuda.compile_text(compile_for_cuda.compiler(), "__global__ void f() { nonsense; }", "sm_80")
