import gc
import os
import pickle
import subprocess
import sys
import threading

import numpy as np
import pytest

import taut


@pytest.mark.parametrize("arguments, words", [
    (("watre",), 'watre: no such file, and no scene of that name; did you mean "water"'),
    ((7,), r"expected a scene's name, its file, a dict, or \(system, positions\) of OpenMM's, got 7"),
    (({"build": {"kind": "chain"}},), "scene.toml:.*build.kind"),
    (({"build": {"kind": object()}},), "build.kind: expected a number, a text"),
    (({"build": {"kind": "chains", "chains": -1, "beads": 5}, "run": {}},), "build.chains"),
    (({"biuld": {}},), "build"),
])
def test_scenes(arguments, words):
    with pytest.raises(taut.InputError, match=words):
        taut.Simulation(*arguments)


@pytest.mark.parametrize("named, words", [
    ({"method": "ratle"}, 'did you mean "rattle"'),
    ({"method": 3}, "method: expected a name"),
    ({"dt_fs": -1}, "run.dt_fs"),
    ({"dt_fs": float("nan")}, "run.dt_fs"),
    ({"set": {"run.sedd": 1}}, "did you mean \"seed\""),
    ({"set": {"run.dt_fs": "fast"}}, "run.dt_fs"),
    ({"set": {"run.dt_fs": None, "run.seed": []}}, "run.seed"),
    ({"set": {5: 1}}, "expected a scene's keys"),
    ({"set": [("run.seed", 1)]}, "set: expected a dict"),
    ({"set": {"method.name": "shake"}, "method": "rattle"}, "said twice"),
    ({"set": {"run.trajectory_every": 10}}, "trajectory_every: nowhere to write"),
    ({"threads": "2"}, "threads: expected a whole number, got '2'"),
    ({"threads": 1.5}, "threads: expected a whole number, got 1.5"),
    ({"forces": taut.Force()}, "forces: expected a list"),
    ({"biases": taut.Distance}, "biases: expected a list"),
])
def test_settings(named, words):
    with pytest.raises(taut.InputError, match=words):
        taut.Simulation("chain", **named)


@pytest.mark.parametrize("made, words", [
    (lambda: taut.Rattle(tolerance=1), "method.tolerance: expected .*at most 0.1, got 1"),
    (lambda: taut.Rattle(tolerance="small"), "method.tolerance: expected a number, got a string"),
    (lambda: taut.Baumgarte(gains="ded-beat"), 'method.gains: there is no "ded-beat"; did you mean "dead-beat"'),
    (lambda: taut.Baumgarte(gains="ratle"), 'method.gains: there is no "ratle"; did you mean "rattle"'),
    (lambda: taut.Baumgarte(reduction=0.5), "method.reduction: "),
])
def test_options_of_methods_are_refused_at_once(made, words):
    with pytest.raises(taut.InputError, match=words):
        made()
    assert taut.Baumgarte(gains="dead-beat").settings() == {"method.name": "baumgarte", "method.gains": "dead-beat"}


def test_values_of_numpy_are_values():
    sim = taut.Simulation("freely_jointed", dt_fs=np.float32(2), set={"run.seed": np.int64(3),
                                                                      "build.chains": np.uint8(2)})
    assert sim.dt_fs == 2 and len(sim.masses) > 2


@pytest.mark.parametrize("call, words", [
    *((lambda sim, steps=steps: sim.run(steps), "expected 1") for steps in (0, -5, 2**51)),
    (lambda sim: sim.run(10, every=-1), "expected 1"),
    (lambda sim: sim.step(0), r"step\(0\): expected 1"),
    (lambda sim: sim.minimise("far"), r"minimise: expected a number \[kJ/mol/nm\], got 'far'"),
])
def test_arguments_are_refused_in_our_words(call, words):
    with pytest.raises(taut.InputError, match=words):
        call(taut.Simulation("chain"))


def test_a_callback_that_cannot_be_called():
    with pytest.raises(TypeError):
        taut.Simulation("chain").run(10, callback=7)


