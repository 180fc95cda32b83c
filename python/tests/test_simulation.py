import gc
import pickle
import re
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest

import taut


def final_of(command, folder, *arguments):
    subprocess.run([command, "run", "--threads", "1", *map(str, arguments), "--out", str(folder)], check=True,
                   capture_output=True)
    return (folder / "final.start.toml").read_text()


@pytest.mark.parametrize("scene, method, settings", [
    ("water", "feedforward", {"build.molecules": 64, "forcefield.cutoff_nm": 0.6}),
    ("chain", "rattle", {}),
    ("water", "newton", {"run.thermostat": "langevin", "run.temperature_k": 300, "build.molecules": 64,
                         "forcefield.cutoff_nm": 0.6}),
    ("melt", "baumgarte", {"forcefield.precision": "mixed"}),
])
def test_same_bits_as_the_command(command, tmp_path, scene, method, settings):
    said = [f"{key}={value}" for key, value in settings.items()]
    there = final_of(command, tmp_path / "command", scene, "--method", method, "--steps", 120, "--set", *said,
                     "run.log_every=50")
    sim = taut.Simulation(scene, method=method, set=settings, out=tmp_path / "python")
    seen = []
    sim.run(120, every=50, callback=lambda row: seen.append(row.step))
    assert (tmp_path / "python" / "final.start.toml").read_text() == there
    assert seen == [0, 50, 100, 120]
    rows = [(tmp_path / who / "log.csv").read_text().splitlines() for who in ("command", "python")]
    speed = 6
    for a, b in zip(*rows):
        a, b = a.split(","), b.split(",")
        assert a[:speed] + a[speed + 1:] == b[:speed] + b[speed + 1:]
    assert len(rows[0]) == len(rows[1]) == 5


def test_trajectories_as_the_command_writes_them(command, tmp_path):
    every = {"run.trajectory_every": 10, "run.trajectory": "dcd"}
    final_of(command, tmp_path / "command", "chain", "--steps", 30, "--set", "run.trajectory_every=10")
    sim = taut.Simulation("chain", set=every, out=tmp_path / "python")
    sim.run(20)
    sim.run(10)
    for name in ("trajectory.dcd", "start.pdb"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "command" / name).read_bytes()


def test_molecules_and_places_of_a_dict():
    polymer = {"atoms": [{"name": "B", "mass_u": 72, "sigma_nm": 0.47, "epsilon_kj_mol": 3.5}], "units": 8,
               "bonds": [[0, 1, 0.35]], "angles": [[0, 1, 2, 120, 25]]}
    scene = {"molecule": {"polymer": polymer}, "place": [{"molecule": "polymer", "count": np.int64(3)}],
             "build": {"box_nm": 4}, "forcefield": {"cutoff_nm": 1.1},
             "run": {"dt_fs": 10, "temperature_k": 300, "seed": 3, "minimise": True}}
    sim = taut.Simulation(scene, set={"molecule.polymer.units": 10})
    sim.run(20)
    assert sim.positions.shape == (30, 3) and len(sim.bonds) == 27 and set(sim.names["atom"]) == {"B"}
    assert abs(sim.bond_errors).max() < 1e-6 and np.array_equal(sim.box, 4 * np.eye(3))
    for wrong, words in [({"place": {"molecule": "polymer"}}, "place"),
                         ({"place": [{"molecule": "polimer"}]}, "polymer"),
                         ({"molecule": {"polymer": {**polymer, "unit": 3}}}, "did you mean \"units\""),
                         ({"place": [7]}, "place")]:
        with pytest.raises(taut.InputError, match=words):
            taut.Simulation({**scene, **wrong})


