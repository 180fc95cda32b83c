"""Settings that change between runs, ramps, and logs that stay."""

import copy
import pickle

import numpy as np
import pytest

import taut

SET = {"build.molecules": 64, "forcefield.cutoff_nm": 0.55, "forcefield.switch_nm": 0.5, "run.seed": 3}
BATH = {"run.thermostat": "rescaling", "run.thermostat_ps": 0.01}


def test_changes_are_those_of_resume(tmp_path):
    changed = taut.Simulation("water", set={**SET, **BATH})
    resumed = taut.Simulation("water", set={**SET, **BATH})
    for sim in (changed, resumed):
        sim.run(20)
    settings = {"run.thermostat": "langevin", "run.friction_per_ps": 5.0}
    resumed = taut.Simulation.resume(resumed.checkpoint(), set=settings)
    changed.change(settings)
    assert changed.thermostat == resumed.thermostat == "langevin"
    for sim in (changed, resumed):
        sim.run(20)
    assert np.array_equal(changed.positions, resumed.positions)


def test_ensembles_are_assigned():
    with taut.Simulation("water", set={**SET, **BATH}) as sim:
        volume = np.linalg.det(sim.box)
        sim.run(10)
        sim.barostat = {"barostat": "c-rescale", "pressure_bar": 2000}
        assert sim.barostat == "c-rescale"
        sim.run(50)
        assert np.linalg.det(sim.box) != volume
        sim.barostat = "none"
        sim.thermostat = None
        assert (sim.barostat, sim.thermostat) == ("none", "none")
        with pytest.raises(taut.InputError, match="no thermostat"):
            sim.set_temperature(300)


def test_the_step_changes_between_runs(tmp_path):
    with taut.Simulation("water", dt_fs=2, set={**SET, **BATH}, out=tmp_path / "run") as sim:
        sim.run(10, every=5)
        positions = sim.positions
        sim.dt_fs = 0.5
        sim.run(10)
        assert sim.dt_fs == 0.5 and sim.positions is not None and np.shares_memory(sim.positions, positions)
        assert np.allclose(sim.log["time_ps"], [0, 0.01, 0.02, 0.0225, 0.025])
        before, kept = sim.positions.copy(), sim.checkpoint()
    again = taut.Simulation.resume(kept)
    assert again.dt_fs == 0.5 and np.array_equal(again.positions, before)
    with taut.Simulation.resume(tmp_path / "run", set={"run.dt_fs": 1}) as sim:
        assert sim.dt_fs == 1
        sim.run(5)
        assert sim.time_ps == pytest.approx(0.03)


class Nothing(taut.ConstraintMethod):
    """Holds no bond."""

    calls = 0

    def project_positions(self, system, h, state):
        Nothing.calls += 1


def test_the_method_changes_between_runs():
    sim = taut.Simulation("chain", method=taut.Rattle(tolerance=1e-3), set={"run.seed": 1})
    sim.run(20, every=10)
    assert 1e-6 < sim.log["max_rel_bond_error"][-1] < 1e-2
    sim.method = taut.Newton(tolerance=1e-12)
    sim.run(20)
    assert sim.method == "newton" and "1e-12" in sim.setting and sim.log["max_rel_bond_error"][-1] < 1e-9
    sim.method = "feedforward"
    again = taut.Simulation.resume(sim.checkpoint())
    for each in (sim, again):
        each.run(20)
    assert again.method == "feedforward" and np.array_equal(sim.positions, again.positions)
    sim.method = Nothing
    sim.run(3)
    assert Nothing.calls >= 3
    sim.method = taut.Penalty()
    sim.run(3)
    assert sim.method == "penalty"
    with pytest.raises(taut.InputError, match="settle"):
        sim.method = "settle"
    sim.run(3)
    assert sim.method == "penalty"


def test_frames_of_one_file_keep_their_step(tmp_path):
    with taut.Simulation("pair", set={"run.trajectory_every": 2}, out=tmp_path / "run") as sim:
        sim.run(4)
        with pytest.raises(taut.InputError, match="run.dt_fs: the frames written so far are 2 steps"):
            sim.dt_fs = 0.5
    with taut.Simulation("pair") as sim:
        sim.reporters.append(taut.DCD(tmp_path / "x.dcd", every=2))
        sim.dt_fs = 0.5
        sim.run(4)
        with pytest.raises(taut.InputError, match="x.dcd are equally spaced in time"):
            sim.dt_fs = 1


