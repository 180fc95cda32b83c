#!/usr/bin/env python3
"""Compiles the plug-in's kernels for CUDA as OpenMM does, and says what each thread needs. It needs no GPU.

    python openmm_plugin/compile_for_cuda.py [sm_80 sm_90 …]

It needs openmm[cuda13] of PyPI (or cuda12) in this Python: the text that OpenMM puts before a kernel is read from its
library for CUDA, and the compiler is the one that OpenMM calls, NVRTC. The column `stack` are the bytes of a thread
that lie in memory instead of registers.
"""
import ctypes
import re
import sys
from pathlib import Path

import openmm

FOLDER = Path(__file__).parent
SITE = Path(openmm.__file__).parents[1]
LAW = {"TOLERANCE": "(mixed) 1e-10", "MOST_SOLVES": "2"}
SHAPES = {  # its bonds
    "free atom": [],
    "OH": [(0, 1)],
    "water": [(0, 1), (0, 2), (1, 2)],
    "CH3": [(0, 1), (0, 2), (0, 3)],
    "cholesterol": [(0, 1), (0, 2), (1, 2), (1, 3), (2, 3)],
    "CH3 with angles": [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)],
    "chain of 8": [(k, k + 1) for k in range(8)],
    "chain of 12": [(k, k + 1) for k in range(12)],
    "group of 256": None,
}


def compiler():
    """NVRTC. It opens its builtins by their name alone, and some versions do not look beside themselves."""
    for path in SITE.glob("nvidia/**/libnvrtc-builtins.so.*"):
        ctypes.CDLL(str(path))
    for path in sorted(SITE.glob("nvidia/**/libnvrtc.so.*")):
        return ctypes.CDLL(str(path))
    sys.exit("needs NVRTC: pip install openmm[cuda13]")


def of_openmm():
    """OpenMM's definitions for CUDA, and its operations on vectors: texts in its library, which end with a zero."""
    library = SITE / "OpenMM.libs/lib/plugins/libOpenMMCUDA.so"
    if not library.exists():
        sys.exit("needs OpenMM's platform CUDA: pip install openmm[cuda13]")
    data = library.read_bytes()
    texts = []
    for said in (b"This file contains CUDA definitions for the macros", b"This file defines vector operations"):
        begin = data.rindex(b"/**", 0, data.index(said))
        texts.append(data[begin:data.index(b"\0", begin)].decode())
    return texts


def sources():
    """The raw strings of the kernels, by their names."""
    text = "".join((FOLDER / name).read_text() for name in ("device_kernels.cpp", "group_kernel.cpp"))
    return dict(re.findall(r'const char\* const (\w+) = R"\((.*?)\)";', text, re.S))


def before_a_kernel(precision, common):
    """What CudaContext::createModule() writes, as far as the kernels use it."""
    real = "double" if precision == "double" else "float"
    mixed = "float" if precision == "single" else "double"
    lines = [f"#define USE_{precision.upper()}_PRECISION 1"] if precision != "single" else []
    for name, number in (("real", real), ("mixed", mixed)):
        lines += [f"#define make_{name}{n} make_{number}{n}" for n in (2, 3, 4)]
        lines += [f"typedef {number}{n} {name}{n};" for n in ("", 2, 3, 4)]
    return "\n".join(lines) + "\n" + common


def compile_text(nvrtc, text, architecture):
    """Returns registers, stack and spills; raises ValueError with the compiler's words."""
    program, size = ctypes.c_void_p(), ctypes.c_size_t()
    nvrtc.nvrtcCreateProgram(ctypes.byref(program), text.encode(), None, 0, None, None)
    options = [f"-arch={architecture}", "--use_fast_math", "--ptxas-options=-v"]
    failed = nvrtc.nvrtcCompileProgram(program, len(options),
                                       (ctypes.c_char_p * len(options))(*(option.encode() for option in options)))
    nvrtc.nvrtcGetProgramLogSize(program, ctypes.byref(size))
    log = ctypes.create_string_buffer(size.value)
    nvrtc.nvrtcGetProgramLog(program, log)
    nvrtc.nvrtcDestroyProgram(ctypes.byref(program))
    said = log.value.decode()
    if failed:
        raise ValueError(said)
    return [int(re.search(pattern, said)[1]) for pattern in
            (r"Used (\d+) registers", r"(\d+) bytes stack frame", r"(\d+) bytes spill stores")]


def kernels():
    """Yields what each kernel is called, its text and its definitions."""
    text = sources()
    yield "drift", text["kDriftSource"], {"LANGEVIN": "1"}
    for name, bonds in SHAPES.items():
        for bath in ({}, {"LANGEVIN": "1"}):
            if bonds is None:
                source, shape = "kGroupSource", {"GROUP": "256"}
            else:
                source = "kHoldSource"
                first, second = (", ".join(str(bond[end]) for bond in bonds) for end in (0, 1))
                atoms = 1 + max((max(bond) for bond in bonds), default=0)
                shape = {"ATOMS": str(atoms), "BONDS": str(len(bonds)), "FIRST": first, "SECOND": second}
            yield (f"{name}{', Langevin' if bath else ''}", text["kLawSource"] + text[source],
                   {**LAW, **bath, **shape})


def table(architectures, precisions=("single", "mixed", "double"), only=""):
    """Yields a row for each kernel, precision and architecture."""
    nvrtc, (common, vectors) = compiler(), of_openmm()
    for name, text, defines in kernels():
        if only not in name:
            continue
        for precision in precisions:
            tiny = {"SMALLEST_PIVOT": "1e-6f" if precision == "single" else "1e-12"}
            whole = before_a_kernel(precision, common)
            whole += "".join(f"#define {key} {word}\n" for key, word in {**defines, **tiny}.items())
            for architecture in architectures:
                yield [name, precision, architecture, *compile_text(nvrtc, whole + vectors + text, architecture)]


if __name__ == "__main__":
    print("kernel;precision;architecture;registers;stack;spilled")
    for row in table(sys.argv[1:] or ["sm_80", "sm_90"]):
        print(*row, sep=";", flush=True)