@pytest.mark.parametrize("shape", ["cube", "dodecahedron"])
def test_the_box_is_a_live_view(shape):
    sim = taut.Simulation("water", set={
        "build.molecules": 216, "build.box": shape, "forcefield.cutoff_nm": 0.6, "forcefield.switch_nm": 0.5,
        "run.thermostat": "langevin", "run.temperature_k": 300, "run.barostat": "c-rescale"})
    box, before = sim.box, sim.box.copy()
    assert box.shape == (3, 3) and np.array_equal(box, np.tril(box)) and (abs(box[2, 0]) > 0.1) == (shape != "cube")
    seen = []
    sim.run(40, every=20, callback=lambda row: seen.append(np.linalg.det(box) / row.volume_nm3))
    assert not np.array_equal(box, before) and np.allclose(seen, 1, rtol=1e-12) and np.shares_memory(box, sim.box)
    with pytest.raises(ValueError, match="read-only"):
        box[0, 0] = 1
    kept = box.copy()
    del sim
    gc.collect()
    junk = [np.ones((3, 3)) for _ in range(100)]
    assert np.array_equal(box, kept) and len(junk) == 100


def test_views_are_live_and_keep_their_owner():
    sim = taut.Simulation("chain")
    x, f = sim.positions, sim.forces
    before = x.copy()
    sim.run(10)
    assert not np.array_equal(x, before) and np.shares_memory(x, sim.positions)
    assert x.flags.writeable and not f.flags.writeable
    with pytest.raises(ValueError):
        f[0] = 0
    kept = x.copy()
    del sim, f
    gc.collect()
    junk = [np.ones(x.shape) for _ in range(100)]
    assert np.array_equal(x, kept) and len(junk) == 100


def test_what_is_written_is_brought_to_the_bonds():
    sim = taut.Simulation("freely_jointed", method="newton", set={"build.chains": 2})
    energy = sim.energies["total"]
    sim.velocities[:] = 0
    assert sim.energies["total"] != energy and sim.energies["kinetic"] == 0
    sim.positions[0] += [0, 0, 0.01]
    sim.run(1)
    assert abs(sim.bond_errors).max() < 1e-9
    assert sim.energies["kinetic"] == pytest.approx(0, abs=1e-20)


def test_log_and_summary():
    sim = taut.Simulation("water", dt_fs=1, set={"build.molecules": 27, "forcefield.cutoff_nm": 0.45,
                                                 "forcefield.switch_nm": 0.4})
    assert sim.summary is None
    sim.run(100, every=20)
    log = sim.log
    assert list(log["step"]) == [0, 20, 40, 60, 80, 100]
    assert all(len(column) == 6 for column in log.values())
    assert np.allclose(log["total_kj_mol"], log["potential_kj_mol"] + log["kinetic_kj_mol"])
    assert log["pressure_bar"][-1] == pytest.approx(sim.pressure)
    assert log["temperature_k"][-1] == pytest.approx(sim.temperature)
    assert log["constraint_work_kj_mol"][-1] == pytest.approx(sim.constraint_work)
    assert sim.summary["steps"] == 100 and sim.summary["dof"] == sim.degrees_of_freedom
    assert sim.energies["total"] == pytest.approx(log["total_kj_mol"][-1], abs=1e-12)
    assert sim.tensions.shape == sim.bond_errors.shape == sim.lengths.shape == (81,)


def test_timings():
    sim = taut.Simulation("water")
    sim.run(5)
    assert sim.timings is None  # of fewer than 1000 atoms
    sim.run(10, timings=True)
    parts = sim.timings["parts"]
    assert parts["pairs"]["calls"] == 10 and "thermostat" not in parts
    assert sum(part["percent"] for part in parts.values()) == pytest.approx(100, abs=2)
    assert sum(part["ms_per_step"] for part in parts.values()) == pytest.approx(sim.timings["ms_per_step"], rel=0.02)


def test_step_is_run_without_rows():
    one, many = taut.Simulation("chain"), taut.Simulation("chain")
    for _ in range(7):
        one.step()
    one.step(3)
    many.run(10)
    assert np.array_equal(one.positions, many.positions) and np.array_equal(one.velocities, many.velocities)
    assert one.steps_taken == 10 and list(one.log["step"]) == [0]