def test_what_is_written_to_views():
    sim = taut.Simulation("chain")
    before = sim.positions.copy()
    for wrong in (np.zeros((2, 3)), "text", np.zeros(7)):
        with pytest.raises((ValueError, TypeError)):
            sim.positions[:] = wrong
    sim.positions[::2, ::-1][:] = before[::2, ::-1].astype(np.float32)  # neither contiguous nor of its type
    sim.positions[:] = before
    sim.positions[1, 2] = np.nan
    for asks in (lambda: sim.run(1), lambda: sim.energies, sim.checkpoint, lambda: sim.minimise()):
        with pytest.raises(taut.InputError, match=r"positions\[1\]: .*nan was written there, expected finite"):
            asks()
    sim.positions[:] = before
    sim.run(1)


def test_what_no_bonds_can_follow_is_put_back():
    sim = taut.Simulation("chain")
    before = sim.positions.copy()
    sim.positions[:] = 0
    with pytest.raises(taut.SimulationFailure, match="the start"):
        sim.run(1)
    assert np.allclose(sim.positions, before)
    sim.run(1)


@pytest.fixture(scope="module")
def water():
    sim = taut.Simulation("water", set={"build.molecules": 27, "forcefield.cutoff_nm": 0.45,
                                        "forcefield.switch_nm": 0.4})
    return sim.to_openmm_xml()[0], sim.positions, sim.box


@pytest.mark.parametrize("spoil, words", [
    (lambda x: x[:, :2], r"positions: expected n rows of three numbers \[nm\], got shape \(81, 2\)"),
    (lambda x: x[:5], "5|81"),
    (lambda x: x.astype(str), "positions: .*got dtype <U"),
    (lambda x: x.astype(complex), "positions: .*got dtype complex128"),
    (lambda x: x > 0, "positions: .*got dtype bool"),
    (lambda x: np.full(x.shape, None), "positions: expected n rows of three numbers"),
    (lambda x: [[1, 2, 3], [1, 2]], "positions: expected n rows of three numbers"),
    (lambda x: np.where(x == x.max(), np.inf, x), "positions: expected finite numbers"),
    (lambda x: None, "positions: expected n rows of three numbers"),
])
def test_positions_that_are_none(water, spoil, words):
    system, x, box = water
    with pytest.raises(taut.InputError, match=words):
        taut.Simulation.from_openmm(system, spoil(x), box=box, dt_fs=1)


@pytest.mark.parametrize("box, words", [
    ([2, 2], "box: expected 3 rows"), (np.full((3, 3), np.nan), "box: expected finite"), ("2", "box: expected 3 rows"),
    (np.zeros((3, 3)), "box"), (-2 * np.eye(3), "box"), ([[2, 1.5, 0], [0, 2, 0], [0, 0, 2]], "box"),
    ([0.5] * 3, "cutoff"), (2.0, "box: expected three vectors or three edges"), ([2, 2, None], "box: expected 3 rows"),
])
def test_boxes_that_are_none(water, box, words):
    with pytest.raises(taut.InputError, match=words):
        taut.Simulation.from_openmm(water[0], water[1], box=box, dt_fs=1)


@pytest.mark.parametrize("edges", [(2, 2, 2), np.array([2, 2, 2]), np.full(3, 2, np.float32), 2 * np.eye(3), None])
def test_a_box_of_any_type(water, edges):
    system, x, box = water
    found = taut.Simulation.from_openmm(system, x, box=edges, dt_fs=1).box
    assert np.array_equal(found, box if edges is None else 2 * np.eye(3))


def test_positions_of_any_layout_and_precision(water):
    system, x, box = water
    first, *others = (taut.Simulation.from_openmm(system, given, box=box, dt_fs=1).positions for given in (
        x, x.tolist(), np.asfortranarray(x), np.repeat(x, 2, axis=0)[::2], x[::-1][::-1], x.astype(">f8")))
    assert all(np.array_equal(first, other) for other in others)
    single = taut.Simulation.from_openmm(system, x.astype(np.float32), box=box.tolist(), dt_fs=1).positions
    assert 0 < abs(first - single).max() < 1e-6


def test_failures_say_what_they_know():
    sim = taut.Simulation("freely_jointed", method="newton", dt_fs=10)
    sim.run(10)
    sim.velocities[:] *= 60
    with pytest.raises(taut.SimulationFailure) as failed:
        sim.run(5000)
    error = failed.value
    assert error.step == sim.steps_taken + 1 and error.cause and error.advice in str(error)
    assert error.bond >= 0 and len(error.atoms) == 2 and error.target_nm > 0 and error.length_before_nm > 0
    assert np.array_equal(error.positions, sim.positions) and np.array_equal(error.velocities, sim.velocities)
    assert abs(sim.bond_errors).max() < 1e-6
    assert isinstance(error, RuntimeError) and isinstance(taut.InputError("x"), ValueError)


