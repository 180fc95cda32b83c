"""What the benchmarks share: the build they run, and the machine and the date of a measurement."""
import argparse
import datetime
import os
import pathlib
import re


def cpuinfo(key):
    found = re.search(rf"^{key}\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    return found.group(1) if found else "?"


def simd():
    """Returns the widest SIMD that GROMACS could be built for on this machine, by GROMACS's name."""
    flags = cpuinfo("flags").split()
    for flag, name in (("avx512f", "AVX_512"), ("avx2", "AVX2_256"), ("avx", "AVX_256"), ("sse4_1", "SSE4.1")):
        if flag in flags:
            return name
    return "None"


def describe():
    return (f"{datetime.date.today()}; {cpuinfo('model name')} (family {cpuinfo('cpu family')} model {cpuinfo('model')}), "
            f"{simd()}, {os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")


def argument_parser(page):
    """Returns a parser of arguments whose help is the page, with the option --build."""
    parser = argparse.ArgumentParser(description=page, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "build")
    return parser
