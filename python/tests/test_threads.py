"""How many threads compute, and that nobody else's do: other libraries' OpenMP, other simulations, other threads."""

import ctypes
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

import taut

WATER = {"build.molecules": 600, "run.log_every": 5, "run.thermostat": "langevin"}


@pytest.fixture
def default():
    """The process's default as it was, whatever a test makes of it."""
    before = taut.threads()
    yield
    taut.use_threads(before)


@pytest.fixture
def openmp():
    """OpenMP's library as the module has it, which other libraries of the process may share."""
    with open("/proc/self/maps") as maps:
        paths = {line.split()[-1] for line in maps if "/libgomp" in line or "/libomp" in line or "/libiomp" in line}
    system = [path for path in paths if "libgomp.so.1" in path or "taut" in path] or sorted(paths)
    if not system:
        pytest.skip("no OpenMP library in this process")
    return ctypes.CDLL(system[0])


def in_thread(work):
    answers = []
    thread = threading.Thread(target=lambda: answers.append(work()))
    thread.start()
    thread.join()
    return answers[0]


def said(program, **environment):
    """What a new process prints where nobody said a number of threads."""
    variables = {name: value for name, value in os.environ.items() if name != "OMP_NUM_THREADS"}
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120,
                          env={**variables, **environment})
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


def test_openmp_of_the_host_keeps_its_threads(openmp, default):
    at_first = openmp.omp_get_max_threads()
    elsewhere = in_thread(openmp.omp_get_max_threads)

    def use_taut():
        openmp.omp_set_num_threads(5)
        seen = []
        taut.threads()
        seen.append(openmp.omp_get_max_threads())
        taut.use_threads(2)
        sim = taut.Simulation("water", set=WATER, threads=3)
        sim.run(5, callback=lambda row: seen.append(openmp.omp_get_max_threads()))
        pickle.loads(pickle.dumps(sim)).run(5)
        seen.append(openmp.omp_get_max_threads())
        taut.chart("pair", methods=["rattle"], panels=["order"], quick=True)
        seen.append(openmp.omp_get_max_threads())
        return set(seen)

    try:
        assert use_taut() == {5}
        assert in_thread(use_taut) == {5}
    finally:
        openmp.omp_set_num_threads(at_first)
    assert in_thread(openmp.omp_get_max_threads) == elsewhere


def test_a_process_has_one_default(default):
    taut.use_threads(2)
    assert in_thread(taut.threads) == 2
    assert in_thread(lambda: taut.Simulation("pair").threads) == 2
    in_thread(lambda: taut.use_threads(3))
    assert taut.threads() == 3


def positions(threads):
    """Where 20 steps lead that Python's threads take in turns."""
    sim = taut.Simulation("water", set=WATER, threads=threads)
    for _ in range(4):
        in_thread(lambda: sim.run(5))
    return sim.positions.copy()


def test_simulations_side_by_side_have_their_own_bits(default):
    taut.use_threads(1)
    alone = {threads: positions(threads) for threads in (1, 2)}
    assert not np.array_equal(alone[1], alone[2])
    taut.use_threads(2)
    assert np.array_equal(positions(None), alone[2])
    taut.use_threads(3)
    beside = {}
    threads = [threading.Thread(target=lambda n=n: beside.update({n: positions(n)})) for n in (1, 2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for n in (1, 2):
        assert np.array_equal(beside[n], alone[n])


def test_goes_on_with_as_many_as_it_had(default, tmp_path):
    sim = taut.Simulation("water", set=WATER, threads=2, out=tmp_path / "run")
    sim.run(10)
    copy = pickle.loads(pickle.dumps(sim))
    assert copy.threads == 2
    sim.run(10)
    copy.run(10)
    assert np.array_equal(copy.positions, sim.positions)
    assert taut.Simulation.resume(sim.checkpoint(), threads=3).threads == 3
    file = tmp_path / "checkpoint"
    sim.checkpoint(file)
    resume = f"import taut; kept = open({str(file)!r}, 'rb').read(); "
    tells = "print(taut.Simulation.resume(kept).threads, taut.threads())"
    assert said(resume + tells) == ["2", "1"]
    assert said(resume + tells, OMP_NUM_THREADS="3") == ["3", "3"]
    assert said(resume + "taut.use_threads(4); " + tells, OMP_NUM_THREADS="3") == ["4", "4"]
    del sim, copy  # who holds the folder
    folder = f"import taut; print(taut.Simulation.resume({str(tmp_path / 'run')!r}, threads=3).threads)"
    assert said(folder, OMP_NUM_THREADS="2") == ["3"]


def test_omp_num_threads():
    tells = "import taut; print(taut.threads(), taut.Simulation('pair').threads)"
    assert said(tells) == ["1", "1"]
    assert said(tells, OMP_NUM_THREADS="2,1") == ["2", "2"]
    assert said(tells, OMP_NUM_THREADS="") == ["1", "1"]
    refused = """
import taut
for asks in (taut.threads, lambda: taut.Simulation("pair")):
    try:
        asks()
    except taut.InputError as error:
        print(str(error).replace(" ", "_"))
print(taut.Simulation("pair", threads=2).threads)
"""
    words = "OMP_NUM_THREADS=two:_expected_a_whole_number_from_1_to_1024"
    assert said(refused, OMP_NUM_THREADS="two") == [words, words, "2"]


@pytest.mark.parametrize("threads", [0, -1, 1025])
def test_numbers_that_cannot_be_had(threads):
    words = f"expected 1 to 1024 threads, got {threads}"
    with pytest.raises(taut.InputError, match="use_threads: " + words):
        taut.use_threads(threads)
    with pytest.raises(taut.InputError, match="threads: " + words):
        taut.Simulation("pair", threads=threads)
    with pytest.raises(taut.InputError, match="threads: " + words):
        taut.Simulation.resume(taut.Simulation("pair").checkpoint(), threads=threads)
