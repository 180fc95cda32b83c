"""The cases of conformance/: they keep to their schema, taut's methods pass them, and a wrong engine does not."""

import copy
import importlib.util
import json
import sys
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "conformance"

METHODS = ["newton", "mshake", "feedforward", "baumgarte", "rattle", "shake", "lincs", "settle"]


def load(name, path):
    spec = importlib.util.spec_from_file_location(name, path)
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


@pytest.fixture(scope="module")
def suite():
    path = list(sys.path)
    made = load("conformance_run", FOLDER / "run.py")
    yield made
    sys.path[:] = path


@pytest.fixture(scope="module")
def runner(suite):
    return suite.load_runner("taut_python")


def fixed_cases(suite):
    """Those without chance."""
    cases = suite.read_cases()
    return [case for case in cases if all(ask["kind"] != "statistical" for ask in case["asks"])]


def read_kept(path):
    return load("conformance_keeping", FOLDER / "keeping.py").read_results(path)["verdicts"]


def case_called(suite, name):
    return next(case for case in suite.read_cases([name]) if case["name"] == name)


def test_cases_keep_to_the_schema(suite, capsys):
    pytest.importorskip("jsonschema", reason="needs Debian's python3-jsonschema, or jsonschema from PyPI")
    assert load("conformance_check", FOLDER / "check.py").main() == 0, capsys.readouterr().out
    assert sum(path.stat().st_size for path in FOLDER.glob("cases/*/*.json")) < 600_000


@pytest.mark.parametrize("name, spoil, said", [
    ("pendulum", lambda case: case["asks"][0].update(right=0), "shape"),
    ("pendulum", lambda case: case["asks"][0].update(kind="refused"), "cannot be of kind"),
    ("pendulum", lambda case: case["system"]["bonds"][0].update(image=[1, 0, 0]), "no box_nm"),
    ("drift_of_butane", lambda case: case["run"].pop("reference_k"), "needs reference_k"),
    ("gas_of_dumbbells", lambda case: case["system"].pop("molecules"), "needs molecules"),
    ("gas_of_dumbbells", lambda case: case["system"]["molecules"].append([999]), "names atom 999"),
])
def test_a_faulty_case_is_found(suite, name, spoil, said):
    pytest.importorskip("jsonschema", reason="needs Debian's python3-jsonschema, or jsonschema from PyPI")
    case = copy.deepcopy(case_called(suite, name))
    spoil(case)
    assert said in load("conformance_check", FOLDER / "check.py").find_faults_of_numbers(case)[0]


@pytest.mark.parametrize("method", METHODS)
def test_taut_passes_all_but_what_the_matrix_says(suite, runner, method):
    cases = fixed_cases(suite)
    names = {case["name"] for case in cases}
    kept = {(one["case"], one["what"]): one["verdict"]
            for one in read_kept(FOLDER / "results" / f"taut_python.{method}.json") if one["case"] in names}
    made = {(one["case"], one["what"]): one["verdict"] for one in suite.run_variant(runner, method, cases)}
    assert made == kept
    if method in ("newton", "mshake", "feedforward", "baumgarte"):  # two bonds on one pair alone
        assert {case for (case, _), verdict in made.items() if verdict in ("failed", "refused")} == {
            "freedom_with_a_bond_twice"}


@pytest.mark.parametrize("method", ["newton", "rattle", "baumgarte"])
def test_baths_give_the_right_means(suite, runner, method):
    for name in ("pendulums_in_a_bath", "gas_of_trimers"):
        case = case_called(suite, name)
        case["asks"] = [ask for ask in case["asks"] if ask["what"] == "mean"]
        assert [one["verdict"] for one in suite.judge_case(case, lambda varied: runner.run(varied, method))] == ["passed"]


@pytest.mark.parametrize("name", ["star", "two_waters", "cholesterol_diamond", "triatomic_near_180",
                                  "pair_across_a_triclinic_box", "rigid_benzene_with_sites"])
def test_crosscheck_agrees(suite, command, tmp_path, name):
    """OpenMM's run of the case beside newton's and rattle's."""
    case, files = case_called(suite, name), suite.load_runner("taut_command")
    (tmp_path / "system.xml").write_text(files.system_xml(case))
    (tmp_path / "state.xml").write_text(files.state_xml(case, files.whole_by_images(case)))
    done = files.run_program([command, "crosscheck", "--openmm", "system.xml", "state.xml", "--steps", "50", "--dt-fs",
                              str(1000 * case["run"]["step_ps"]), "--speed-seconds", "0", "--json"], tmp_path)
    if "without OpenMM" in done.stderr:
        pytest.skip(done.stderr)
    verdicts = json.loads(done.stdout)["verdicts"]
    assert len(verdicts) > 5 and {one["finding"] for one in verdicts} == {"agrees"}, verdicts


