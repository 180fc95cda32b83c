import inspect
import shutil
import sys
from pathlib import Path

import numpy as np
import pytest

import taut
from taut.options import CLASSES

CHAINS = {"build.chains": 2}


def test_methods_and_scenes_are_the_engines():
    assert list(taut.methods())[:2] == ["none", "penalty"] and "water" in taut.scenes()
    assert list(CLASSES) == list(taut.methods())


def test_options_have_signatures_and_say_what_they_are():
    parameters = inspect.signature(taut.Shake).parameters
    assert parameters["tolerance"].default == 1e-10 and parameters["sweeps"].annotation is int
    assert "``alpha_per_ps`` = None: damping α" in taut.Baumgarte.__doc__ and "[1/ps]" in taut.Baumgarte.__doc__
    assert "(one of reversible, " in taut.Baumgarte.__doc__
    with pytest.raises(TypeError):
        taut.Shake(tolerence=1)
    for name, kind in CLASSES.items():
        if name != "settle":
            assert taut.Simulation("double_pendulum", method=kind()).method == name


def test_chart():
    tables = taut.chart("freely_jointed", ["newton", "baumgarte"], quick=True, set=CHAINS)
    work = tables["work"]
    ns = np.array(work["ns_per_bond_step"])  # NaN where the bonds' share is lost in the step's noise
    assert set(work["method"]) == {"newton", "baumgarte"} and (ns > 0).any() and not (ns <= 0).any()
    assert set(tables) == {"work", "drift", "order", "length", "failures"}
    order = {m: o for m, o in zip(tables["order"]["method"], tables["order"]["order"])}
    assert order["newton"] == pytest.approx(2, abs=0.2)


def test_a_study_that_is_cut_off_keeps_its_trials(monkeypatch):
    def fail(*_):
        raise RuntimeError("at the end")

    monkeypatch.setattr(taut.studies, "_joined", fail)
    with pytest.warns(UserWarning, match=r"its (\d+) finished trials are kept in (.+)") as said:
        with pytest.raises(RuntimeError, match="at the end"):
            taut.chart("freely_jointed", ["newton"], quick=True, repeats=1, panels="work", set=FEW)
    folder = Path(str(said[0].message).rsplit(" ", 1)[1])
    rows = (folder / "0" / "ledger.tsv").read_text().splitlines()[1:]
    shutil.rmtree(folder)
    assert len(rows) == 6 and sum(row.startswith("work/newton:tolerance=") for row in rows) == 3


def test_a_picture_that_fails_takes_no_table_with_it(monkeypatch):
    pytest.importorskip("matplotlib", reason="needs matplotlib").use("Agg")
    asked = {"quick": True, "repeats": 1, "panels": "work", "set": FEW, "draw": True}
    monkeypatch.setitem(taut.pictures.KINDS, "work", lambda *asked: 1 / 0)
    with pytest.warns(UserWarning, match="no picture of work: division by zero"):
        assert taut.chart("freely_jointed", ["newton"], **asked)["figures"] == {}
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setattr(taut._core, "chart", None)  # nothing is run
    with pytest.raises(ImportError, match="pip install matplotlib"):
        taut.chart("freely_jointed", ["newton"], **asked)


def test_stability():
    tables = taut.stability("freely_jointed", ["newton"], quick=True, steps=50, set=CHAINS)
    plane = tables["plane"]
    assert len(plane["alpha_h"]) == 5 * 4 * 4 and set(np.array(plane["failed"])) == {0, 1}
    assert set(tables) == {"plane", "steps", "limits"}


def test_calibrate_says_what_to_run():
    found = taut.calibrate("freely_jointed", sweeps=4, set=CHAINS)
    sim = taut.Simulation("freely_jointed", method=found["method"], set=CHAINS)
    assert found["reduction_measured"] == pytest.approx(found["reduction_predicted"], rel=0.1)
    assert sim.method == "baumgarte" and f"α {found['alpha_per_ps']:.6g}/ps" in sim.setting
    assert len(found["courses"]["reference"]) == 41
    table = found["table"]
    assert list(table["method"])[0] == "rattle:sweeps=4" and found["method"] in set(table["method"])
    assert found["take"] in set(table["method"]) and found["verdict"].startswith("take ")
    assert (np.array(table["drift_se"]) > 0).all() and np.isfinite(np.array(table["bond_error_slope_per_ns"])).all()
    assert "table" not in taut.calibrate("freely_jointed", sweeps=4, steps=0, set=CHAINS)