def test_checkpoints_go_on_to_the_last_bit(tmp_path):
    settings = {"run.thermostat": "rescaling", "run.thermostat_ps": 0.1, "run.temperature_k": 300}
    sim = taut.Simulation("freely_jointed", method="feedforward", set=settings)
    sim.run(15)
    kept = sim.checkpoint(tmp_path / "kept.cbor")
    assert (tmp_path / "kept.cbor").read_bytes() == kept
    again, pickled = taut.Simulation.resume(kept), pickle.loads(pickle.dumps(sim))
    for one in (sim, again, pickled):
        one.run(15)
    assert np.array_equal(sim.positions, again.positions) and np.array_equal(sim.positions, pickled.positions)
    assert np.array_equal(sim.velocities, again.velocities) and again.steps_taken == 30


def test_a_folder_goes_on(tmp_path, command):
    sim = taut.Simulation("chain", method="newton", out=tmp_path / "run", set={"run.trajectory_every": 10})
    sim.run(20)
    del sim
    gc.collect()
    again = taut.Simulation.resume(tmp_path / "run")
    assert again.steps_taken == 20
    again.run(20)
    del again
    gc.collect()
    subprocess.run([command, "resume", str(tmp_path / "run"), "--steps", "20"], check=True, capture_output=True)
    there = final_of(command, tmp_path / "command", "chain", "--method", "newton", "--steps", 60)
    assert (tmp_path / "run" / "final.start.toml").read_text() == there


class Waters:
    """Names of atoms as an openmm.app.Topology has them."""

    def atoms(self):
        for n in range(648):
            residue, name = SimpleNamespace(name="SOL", index=n // 3), ("OX", "HA", "HB")[n % 3]
            yield SimpleNamespace(name=name, element=SimpleNamespace(symbol=name[0]), residue=residue)


def test_the_command_goes_on_with_a_run_that_has_names(tmp_path, command, data):
    system, state = data / "tip3p-216.system.xml", data / "tip3p-216.state.xml"
    taut.Simulation.from_openmm(system, state, topology=Waters(), dt_fs=1, out=tmp_path / "run").run(5)
    gc.collect()
    go_on = [command, "run", "--dt-fs", "1", "--steps", "10", "--continue", "--out", str(tmp_path / "run"), "--openmm"]
    subprocess.run([*go_on, system, state], check=True, capture_output=True)
    resumed = taut.Simulation.resume(tmp_path / "run")
    assert resumed.steps_taken == 10 and list(resumed.names["atom"][:3]) == ["OX", "HA", "HB"]
    whole = taut.Simulation.from_openmm(system, state, dt_fs=1)
    whole.run(10)
    assert np.array_equal(resumed.positions, whole.positions)
    del resumed
    gc.collect()
    other = tmp_path / "state.xml"
    other.write_text(state.read_text() + "<!-- another -->")
    refused = subprocess.run([*go_on, system, other], capture_output=True, text=True)
    assert refused.returncode == 2 and "state.xml has changed since" in refused.stderr


def test_minimise():
    sim = taut.Simulation("decane", method="newton")
    before = sim.energies["potential"]
    result = sim.minimise(200)
    assert sim.energies["potential"] < before and abs(sim.bond_errors).max() < 1e-9
    assert result.converged and 0 < result.largest_force <= 200 and 1 < result.steps < 5000
    assert result.energy_before == pytest.approx(before) and result.energy == pytest.approx(sim.energies["potential"])
    sim.run(2)


def test_a_minimisation_has_a_limit_and_says_how_far_it_is(capsys):
    sim = taut.Simulation("decane", method="newton")
    few = sim.minimise(1e-6, steps=30, progress=True)
    assert not few.converged and few.steps == 30 and few.largest_force > 1e-6
    sim.minimise(1e-6, steps=300, progress=True)
    assert re.search(r"\d+ moves +-?[\d.]+ kJ/mol +largest force [\d.]+ kJ/mol/nm", capsys.readouterr().err)
    for wrong, words in (({"steps": 0}, "steps=0"), ({"steps": 2.5}, "whole number"), ({"force_kj_mol_nm": 0}, "more than 0")):
        with pytest.raises(taut.InputError, match=words):
            sim.minimise(**wrong)