def test_results_are_of_these_cases(suite):
    """Results that are kept judge what the cases ask today, with the tolerances of today."""
    asked = {(case["name"], ask["what"]): ask.get("tolerance") for case in suite.read_cases() for ask in case["asks"]}
    for path in FOLDER.glob("results/*.json"):
        kept = read_kept(path)
        if path.stem in {f"taut_python.{method}" for method in METHODS}:
            assert {(one["case"], one["what"]) for one in kept} == set(asked), path.name
        for one in kept:
            assert (one["case"], one["what"]) in asked, (path.name, one)
            if one["verdict"] in ("passed", "failed") and one["tolerance"]:
                assert np.isclose(asked[one["case"], one["what"]], one["tolerance"], rtol=0.01), (path.name, one)


def change_rows(result, **change):
    made = copy.deepcopy(result)
    if "rows" in made:
        rows = {key: np.array(values, dtype=float) for key, values in made["rows"].items()}
        made["rows"] = {**rows, **{key: of(rows) for key, of in change.items()}}
    return made


def test_an_engine_of_nan_passes_nothing(suite, runner):
    def run_with_nan(varied):
        result = runner.run(varied, "newton")
        return change_rows(result, **{key: lambda rows, key=key: np.nan * rows[key] for key in result.get("rows", {})})

    for case in suite.read_cases(["pendulum", "butane", "momenta", "freedom_of_waters"]):
        if all(ask["kind"] != "statistical" for ask in case["asks"]):
            verdicts = {one["verdict"] for one in suite.judge_case(case, run_with_nan)}
            assert "passed" not in verdicts, case["name"]


def test_nan_at_the_whole_step_does_not_converge(suite, runner):
    case = case_called(suite, "pendulum")

    def run_with_nan(varied):
        whole = varied["run"]["step_ps"] == case["run"]["step_ps"]
        return change_rows(runner.run(varied, "newton"), positions_nm=lambda rows: (np.nan if whole else 1) * rows["positions_nm"])

    verdicts = {one["what"]: one["verdict"] for one in suite.judge_case(case, run_with_nan)}
    assert verdicts["positions_nm"] == verdicts["bond_error"] == "failed"


def test_an_engine_that_never_moves_conserves_nothing(suite):
    def stand_still(varied):
        at, n = np.array(varied["start"]["positions_nm"], float), 3
        v = np.array(varied["start"].get("velocities_nm_per_ps", 0 * at), float)
        zero = np.zeros(n)
        return {"rows": {"step": np.arange(n), "positions_nm": np.stack([at] * n), "velocities_nm_per_ps": np.stack([v] * n),
                         "potential_kj_per_mol": zero, "kinetic_kj_per_mol": zero}}

    cases = suite.read_cases(["conservation/"])
    assert len(cases) > 20
    for case in cases:
        verdicts = suite.judge_case(case, stand_still)
        assert "passed" not in {one["verdict"] for one in verdicts}, (case["name"], verdicts)


def kinetic_pressure(rows):
    """Of atoms, without what bonds add: 27 nm³."""
    return 2 * rows["kinetic_kj_per_mol"] / 81 * 16.605390671738466


WRONG = [
    ("turning_dumbbell", {"pressure_bar": kinetic_pressure}, "no virial of bonds"),
    ("free_rotor", {"positions_nm": lambda rows: rows["positions_nm"] + 2e-5}, "positions a little off"),
    ("butane", {"velocities_nm_per_ps": lambda rows: 1.03 * rows["velocities_nm_per_ps"]}, "velocities too large"),
    ("hanging_chain", {"tensions_kj_per_mol_nm": lambda rows: -rows["tensions_kj_per_mol_nm"]}, "tensions' sign"),
    ("momenta_of_a_chain", {"velocities_nm_per_ps": lambda rows: rows["velocities_nm_per_ps"]
                            * (1 + 1e-6 * rows["step"][:, None, None])}, "momenta that drift"),
    ("energy_of_butane", {"potential_kj_per_mol": lambda rows: 0 * rows["step"]}, "no potential energy"),
    ("drift_of_butane", {"kinetic_kj_per_mol": lambda rows: rows["kinetic_kj_per_mol"] + 0.002 * rows["step"]}, "drift"),
    ("pendulum", {"positions_nm": lambda rows: np.nan * rows["positions_nm"]}, "NaN"),
    ("gas_of_dumbbells", {"velocities_nm_per_ps": lambda rows: 0.9 * rows["velocities_nm_per_ps"]}, "a cold bath"),
    ("mean_tension", {"tensions_kj_per_mol_nm": lambda rows: 0.9 * rows["tensions_kj_per_mol_nm"]}, "a mean's error"),
]