def test_a_method_in_a_word_has_its_settings():
    sim = taut.Simulation("freely_jointed", method="rattle:sweeps=4", set=CHAINS)
    assert sim.method == "rattle" and "4 sweeps" in sim.setting
    with pytest.raises(taut.InputError, match="method.sweeps is said twice"):
        taut.Simulation("freely_jointed", method="rattle:sweeps=4", set={**CHAINS, "method.sweeps": 3})
    with pytest.raises(taut.InputError, match="sweps"):
        taut.Simulation("freely_jointed", method="rattle:sweps=4", set=CHAINS)


def test_what_has_no_effect_is_refused():
    with pytest.raises(taut.InputError, match="method.name.*no effect"):
        taut.chart("freely_jointed", set={"method.name": "rattle"})
    with pytest.raises(taut.InputError, match="methods: expected names"):
        taut.chart("freely_jointed", [7])
    with pytest.raises(taut.InputError, match="repeats: -1"):
        taut.chart("freely_jointed", ["newton"], repeats=-1)
    with pytest.raises(taut.InputError, match="expected rattle, shake or newton"):
        taut.calibrate("freely_jointed", against="lincs")
    with pytest.raises(taut.InputError, match="no bonds to calibrate on|has no bonds"):
        taut.calibrate({"build": {"kind": "atoms", "atoms": [[1.0, 0, 0, 0], [1.0, 1, 0, 0]]}})


def test_pictures(tmp_path):
    pytest.importorskip("matplotlib", reason="needs matplotlib").use("Agg")
    figures = taut.calibrate("freely_jointed", sweeps=4, set=CHAINS, draw=85)["figures"]
    assert list(figures) == ["courses"]
    taut.pictures.save(figures["courses"], tmp_path / "courses")
    assert (tmp_path / "courses.png").stat().st_size > 10_000
    assert figures["courses"].get_figwidth() * 25.4 == pytest.approx(85)


def test_studies_take_what_from_openmm_takes():
    sim = taut.Simulation("water", set={"build.molecules": 64, "forcefield.cutoff_nm": 0.55,
                                        "forcefield.switch_nm": 0.5})
    system, state = sim.to_openmm_xml()
    found = taut.calibrate((system, state), dt_fs=2, sweeps=4)
    assert found["reduction"] == pytest.approx(taut.calibrate("water", dt_fs=2, sweeps=4)["reduction"], rel=0.5)
    limits = taut.stability((system, state), ["newton"], dt_fs=2, quick=True, plane=False)
    assert list(limits["steps"]["method"]) == ["newton"]


class Mine(taut.ConstraintMethod):
    """Newton's linear solve of the lengths, once a step."""

    holds = "positions"

    def __init__(self, passes=2):
        self.passes = passes

    def project_positions(self, system, h, state):
        i, j = system.bonds.T
        before = state.positions - h * state.velocities
        along = before[j] - before[i]
        for _ in range(self.passes):
            r = state.positions[j] - state.positions[i]
            matrix = np.zeros((len(i), len(i)))
            for atom, sign in ((i, -1), (j, 1)):
                for other, its in ((i, -1), (j, 1)):
                    same = atom[:, None] == other[None]
                    matrix += sign * its * same * (r @ along.T) * system.inverse_masses[atom][:, None]
            force = np.linalg.solve(matrix, (system.lengths**2 - (r * r).sum(1)) / 2)[:, None] * along
            move = np.zeros_like(before)
            np.add.at(move, j, force)
            np.add.at(move, i, -force)
            move *= system.inverse_masses[:, None]
            state.positions += move
            state.velocities += move / h


FEW = {"build.chains": 1, "build.beads": 4}


def test_studies_take_objects_with_their_options():
    methods = [taut.Shake(tolerance=1e-6), "newton", taut.Shake, Mine, Mine(passes=1)]
    work = taut.chart("freely_jointed", methods, quick=True, repeats=1, panels="work", set=FEW)["work"]
    rows, errors = list(work["method"]), np.array(work["rms_rel_bond_error"])
    assert rows.count("shake:tolerance=1e-06") == rows.count("Mine") == rows.count("Mine:passes=1") == 1
    assert rows.count("shake") == 5  # tolerances and sweeps of a class vary
    assert 1e-9 < errors[rows.index("shake:tolerance=1e-06")] < 1e-6
    assert errors[rows.index("Mine:passes=1")] > 10 * errors[rows.index("Mine")]
    steps = taut.stability("freely_jointed", [taut.Rattle(sweeps=1), "rattle"], quick=True, steps=40, plane=False,
                           set=FEW)["steps"]
    assert list(steps["method"]) == ["rattle:sweeps=1", "rattle"]
    one_sweep, converged = steps["largest_stable_fs"]
    assert one_sweep != converged
    with pytest.raises(taut.InputError, match="method.tolerance: expected at least"):
        taut.stability("freely_jointed", [taut.Rattle(tolerance=1)], quick=True, plane=False, set=FEW)


