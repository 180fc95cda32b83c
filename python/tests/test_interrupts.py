"""Ctrl-C during long calls, each in a process of its own."""

import json
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
import signal
import taut
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
print("begun", flush=True)
try:
    {}
except KeyboardInterrupt:
    print("interrupted")
except taut.InputError as error:
    print(error)  # of a build without OpenMM
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
        if child.poll() is not None and "without OpenMM" in (said := child.stdout.readline()):
            pytest.skip(said.strip())
        before = processor_seconds(child.pid)
        child.send_signal(signal.SIGINT)
        said = child.stdout.read()
        used = os.wait4(child.pid, 0)[2]
        child.returncode = 0
    assert said == "interrupted\n"
    assert used.ru_utime + used.ru_stime - before < 0.5


# A clock of the processor's time rings every 10 ms, and is heard where Ctrl-C would be.
LISTENING = """
import json, signal, sys, time
import taut
{}
heard = [time.process_time()]
signal.signal(signal.SIGPROF, lambda *_: heard.append(time.process_time()))
signal.setitimer(signal.ITIMER_PROF, 0.01, 0.01)
{}
signal.setitimer(signal.ITIMER_PROF, 0)
heard.append(time.process_time())
print(json.dumps([heard[-1] - heard[0], max(b - a for a, b in zip(heard, heard[1:]))]))
"""
LARGE = 'taut.Simulation("water", set={"build.molecules": 30000}, threads=1)'
READING = {
    "building": ("", LARGE),
    "OpenMM's files": (f"files = {LARGE}.to_openmm_xml()", "taut.Simulation.from_openmm(*files, threads=1)"),
    "minimising": (f"sim = {LARGE}", "sim.minimise(1, steps=3)"),
    "another temperature": (f"sim = taut.Simulation.from_openmm(*{LARGE}.to_openmm_xml(), set={{'run.temperature_k': 300, "
                            "'run.thermostat': 'langevin'})", "sim.set_temperature(310)"),
}


# 90,000 atoms: a machine that is busy takes twice as long for what an idle one does.
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="needs a clock of the processor's time")
@pytest.mark.parametrize("call", READING)
def test_a_large_system_is_read_and_made_within_earshot(call):
    done = subprocess.run([sys.executable, "-c", LISTENING.format(*READING[call])], check=True, capture_output=True, text=True)
    took, deaf = json.loads(done.stdout)
    assert deaf < min(0.5, took / 2)
