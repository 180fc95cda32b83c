"""Restraints, walls and pulls of groups of atoms, taut.Distance and the like."""

import pickle

import numpy as np
import pytest

import taut

KEPT = {"run.log_every": 5, "run.dt_fs": 1, "run.temperature_k": 300}


def centre(sim, atoms):
    mass = sim.masses[atoms, None]
    return (mass * sim.positions[atoms]).sum(axis=0) / mass.sum()


def neighbours(sim):
    """The first atoms of all waters, those near the first water first."""
    oxygens = np.arange(0, len(sim.positions), 3)
    apart = sim.positions[oxygens] - sim.positions[0]
    edges = np.diag(sim.box)
    return oxygens[np.argsort(np.linalg.norm(apart - edges * np.round(apart / edges), axis=1))].tolist()


def test_each_kind_acts_as_numpy_says():
    near = neighbours(taut.Simulation("water", set=KEPT))
    first, second = [0, 1, 2], list(range(near[8], near[8] + 3))
    biases = [taut.Distance(first, second, at_nm=0.3, k_kj_mol_nm2=300, name="arm"),
              taut.Distance("0-2", range(near[8], near[8] + 3), along=(0, 0, 1), force_kj_mol_nm=7, name="pull"),
              taut.Angle([0, 1, 2], np.arange(near[1], near[1] + 3), near[2], at_most_deg=20, k_kj_mol_rad2=50,
                         name="bend"),
              taut.Torsion(*near[:4], at_deg=90, k_kj_mol_rad2=5, name="turn"),
              taut.Gyration(np.arange(648) < 90, at_least_nm=2, k_kj_mol_nm2=20, name="size")]
    sim = taut.Simulation("water", set=KEPT, biases=biases)
    free = taut.Simulation("water", set=KEPT)
    edges = np.diag(sim.box)
    d = centre(sim, second) - centre(sim, first)
    d -= edges * np.round(d / edges)
    every = list(range(90))
    squares = ((sim.positions[every] - centre(sim, every)) ** 2).sum(axis=1)
    gyration = np.sqrt((sim.masses[every] * squares).sum() / sim.masses[every].sum())
    sim.run(5)
    log = {name: column[0] for name, column in sim.log.items()}
    assert np.isclose(log["bias_arm_nm"], np.linalg.norm(d), rtol=1e-9)
    assert np.isclose(log["bias_arm_force_kj_mol_nm"], -300 * (np.linalg.norm(d) - 0.3), rtol=1e-9)
    assert np.isclose(log["bias_pull_nm"], d[2], rtol=1e-9) and log["bias_pull_force_kj_mol_nm"] == 7
    assert np.isclose(log["bias_size_nm"], gyration, rtol=1e-9)
    assert np.isclose(log["bias_size_force_kj_mol_nm"], 20 * (2 - gyration), rtol=1e-9)
    assert 0 < log["bias_bend_deg"] < 180 and -90 <= log["bias_turn_deg"] <= 270
    excess = np.radians([log["bias_bend_deg"] - 20, log["bias_turn_deg"] - 90])
    expected = (150 * (np.linalg.norm(d) - 0.3) ** 2 - 7 * d[2] + 25 * excess[0] ** 2 + 2.5 * excess[1] ** 2
                + 10 * (2 - gyration) ** 2)
    now = taut.Simulation("water", set=KEPT, biases=biases).energies
    assert np.isclose(now["bias"], expected, rtol=1e-9)
    assert np.isclose(now["potential"] - free.energies["potential"], expected, rtol=1e-6)
    assert np.isclose(sim.summary["bias_arm_nm"]["value"], sim.log["bias_arm_nm"].mean(), rtol=1e-9)


def test_a_moving_bias_works_and_goes_on_to_the_last_bit(tmp_path):
    other = neighbours(taut.Simulation("water", set=KEPT))[8]
    moving = [taut.Distance([0, 1, 2], [other], rate_nm_ps=0.1, k_kj_mol_nm2=2000, name="arm")]
    with taut.Simulation("water", set=KEPT, biases=moving, out=tmp_path / "run") as sim:
        sim.run(10)
        kept = sim.checkpoint()
        sim.run(10)
        positions, log = sim.positions.copy(), sim.log
    assert log["steering_work_kj_mol"][-1] != 0 and "steering_force_kj_mol_nm" not in log
    for again in (taut.Simulation.resume(kept), pickle.loads(pickle.dumps(taut.Simulation.resume(kept)))):
        again.run(10)
        assert np.array_equal(again.positions, positions)
        assert np.array_equal(again.log["bias_arm_nm"], log["bias_arm_nm"])
        assert np.array_equal(again.log["steering_work_kj_mol"], log["steering_work_kj_mol"])
    with taut.Simulation.resume(tmp_path / "run") as again:
        assert np.allclose(again.log["bias_arm_force_kj_mol_nm"], log["bias_arm_force_kj_mol_nm"], rtol=1e-7)


def test_biases_act_on_what_openmm_prepared(data):
    system, state = data / "tip3p-216.system.xml", data / "tip3p-216.state.xml"
    free = taut.Simulation.from_openmm(system, state)
    other = neighbours(free)[8]
    bias = taut.Distance("0-2", [other, other + 1], at_nm=0.3, k_kj_mol_nm2=100)
    sim = taut.Simulation.from_openmm(system, state, biases=[bias])
    change = sim.forces - free.forces
    assert sim.energies["bias"] > 0.1
    assert np.flatnonzero(np.abs(change).sum(axis=1) > 1e-9).tolist() == [0, 1, 2, other, other + 1]


def test_ase_knows_them(tmp_path):
    pytest.importorskip("ase")
    scene = {"molecule": {"bead": {"atoms": [{"name": "B", "mass_u": 40}]}},
             "place": [{"molecule": "bead", "centres_nm": [[0, 0, 0], [0.4, 0, 0.3]]}]}
    sim = taut.Simulation(scene, biases=[taut.Distance(0, 1, at_nm=0.4, k_kj_mol_nm2=100)])
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    assert np.isclose(atoms.get_potential_energy(), 0.5 * 100 * 0.1**2 / 96.48533212, rtol=1e-6)
    moving = taut.Simulation(scene, biases=[taut.Distance(0, 1, rate_nm_ps=1, k_kj_mol_nm2=100, name="arm")])
    with pytest.raises(taut.InputError, match="bias arm moves with time"):
        taut.Calculator(moving).calculate(atoms)


@pytest.mark.parametrize("biases,said", [
    ([taut.Distance(0, 0, k_kj_mol_nm2=1)], "group 1 has the atoms of an earlier one"),
    ([taut.Distance(0, 9999, k_kj_mol_nm2=1)], "there is no atom 9999"),
    ([taut.Distance(0, 1.5, k_kj_mol_nm2=1)], "a bias's group: expected indices from 0"),
    ([taut.Distance(0, 1)], "expected k_kj_mol_nm2 .* or force_kj_mol_nm"),
    ([taut.Angle(0, 1, 2, k_kj_mol_rad2=1, torque_kj_mol_rad=1)], "expected k_kj_mol_rad2 .* or torque_kj_mol_rad"),
    (["distance"], r"biases: expected taut.Distance\(...\), Angle, Torsion or Gyration, got 'distance'"),
])
def test_bad_ones_are_refused_by_name(biases, said):
    with pytest.raises(taut.InputError, match=said):
        taut.Simulation("water", biases=biases)