def test_calibrate_takes_objects():
    asked = {"set": {"build.chains": 2}}
    named = taut.calibrate("freely_jointed", sweeps=4, **asked)
    assert taut.calibrate("freely_jointed", against=taut.Rattle(sweeps=4), **asked)["reduction"] == named["reduction"]
    own = taut.calibrate("freely_jointed", against=Mine(passes=2), set=FEW)
    assert 0 <= own["reduction"] < 0.1
    with pytest.raises(taut.InputError, match="sweeps is said twice, in rattle:sweeps=4 and as 3"):
        taut.calibrate("freely_jointed", against=taut.Rattle(sweeps=4), sweeps=3, **asked)
    with pytest.raises(taut.InputError, match="size: 0, expected more than 0"):
        taut.calibrate("freely_jointed", size=0, **asked)


def test_seeds_give_means_and_errors():
    def chart(**more):
        return taut.chart("freely_jointed", ["newton"], quick=True, repeats=1, panels="drift", **more)["drift"]

    found = chart(seeds=2, set=FEW)
    each = [chart(set={**FEW, "run.seed": seed}) for seed in (1, 2)]
    drifts = np.array([one["drift_kj_mol_ns_dof"] for one in each])
    assert (drifts[0] != drifts[1]).any()
    assert np.allclose(found["drift_kj_mol_ns_dof"], drifts.mean(0), rtol=1e-12)
    assert np.allclose(found["drift_kj_mol_ns_dof_error"], abs(drifts[0] - drifts[1]) / 2, rtol=1e-9)
    assert list(found["method"]) == list(each[0]["method"]) and "value_error" not in found
    listed = taut.calibrate("freely_jointed", sweeps=4, seeds=[3, 5], set=FEW)
    of = [taut.calibrate("freely_jointed", sweeps=4, set={**FEW, "run.seed": seed}) for seed in (3, 5)]
    assert listed["reduction_measured"] == pytest.approx(np.mean([one["reduction_measured"] for one in of]))
    assert listed["reduction_measured_error"] > 0 and "reference_error" in listed["courses"]
    for wrong, words in (({"seeds": 0}, "seeds: 0"), ({"seeds": [1, 1]}, "each once"), ({"seeds": 1.5}, "whole number"),
                         ({"seeds": [1], "set": {"run.seed": 2}}, "seeds lists them already")):
        with pytest.raises(taut.InputError, match=words):
            taut.calibrate("freely_jointed", **wrong)


def test_a_seed_that_fails_takes_no_other_with_it(monkeypatch):
    calibrate, seeds = taut._core.calibrate, iter([3, 4, 5])

    def fails_once(scene, asked):
        if next(seeds) == 4:
            raise taut.SimulationFailure("calibration, step 7: no convergence")
        return calibrate(scene, asked)

    monkeypatch.setattr(taut._core, "calibrate", fails_once)
    with pytest.warns(UserWarning, match="seed 4 is left out: calibration, step 7"):
        found = taut.calibrate("freely_jointed", sweeps=4, seeds=[3, 4, 5], set=FEW)
    monkeypatch.undo()
    assert found["reduction"] == taut.calibrate("freely_jointed", sweeps=4, seeds=[3, 5], set=FEW)["reduction"]

    def fails(*_):
        raise taut.SimulationFailure("calibration, step 7: no convergence")

    monkeypatch.setattr(taut._core, "calibrate", fails)
    with pytest.raises(taut.SimulationFailure), pytest.warns(UserWarning, match="seed 1 is left out"):
        taut.calibrate("freely_jointed", sweeps=4, seeds=2, set=FEW)


def test_a_smaller_error_counts_as_a_failure():
    def largest(**more):
        return taut.stability("freely_jointed", ["baumgarte"], quick=True, steps=40, plane=False, set=FEW,
                              **more)["steps"]["largest_stable_fs"][0]

    assert largest(bond_error=1e-9) < largest()
    with pytest.raises(taut.InputError, match="energy_error: -1"):
        largest(energy_error=-1)


def test_crosscheck_takes_objects_and_seeds():
    try:
        found = taut.crosscheck("pair", [taut.Newton(tolerance=1e-9), "shake"], steps=20, agreement_nm=1e-3)
    except taut.InputError as error:
        pytest.skip(f"built without OpenMM: {error}")
    assert {"newton:tolerance=1e-09", "shake"} <= set(found["samples"]["run"]) and found["verdicts"][0]["who"]
    assert found["start"]["energy_kj_mol"] == pytest.approx(found["start"]["openmm_energy_kj_mol"])
