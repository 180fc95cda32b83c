"""Reporters: files of frames and rows, functions, and OpenMM's own reporters."""

import csv

import numpy as np
import pytest

import taut

SET = {"build.molecules": 64, "forcefield.cutoff_nm": 0.55, "forcefield.switch_nm": 0.5, "run.seed": 3}


def water(**more):
    return taut.Simulation("water", set={**SET, **more})


def test_functions_are_called_at_multiples_and_can_stop():
    seen = []
    with water() as sim:
        sim.reporters.append(taut.Call(lambda sim: seen.append((sim.steps_taken, sim.temperature)), every=7))
        sim.run(20)
        sim.run(10)
        assert [step for step, _ in seen] == [7, 14, 21, 28] and len(set(seen)) == 4
        sim.reporters.append(taut.Call(lambda sim: sim.steps_taken < 40, every=5))
        sim.run(100)
        assert sim.steps_taken == 40


def test_reporters_report_in_single_steps_too():
    seen = []
    with water() as sim:
        sim.reporters.append(taut.Call(lambda sim: seen.append(sim.steps_taken), every=3))
        for _ in range(4):
            sim.step()
        sim.step(5)
        assert seen == [3, 6, 9] and sim.steps_taken == 9
        sim.reporters.append(taut.Call(lambda sim: sim.steps_taken < 12, every=3))
        sim.step(10)
        assert sim.steps_taken == 12


def test_an_xtc_file_needs_one_universe(tmp_path, monkeypatch):
    MDAnalysis = pytest.importorskip("MDAnalysis")
    made, empty = [], MDAnalysis.Universe.empty
    monkeypatch.setattr(MDAnalysis.Universe, "empty", lambda *a, **b: made.append(1) or empty(*a, **b))
    with water(**{"run.thermostat": "rescaling", "run.thermostat_ps": 0.1, "run.barostat": "c-rescale",
                  "run.pressure_bar": 1000}) as sim:
        boxes = []
        sim.reporters.append(taut.XTC(tmp_path / "x.xtc", every=10))
        sim.reporters.append(taut.Call(lambda sim: boxes.append(10 * sim.box[0, 0]), every=10))
        sim.run(30)
    assert len(made) == 1
    read = MDAnalysis.Universe.empty(192, trajectory=True)
    read.load_new(str(tmp_path / "x.xtc"))
    assert np.allclose([frame.dimensions[0] for frame in read.trajectory], boxes, atol=1e-3) and np.ptp(boxes) > 1e-3


def test_reporting_changes_no_bit():
    plain, watched = water(), water()
    watched.reporters.append(taut.Call(lambda sim: sim.energies, every=3))
    for sim in (plain, watched):
        sim.run(20)
    assert np.array_equal(plain.positions, watched.positions)


def test_an_exception_stops_the_run_between_two_steps():
    with water() as sim:
        def fail(sim):
            raise KeyError("mine")

        sim.reporters.append(taut.Call(fail, every=5))
        with pytest.raises(KeyError, match="mine"):
            sim.run(20)
        assert sim.steps_taken == 5
        sim.reporters.clear()
        sim.run(15)
        other = water()
        other.run(20)
        assert np.array_equal(sim.positions, other.positions)


def test_rows_are_written(tmp_path):
    with water() as sim:
        sim.reporters.append(taut.CSV(tmp_path / "log.csv", every=5, columns=["step", "time_ps", "total_kj_mol"]))
        sim.run(15, every=5)
        rows = list(csv.DictReader(open(tmp_path / "log.csv")))
        assert [int(row["step"]) for row in rows] == [5, 10, 15]
        assert [float(row["total_kj_mol"]) for row in rows] == sim.log["total_kj_mol"][1:].tolist()


def test_rows_have_what_the_scene_adds_to_the_log(tmp_path):
    arm = taut.Distance([0], [10], at_nm=0.5, k_kj_mol_nm2=10., name="arm")
    with taut.Simulation("water", set=SET, biases=[arm]) as sim:
        sim.reporters.append(taut.CSV(tmp_path / "some.csv", every=5, columns=["step", "bias_arm_nm", "pressure_xx_bar"]))
        sim.reporters.append(taut.CSV(tmp_path / "all.csv", every=5))
        rows = []
        sim.run(15, every=5, callback=rows.append)
        log = sim.log
    some, every = (list(csv.DictReader(open(tmp_path / name))) for name in ("some.csv", "all.csv"))
    assert list(every[0]) == list(log)
    for name in ("bias_arm_nm", "pressure_xx_bar"):
        assert [float(row[name]) for row in some] == log[name][1:].tolist() == [getattr(r, name) for r in rows[1:]]
    for name in ("bias_arm_force_kj_mol_nm", "volume_nm3", "heat_kj_mol", "potential_kj_mol"):
        assert np.array_equal([float(row[name]) for row in every], log[name][1:], equal_nan=True)