@pytest.mark.parametrize("name, change, fault", WRONG, ids=[fault for _, _, fault in WRONG])
def test_what_is_wrong_fails(suite, runner, name, change, fault):
    case = case_called(suite, name)
    right = suite.judge_case(case, lambda varied: runner.run(varied, "newton"))
    assert {one["verdict"] for one in right} == {"passed"}
    wrong = suite.judge_case(case, lambda varied: change_rows(runner.run(varied, "newton"), **change))
    assert "failed" in {one["verdict"] for one in wrong}


def test_a_wrong_mass_is_seen(suite, runner):
    """Of the last atom that moves, in any case of motion but those in which gravity moves all alike."""
    for case in suite.read_cases(["motion/"]):
        def run_with_a_wrong_mass(varied):
            masses = varied["system"]["masses_u"]
            masses[max(atom for atom, mass in enumerate(masses) if mass > 0)] *= 1.2
            return runner.run(varied, "newton")

        verdicts = {one["verdict"] for one in suite.judge_case(case, run_with_a_wrong_mass)}
        falls_alike = any(word in case["name"] for word in ("pendulum", "dead_point", "plate"))  # whatever the mass
        assert "failed" in verdicts or falls_alike or verdicts == {"not offered"}, case["name"]


def test_a_refusal_needs_a_word(suite):
    case = case_called(suite, "triangle_that_cannot_be")
    ran_on = suite.judge_case(case, lambda varied: {"rows": {"step": [0]}})
    refused = suite.judge_case(case, lambda varied: {"refused": "no triangle has these sides"})
    assert [one["verdict"] for one in ran_on + refused] == ["failed", "passed"]


@pytest.mark.parametrize("name, why, verdict", [
    ("triangle_that_cannot_be", "Particle coordinate is NaN", "failed"),
    ("bond_of_no_length", "Non-numeric atom coords - simulation unstable", "failed"),
    ("chain_too_short_for_its_ends", "A constraint cannot involve a massless particle", "not offered"),
    ("chain_too_short_for_its_ends", "Invalid mass value 0", "not offered"),
    ("negative_mass", "Invalid mass value -1", "passed"),
])
def test_a_refusal_is_of_what_is_wrong(suite, name, why, verdict):
    made = suite.judge_case(case_called(suite, name), lambda varied: {"refused": why})
    assert [one["verdict"] for one in made] == [verdict]


def test_a_runner_that_breaks_fails(suite):
    verdicts = suite.judge_case(case_called(suite, "pendulum"), lambda varied: 1 / 0)
    assert {one["verdict"] for one in verdicts} == {"failed"}
    assert "ZeroDivisionError" in verdicts[0]["why"]


def test_what_takes_too_long_is_told(suite, tmp_path):
    class Endless:
        @staticmethod
        def run(case, variant):
            while True:
                pass

    made = suite.run_variant(Endless, "", [case_called(suite, "pendulum")], limit=1)
    suite.put_beside(tmp_path / "kept.json", {}, made, ["pendulum"])
    for verdicts in (made, read_kept(tmp_path / "kept.json")):
        assert [one["verdict"] for one in verdicts] == ["not done"] * 4
        assert verdicts[0]["why"] == "not done in 1 s of processor time"


def test_right_values_follow_from_their_formulas(tmp_path, monkeypatch):
    """What scripts of make write is what the folder has; those without a solver's long run."""
    pytest.importorskip("scipy", reason="needs scipy")
    monkeypatch.setattr(sys, "path", [str(FOLDER / "make"), *sys.path])
    solve = load("solve", FOLDER / "make" / "solve.py")
    monkeypatch.setitem(sys.modules, "solve", solve)
    monkeypatch.setattr(solve, "CASES", tmp_path)
    forces, freedom = (load(f"make_{name}", FOLDER / "make" / f"{name}.py") for name in ("forces", "freedom"))
    for write in (forces.write_forces, forces.write_pressures, freedom.write_freedoms, freedom.write_refusals):
        write()
    written = sorted(tmp_path.glob("*/*.json"))
    assert len(written) > 35
    for path in written:
        kept = FOLDER / "cases" / path.relative_to(tmp_path)
        written_asks, kept_asks = (json.loads(file.read_text())["asks"] for file in (path, kept))
        assert len(written_asks) == len(kept_asks), path.stem
        for one, other in zip(written_asks, kept_asks):
            rights = [np.array(ask["right"], float) for ask in (one, other)]
            np.testing.assert_allclose(*rights, rtol=1e-6, atol=1e-9, err_msg=path.stem)