def test_folders(tmp_path, capfd):
    taut.Simulation("chain", out=tmp_path / "run").run(2)
    gc.collect()
    with pytest.raises(taut.InputError, match="holds a run .*overwrite=True"):
        taut.Simulation("chain", out=tmp_path / "run")
    again = taut.Simulation("chain", out=tmp_path / "run", overwrite=True)
    assert again.notes[-1].endswith(f"what was there is kept in {tmp_path.resolve()}/run.1")
    again.run(2)
    assert capfd.readouterr() == ("", "")
    assert (tmp_path / "run.1" / "log.csv").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError):
        taut.Simulation("chain", out=tmp_path / "file" / "run")
    with pytest.raises(taut.InputError, match="out: expected a folder, got an empty name"):
        taut.Simulation("chain", out="")
    with pytest.raises(taut.InputError, match="there is none"):
        taut.Simulation.resume(tmp_path / "nowhere")
    with pytest.raises(taut.InputError, match="not a checkpoint"):
        taut.Simulation.resume(b"junk")
    with pytest.raises(taut.InputError, match="cannot change in a run that has begun"):
        taut.Simulation.resume(taut.Simulation("chain").checkpoint(), set={"run.seed": 1})


def test_only_one_runs_it():
    sim = taut.Simulation("double_pendulum")

    def again(row):
        with pytest.raises(RuntimeError, match="it is running"):
            sim.run(1)

    sim.run(10, every=5, callback=again)
    thread = threading.Thread(target=sim.run, args=(10_000_000,), kwargs={
        "every": 1000, "callback": lambda row: not done.wait(0)})
    done = threading.Event()
    thread.start()
    refused = 0
    while not refused:
        try:
            sim.run(1)
        except RuntimeError:
            refused += 1
    done.set()
    thread.join()
    assert refused == 1


def written_to(sim):
    sim.velocities[:] = 0
    return sim.energies


@pytest.mark.parametrize("asks", [lambda sim: sim.run(1), lambda sim: sim.minimise(), written_to],
                         ids=["run", "minimise", "written to"])
def test_a_fork_cannot_go_on_with_it(asks):
    sim = taut.Simulation("chain")
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            looks = sim.energies["total"] + sim.positions.sum() + sim.tensions.sum() + len(sim.checkpoint())
            asks(sim)
            os.write(write, b"ran")
        except RuntimeError as error:
            taut.Simulation("chain").run(5)
            os.write(write, f"{error} {np.isfinite(looks)}".encode())
        os._exit(0)
    os.close(write)
    said = os.read(read, 1000)
    assert b"made in another process" in said and said.endswith(b"True")
    assert os.waitpid(child, 0)[1] == 0


def test_a_fork_of_threads_says_so_and_does_not_hang():
    program = """
import os, taut
taut.use_threads(2)
sim = taut.Simulation("water", set={"build.molecules": 216})
sim.run(5)
if os.fork() == 0:
    looks = sim.energies, sim.tensions, sim.pressure, len(sim.checkpoint()), sim.to_openmm_xml()
    sim.velocities[:] = 0
    try:
        sim.energies
    except RuntimeError as error:
        print(error, flush=True)
    os._exit(0)
os.wait()
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    assert "made in another process" in done.stdout, done.stderr


def test_pickles():
    row = []
    sim = taut.Simulation("chain")
    sim.run(1, every=1, callback=row.append)
    with pytest.raises(TypeError, match="pickle"):
        pickle.dumps(row[0])
    error = taut.InputError("words")
    assert str(pickle.loads(pickle.dumps(error))) == "words"
    assert pickle.loads(pickle.dumps(taut.Rattle(tolerance=1e-6))) == taut.Rattle(tolerance=1e-6)


def test_made_without_init():
    half = taut.Simulation.__new__(taut.Simulation)
    for asks in (lambda: half.run(1), lambda: half.positions, lambda: repr(half), lambda: pickle.dumps(half)):
        with pytest.raises(AttributeError):
            asks()