def test_a_column_that_the_simulation_lacks_is_refused_before_the_first_step(tmp_path):
    with water() as sim:
        sim.reporters.append(taut.CSV(tmp_path / "x.csv", columns=["temprature_k"]))
        with pytest.raises(taut.InputError, match="no 'temprature_k'.*did you mean"):
            sim.run(5)
        assert sim.steps_taken == 0


@pytest.mark.parametrize("kind", ["DCD", "H5MD", "XTC"])
@pytest.mark.parametrize("atoms", [None, [0, 1, 2, 30, 31]])
def test_frames_are_read_by_others(tmp_path, kind, atoms):
    MDAnalysis = pytest.importorskip("MDAnalysis")
    if kind == "H5MD":
        pytest.importorskip("h5py")
    path = tmp_path / f"x.{kind.lower()}"
    kept = []
    with water() as sim:
        sim.reporters.append(getattr(taut, kind)(path, every=10, atoms=atoms))
        sim.reporters.append(taut.Call(lambda sim: kept.append(sim.positions.copy()), every=10))
        sim.run(30)
        count = len(sim.masses) if atoms is None else len(atoms)
        dt_ps = 10 * sim.dt_fs / 1000
    read = MDAnalysis.Universe.empty(count, trajectory=True)
    read.load_new(str(path))
    assert len(read.trajectory) == 3
    times = [frame.time for frame in read.trajectory]
    assert np.allclose(np.diff(times), dt_ps, rtol=1e-5)
    for frame, positions in zip(read.trajectory, kept):
        expected = positions if atoms is None else positions[atoms]
        assert np.allclose(frame.positions, 10 * expected, atol=0.006 if kind == "XTC" else 1e-4)


def test_a_file_of_some_atoms_has_their_bonds_and_tensions(tmp_path):
    h5py = pytest.importorskip("h5py")
    with water() as sim:
        sim.reporters.append(taut.H5MD(tmp_path / "x.h5", every=5, atoms=[3, 4, 5, 9]))
        sim.run(5)
        tensions, bonds = sim.tensions.copy(), sim.bonds
    of = [k for k, (i, j) in enumerate(bonds) if {i, j} <= {3, 4, 5}]
    with h5py.File(tmp_path / "x.h5") as file:
        assert sorted(file["connectivity/bonds"][:].tolist()) == sorted((bonds[of] - 3).tolist())
        assert np.allclose(file["observables/tension/value"][0], tensions[of])


def test_openmms_reporters(tmp_path):
    app = pytest.importorskip("openmm.app")
    MDAnalysis = pytest.importorskip("MDAnalysis")
    with water() as sim:
        sim.reporters.append(app.StateDataReporter(str(tmp_path / "log.txt"), 5, step=True, potentialEnergy=True,
                                                   temperature=True, volume=True, density=True))
        sim.reporters.append(app.DCDReporter(str(tmp_path / "x.dcd"), 10, enforcePeriodicBox=False))
        sim.reporters.append(app.PDBReporter(str(tmp_path / "x.pdb"), 20))
        sim.run(20, every=5)
        rows = list(csv.DictReader(open(tmp_path / "log.txt")))
        assert [int(row['#"Step"']) for row in rows] == [5, 10, 15, 20]
        energies = [float(row["Potential Energy (kJ/mole)"]) for row in rows]
        assert np.allclose(energies, sim.log["potential_kj_mol"][1:])
        temperatures = [float(row["Temperature (K)"]) for row in rows]
        assert np.allclose(temperatures, sim.log["temperature_k"][1:], rtol=1e-3)
        sim.reporters.clear()  # which closes OpenMM's file
    read = MDAnalysis.Universe(str(tmp_path / "x.pdb"), str(tmp_path / "x.dcd"))
    assert len(read.trajectory) == 2 and len(read.atoms) == 192


@pytest.mark.parametrize("make,words", [
    (lambda folder: taut.DCD(folder / "there"), "there is such a file; overwrite=True"),
    (lambda folder: taut.DCD(folder / "none" / "x.dcd"), "there is no folder"),
    (lambda folder: taut.DCD(folder / "x.dcd", every=0), "expected a number of steps"),
    (lambda folder: taut.DCD(folder / "x.dcd", atoms=[]), "atoms: expected indices"),
    (lambda folder: water().reporters.append(3), "is no reporter")])
def test_wrong_reporters_are_refused(tmp_path, make, words):
    (tmp_path / "there").write_text("")
    with pytest.raises(taut.InputError, match=words):
        make(tmp_path)


@pytest.mark.parametrize("atoms", [[0, 0], [192], [-1]])
def test_wrong_atoms_are_refused_when_the_file_begins(tmp_path, atoms):
    with water() as sim:
        sim.reporters.append(taut.DCD(tmp_path / "x.dcd", every=5, atoms=atoms))
        with pytest.raises(taut.InputError, match="atoms: "):
            sim.run(5)
