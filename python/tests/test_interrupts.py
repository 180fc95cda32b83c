"""Ctrl-C during long calls, each in a process of its own."""

import os
import signal
import subprocess
import sys
import time

import pytest

CALLS = {
    "construction": 'taut.Simulation("water", set={"build.molecules": 1000, "run.minimise": True, '
                    '"run.minimise_force_kj_mol_nm": 1e-9})',
    "minimise": 'taut.Simulation("water", set={"build.molecules": 2000}).minimise(1e-9, steps=10**8)',
    "run": 'taut.Simulation("water").run(10**8)',
    "chart": 'taut.chart("chain")',
    "chart of large systems": 'taut.chart("water", set={"build.molecules": 2000})',
    "stability": 'taut.stability("water", ["rattle"], plane=False, steps=10**5)',
    "calibrate": '[taut.calibrate("water") for _ in range(100)]',
    "crosscheck": 'taut.crosscheck("water")',
}
PROGRAM = """
import taut
print("begun", flush=True)
try:
    {}
except KeyboardInterrupt:
    print("interrupted")
"""


def processor_seconds(process):
    """What a running process has used so far."""
    with open(f"/proc/{process}/stat") as stat:
        return sum(map(int, stat.read().rpartition(")")[2].split()[11:13])) / os.sysconf("SC_CLK_TCK")


# Of the processor's time, which other work on the machine does not lengthen. It includes that Python ends.
@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="needs Linux's /proc")
@pytest.mark.parametrize("call", CALLS)
def test_ctrl_c_ends_it_within_half_a_second(call):
    with subprocess.Popen([sys.executable, "-c", PROGRAM.format(CALLS[call])], stdout=subprocess.PIPE, text=True,
                          env={**os.environ, "OMP_NUM_THREADS": "1"}) as child:
        assert child.stdout.readline() == "begun\n"
        while processor_seconds(child.pid) < 1.5 and child.poll() is None:  # some of it is Python's own start
            time.sleep(0.02)
        before = processor_seconds(child.pid)
        child.send_signal(signal.SIGINT)
        said = child.stdout.read()
        used = os.wait4(child.pid, 0)[2]
        child.returncode = 0
    assert said == "interrupted\n"
    assert used.ru_utime + used.ru_stime - before < 0.5