def test_a_step_that_does_not_resolve_a_spring_is_warned_of():
    with taut.Simulation("decane", dt_fs=2) as sim:
        assert not any("does not resolve" in note for note in sim.notes)
        with pytest.warns(UserWarning, match="60 fs does not resolve the angle"):
            sim.dt_fs = 60
        assert sum("does not resolve" in note for note in sim.notes) == 1
        sim.dt_fs = 2
        assert not any("does not resolve" in note for note in sim.notes)


def test_the_log_has_the_bath():
    with taut.Simulation("water", set={**SET, **BATH}) as sim:
        sim.run(40, every=10, ramp=(300, 340))
        assert sim.log["bath_temperature_k"][1:].tolist() == [310, 320, 330, 340]
        again = taut.Simulation.resume(sim.checkpoint())
        assert np.array_equal(again.log["bath_temperature_k"], sim.log["bath_temperature_k"])
    sim = taut.Simulation("pair")
    sim.run(1)
    assert np.isnan(sim.log["bath_temperature_k"]).all()


def test_a_ramp_ends_at_its_temperature():
    with taut.Simulation("water", set={**SET, **BATH}) as sim:
        sim.run(400, every=5, ramp=(300, 600))
        assert sim.steps_taken == 400
        assert np.mean(sim.log["temperature_k"][-4:]) > 450
        assert np.all(np.diff(sim.log["step"]) == 5)


@pytest.mark.parametrize("change,words", [
    (lambda sim: sim.change({"run.seed": 1}), "run.seed cannot change between two runs"),
    (lambda sim: setattr(sim, "dt_fs", -1), "run.dt_fs: expected more than 0"),
    (lambda sim: setattr(sim, "method", "shook"), "shook"),
    (lambda sim: setattr(sim, "method", taut.Shake(tolerance=1e-15)), "1e-15 cannot be reached"),
    (lambda sim: sim.change({"method.tolerence": 1e-6}), "tolerence"),
    (lambda sim: sim.change({"run.temprature_k": 1}), "did you mean"),
    (lambda sim: setattr(sim, "thermostat", "langvin"), "langvin"),
    (lambda sim: setattr(sim, "thermostat", {"friction_per_ps": 1}), "expected a name, None, or a dict"),
    (lambda sim: setattr(sim, "barostat", 3), "barostat: expected a name, None, or a dict"),
    (lambda sim: setattr(sim, "method", None), "method: expected a name"),
    (lambda sim: setattr(sim, "dt_fs", None), r"dt_fs: expected a number \[fs\], got None"),
    (lambda sim: sim.set_temperature(None), r"set_temperature: expected a number \[K\], got None"),
    (lambda sim: sim.change({"run.temperature_k": None}), "run.temperature_k: expected a value"),
    (lambda sim: sim.run(5, ramp=300), "expected two temperatures")])
def test_wrong_changes_are_refused_and_change_nothing(change, words):
    with taut.Simulation("water", set={**SET, **BATH}) as sim, taut.Simulation("water", set={**SET, **BATH}) as other:
        with pytest.raises(taut.InputError, match=words):
            change(sim)
        for each in (sim, other):
            each.run(5)
        assert np.array_equal(sim.positions, other.positions)


def test_a_refused_change_leaves_no_trace():
    sim = taut.Simulation("pendulum")
    with pytest.raises(taut.InputError, match="no thermostat"):
        sim.set_temperature(300)
    with pytest.raises(taut.InputError, match="a thermostat needs a run.temperature_k above 0"):
        sim.thermostat = "langevin"
    with pytest.raises(taut.InputError, match="friction_per_ps"):
        sim.thermostat = {"thermostat": "langevin", "temperature_k": 300, "friction_per_ps": -1}
    sim = taut.Simulation.resume(sim.checkpoint())
    sim.thermostat = {"thermostat": "langevin", "temperature_k": 310}
    assert sim.thermostat == "langevin"


@pytest.mark.parametrize("again", [lambda sim: pickle.loads(pickle.dumps(sim)), copy.copy, copy.deepcopy,
                                   lambda sim: taut.Simulation.resume(sim.checkpoint())])
def test_log_and_summary_stay(again):
    sim = taut.Simulation("water", set={**SET, "run.log_every": 5})
    sim.run(10)
    other = again(sim)
    assert other.summary == sim.summary and other.summary["steps"] == 10
    for name, column in sim.log.items():
        assert np.array_equal(other.log[name], column, equal_nan=True), name
    for each in (sim, other):
        each.run(10)
    assert other.log["step"].tolist() == sim.log["step"].tolist() == [0, 5, 10, 15, 20]
    assert np.array_equal(sim.log["total_kj_mol"], other.log["total_kj_mol"])
    assert again(other).log["step"].tolist() == [0, 5, 10, 15, 20]


