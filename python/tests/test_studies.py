import inspect

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
    assert set(work["method"]) == {"newton", "baumgarte"} and (np.array(work["ns_per_bond_step"]) > 0).all()
    assert set(tables) == {"work", "drift", "order", "length", "failures"}
    order = {m: o for m, o in zip(tables["order"]["method"], tables["order"]["order"])}
    assert order["newton"] == pytest.approx(2, abs=0.2)


def test_stability():
    tables = taut.stability("freely_jointed", ["newton"], quick=True, steps=50, set=CHAINS)
    plane = tables["plane"]
    assert len(plane["alpha_h"]) == 5 * 4 * 4 and set(np.array(plane["failed"])) == {0, 1}
    assert set(tables) == {"plane", "steps", "limits"}


def test_calibrate_says_what_to_run():
    found = taut.calibrate("freely_jointed", sweeps=4, set=CHAINS)
    sim = taut.Simulation("freely_jointed", set={**CHAINS, **found["settings"]})
    assert found["reduction_measured"] == pytest.approx(found["reduction_predicted"], rel=0.1)
    assert sim.method == "baumgarte" and f"α {found['alpha_per_ps']:.6g}/ps" in sim.setting
    assert len(found["courses"]["reference"]) == 41


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


def test_crosscheck():
    try:
        found = taut.crosscheck("pair", ["newton"], steps=20)
    except taut.InputError as error:
        pytest.skip(f"built without OpenMM: {error}")
    assert found["start"]["energy_kj_mol"] == pytest.approx(found["start"]["openmm_energy_kj_mol"])
    assert "newton" in set(found["samples"]["run"]) and found["verdicts"][0]["who"]


def test_pictures(tmp_path):
    pytest.importorskip("matplotlib", reason="needs matplotlib").use("Agg")
    drawn = {"chart": taut.chart("freely_jointed", ["newton", "baumgarte"], quick=True, set=CHAINS, draw=True),
             "stability": taut.stability("freely_jointed", ["newton"], quick=True, steps=50, set=CHAINS, draw=True),
             "calibrate": taut.calibrate("freely_jointed", sweeps=4, set=CHAINS, draw=True)}
    for name, found in drawn.items():
        found["figure"].savefig(tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").stat().st_size > 10_000
        assert all(axis.has_data() for axis in found["figure"].axes)


def test_studies_take_what_from_openmm_takes():
    sim = taut.Simulation("water", set={"build.molecules": 64, "forcefield.cutoff_nm": 0.55,
                                        "forcefield.switch_nm": 0.5})
    system, state = sim.to_openmm_xml()
    found = taut.calibrate((system, state), dt_fs=2, sweeps=4)
    assert found["reduction"] == pytest.approx(taut.calibrate("water", dt_fs=2, sweeps=4)["reduction"], rel=0.5)
    limits = taut.stability((system, state), ["newton"], dt_fs=2, quick=True, plane=False)
    assert list(limits["steps"]["method"]) == ["newton"]