def assert_same_log(log, other):
    """All columns to the last bit."""
    assert list(log) == list(other)
    for name in log:
        assert np.array_equal(log[name], other[name], equal_nan=True), name


def test_log_and_summary_of_a_folder_stay(tmp_path):
    with taut.Simulation("water", set={**SET, "run.log_every": 5}, out=tmp_path / "run") as sim:
        sim.run(10)
        log, summary = sim.log, sim.summary
    with taut.Simulation.resume(tmp_path / "run") as sim:
        assert sim.log["step"].tolist() == [0, 5, 10] and sim.summary == summary
        assert_same_log(sim.log, log)
        sim.run(10)
        assert sim.log["step"].tolist() == [0, 5, 10, 15, 20]


BEAD = {"atoms": [{"name": "B", "mass_u": 50, "sigma_nm": 0.3, "epsilon_kj_mol": 1}]}
WALLS = {"molecule": {"bead": BEAD}, "place": [{"molecule": "bead", "centres_nm": [[1, 1, 1], [1, 1, 2]]}],
         "wall": [{"axis": "z", "between_nm": [0.5, 2.5], "sigma_nm": 0.3, "epsilon_kj_mol": 1}],
         "build": {"box_nm": [2, 2, 3.5]}, "forcefield": {"cutoff_nm": 0.9},
         "run": {"dt_fs": 1, "log_every": 5}, "method": {"name": "rattle"}}
STEERED = {"molecule": {"bead": {**BEAD, "steered": [[0, 0.03, 0, 0.04, 200]]}},
           "place": [{"molecule": "bead", "centres_nm": [[1, 2, 3]]}],
           "run": {"dt_fs": 1, "log_every": 5}, "method": {"name": "rattle"}}


WARM = {**WALLS, "run": {**WALLS["run"], "thermostat": "langevin", "temperature_k": 300}}


@pytest.mark.parametrize("scene,columns", [(WALLS, ["wall_0_pressure_bar", "wall_1_pressure_bar"]),
                                           (STEERED, ["steering_work_kj_mol", "steering_force_kj_mol_nm"]),
                                           (WARM, ["bath_temperature_k", "heat_kj_mol", "pressure_xy_bar"])])
def test_the_columns_that_only_some_runs_have_stay(tmp_path, scene, columns):
    rows = []
    with taut.Simulation(scene, out=tmp_path / "run") as sim:
        assert all(sim.log[name].shape == (0,) for name in columns)
        sim.run(10, callback=rows.append)
        before = sim.log
        for name in columns:
            assert [getattr(row, name) for row in rows] == before[name].tolist() and name in dir(rows[0])
            assert np.abs(before[name]).max() > 0
        with pytest.raises(AttributeError, match="no column bias_arm_nm"):
            rows[0].bias_arm_nm
    kept = sim.checkpoint()
    for again in (taut.Simulation.resume(tmp_path / "run"), taut.Simulation.resume(kept)):
        with again as sim:
            assert_same_log(sim.log, before)
            sim.run(10)
            for name in columns:
                assert sim.log[name].shape == (5,)
                assert np.array_equal(sim.log[name][:3], before[name]) and np.all(sim.log[name][3:] != 0)


def test_a_checkpoints_file_is_resumed(tmp_path):
    sim = taut.Simulation("water", set={**SET, "run.log_every": 5})
    sim.run(10)
    sim.checkpoint(tmp_path / "x.cbor")
    assert taut.Simulation.resume(tmp_path / "x.cbor").log["step"].tolist() == [0, 5, 10]


def test_a_notebook_shows_log_and_summary():
    sim = taut.Simulation("water", set=SET)
    sim.run(20, every=5)
    assert "log, 5 rows" in sim.log._repr_html_() and "<svg" in sim.log._repr_html_()
    assert "<th style='text-align:left'>potential_kj_mol</th>" in sim.summary._repr_html_()


def test_a_notebook_shows_a_picture_once(monkeypatch):
    """It shows what a cell returns, and, when the cell ends, every figure that is open."""
    matplotlib = pytest.importorskip("matplotlib")
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("agg")
    pyplot.close("all")  # other tests' figures
    monkeypatch.setattr(matplotlib, "get_backend", lambda: "module://matplotlib_inline.backend_inline")
    sim = taut.Simulation("water", set=SET)
    sim.run(20, every=5)
    figure = sim.plot()
    assert len(figure.axes) == 5 and pyplot.get_fignums() == []
