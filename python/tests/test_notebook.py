"""What notebooks do daily: run a cell twice, assign to arrays, misspell, look at a simulation."""

import numpy as np
import pytest

import taut

SMALL = {"build.molecules": 64, "forcefield.cutoff_nm": 0.55, "forcefield.switch_nm": 0.5}


def test_a_simulation_closes_its_folder(tmp_path):
    with taut.Simulation("chain", out=tmp_path / "run") as sim:
        sim.run(5)
        assert sim.folder
    assert sim.folder == "" and sim.steps_taken == 5 and sim.summary["steps"] == 5
    with pytest.raises(RuntimeError, match="it is closed"):
        sim.run(1)
    again = taut.Simulation.resume(tmp_path / "run")
    again.run(5)
    assert again.steps_taken == 10


def test_a_cell_runs_twice(tmp_path):
    kept = []  # as a notebook keeps what a cell returned
    for _ in range(2):
        sim = taut.Simulation("chain", out=tmp_path / "run", overwrite=True)
        sim.run(5)
        kept.append(sim)
    assert kept[0].folder == "" and (tmp_path / "run.1" / "log.csv").exists()
    with pytest.raises(taut.InputError, match=r"another Simulation of this process writes there; call its close\(\)"):
        taut.Simulation("chain", out=str(tmp_path / "x" / ".." / "run"))
    for _ in range(2):
        kept.append(taut.Simulation.resume(tmp_path / "run"))
    assert kept[1].folder == kept[2].folder == "" and kept[3].folder


def test_a_running_simulation_is_not_closed(tmp_path):
    sim = taut.Simulation("chain", out=tmp_path / "run")

    def close(row):
        with pytest.raises(RuntimeError, match="it is running"):
            taut.Simulation("chain", out=tmp_path / "run", overwrite=True)

    sim.run(4, every=2, callback=close)
    assert sim.folder and sim.steps_taken == 4


def test_arrays_are_assigned():
    sim, other = taut.Simulation("freely_jointed"), taut.Simulation("freely_jointed")
    sim.velocities *= 0.5
    other.velocities = other.velocities / 2
    sim.positions += [0.1, 0.2, 0.3]
    other.positions = (other.positions + [0.1, 0.2, 0.3]).tolist()
    for one in (sim, other):
        one.run(10)
    assert np.array_equal(sim.positions, other.positions)
    before = sim.positions.copy()
    for wrong, words in [(np.zeros((2, 3)), "positions: expected .* rows"), (0, "positions: expected .* rows"),
                         ("x", "positions: expected"), (before * np.nan, "positions: expected finite")]:
        with pytest.raises(taut.InputError, match=words):
            sim.positions = wrong
    assert np.array_equal(sim.positions, before)


@pytest.mark.parametrize("coulomb", ["reaction-field", "pme"])
def test_the_box_is_assigned(coulomb):
    settings = {**SMALL, "forcefield.coulomb": coulomb}
    if coulomb == "pme":  # a tolerance would choose another grid for another box
        settings.update({"forcefield.ewald_alpha_per_nm": 4.0, "forcefield.pme_grid": [24, 24, 24]})
    sim = taut.Simulation("water", set=settings)
    sim.run(5)
    box = 1.05 * sim.box
    sim.box = box
    assert np.array_equal(sim.box, box)
    again = taut.Simulation.from_openmm(*sim.to_openmm_xml(), dt_fs=sim.dt_fs)
    assert np.array_equal(again.box, box)
    assert sim.energies["potential"] == pytest.approx(again.energies["potential"], rel=1e-9)
    energy, x = sim.energies["potential"], sim.positions.copy()
    for wrong, words in [([1, 1, 1], "box: .*cutoff"), ([1, 1], "box: expected 3 rows"), ([-2, 2, 2], "box: ")]:
        with pytest.raises(taut.InputError, match=words):
            sim.box = wrong
    assert np.array_equal(sim.box, box) and np.array_equal(sim.positions, x) and sim.energies["potential"] == energy
    sim.box = np.diag(box)
    sim.run(5)
    resumed = taut.Simulation.resume(sim.checkpoint())
    assert np.array_equal(resumed.box, box)
    with pytest.raises(taut.InputError, match="box: the system has none"):
        taut.Simulation("pair").box = [2, 2, 2]


def test_the_box_of_bonds_that_go_around_it_stays(tmp_path):
    atoms = "".join(f"{n + 1} 1 1 {n / 3} {0.2 * (n % 2)} 0\n" for n in range(3))
    (tmp_path / "loop.data").write_text(f"loop\n\n3 atoms\n3 bonds\n1 atom types\n1 bond types\n\n0 1 xlo xhi\n0 1 ylo yhi\n"
                                        f"0 1 zlo zhi\n\nMasses\n\n1 10\n\nBond Coeffs # harmonic\n\n1 1 0.39\n\n"
                                        f"Atoms # bond\n\n{atoms}\nBonds\n\n1 1 1 2\n2 1 2 3\n3 1 3 1\n")
    (tmp_path / "loop.toml").write_text('[build]\nkind = "lammps"\ndata = "loop.data"\nunits = "lj"\nrigid_bonds = [1]\n')
    sim = taut.Simulation(tmp_path / "loop.toml")
    with pytest.raises(taut.InputError, match="box: a cluster of rigid bonds goes around it"):
        sim.box = [1.1, 1, 1]
    sim.run(5)


def test_a_box_that_forces_refuse_is_undone():
    class Wall(taut.Force):
        broken = False

        def add(self, positions, forces):
            return 1 / 0 if self.broken else 0.0

    wall = Wall()
    sim = taut.Simulation("water", set=SMALL, forces=[wall])
    box, energy = sim.box.copy(), sim.energies["potential"]
    wall.broken = True
    with pytest.raises(ZeroDivisionError):
        sim.box = 1.1 * box
    wall.broken = False
    assert np.array_equal(sim.box, box) and sim.energies["potential"] == pytest.approx(energy, rel=1e-9)
    sim.run(3)


def test_misspelt_names_are_refused():
    sim = taut.Simulation("pair")
    with pytest.raises(AttributeError, match="a Simulation has no attribute temprature; did you mean temperature"):
        sim.temprature = 3
    with pytest.raises(AttributeError, match="temperature cannot be set; positions, velocities, box, dt_fs, method, "
                       "thermostat and barostat can"):
        sim.temperature = 3
    with pytest.raises(AttributeError, match="a Simulation has no attribute qwertz$"):
        sim.qwertz = 3
    with pytest.raises(AttributeError, match="a Simulation has no attribute positon; did you mean positions"):
        sim.positon
    assert not hasattr(sim, "_repr_png_") and getattr(sim, "shape", None) is None  # which notebooks and numpy ask for
    with pytest.raises(AttributeError, match="module 'taut' has no attribute Ratle; did you mean Rattle"):
        taut.Ratle
    with pytest.raises(taut.InputError, match=r'^run.sed=3: unknown key "sed" in \[run\]; did you mean "seed"'):
        taut.Simulation("pair", set={"run.sed": 3})

    class Mine(taut.Simulation):
        pass

    mine = Mine("pair")
    mine.label = "mine"
    with pytest.raises(AttributeError, match="did you mean velocities"):
        mine.velocites = 0
    for wrong, meant in [("project_position", "project_positions"), ("add_force", "add_forces"),
                         ("project_velocity", "project_velocities"), ("promised_eror", "promised_error")]:
        with pytest.raises(TypeError, match=f"Typo.{wrong}: .*did you mean {meant}"):
            type("Typo", (taut.ConstraintMethod,), {wrong: lambda self: None})
    type("Fine", (taut.ConstraintMethod,), {"project": None, "project_positions": None, "project_position": None})
    with pytest.raises(taut.InputError, match=r"Silent has no method add\(self, positions, forces\)"):
        taut.Simulation("pair", forces=[type("Silent", (taut.Force,), {"ad": None})()])


def test_numbers_of_steps():
    sim = taut.Simulation("pair")
    sim.run(1e2, every=np.int64(50))
    sim.step(2.0)
    assert sim.steps_taken == 102 and list(sim.log["step"]) == [0, 50, 100]
    for wrong in (1.5, "ten", None, True, float("nan"), float("inf")):
        with pytest.raises(taut.InputError, match=r"run\(steps\): expected a whole number, got"):
            sim.run(wrong)
    with pytest.raises(taut.InputError, match=r"run\(steps\): 100000000000000000000 is too large"):
        sim.run(10**20)
    with pytest.raises(taut.InputError, match=r"run\(4611686018427387904\): expected 1 to 2\*\*50 steps"):
        sim.run(2.0**62)


def test_checkpoints_of_every_kind(tmp_path):
    sim = taut.Simulation("chain", out=tmp_path / "run")
    sim.run(5)
    kept = sim.checkpoint(tmp_path / "x.cbor")
    for given in (tmp_path / "x.cbor", str(tmp_path / "x.cbor"), bytearray(kept), memoryview(kept)):
        again = taut.Simulation.resume(given)
        assert again.steps_taken == 5 and np.array_equal(again.positions, sim.positions)
    (tmp_path / "junk").write_bytes(b"junk")
    with pytest.raises(taut.InputError, match="not a checkpoint"):
        taut.Simulation.resume(tmp_path / "junk")


def test_precision():
    double, mixed = (taut.Simulation("water", set=SMALL, precision=name) for name in ("double", "mixed"))
    assert 0 < abs(double.energies["potential"] - mixed.energies["potential"]) < 0.1
    with pytest.raises(taut.InputError, match="precision.*single"):
        taut.Simulation("water", precision="single")
    with pytest.raises(taut.InputError, match="said twice"):
        taut.Simulation("water", precision="mixed", set={"forcefield.precision": "double"})
    from_xml = taut.Simulation.from_openmm(*double.to_openmm_xml(), dt_fs=2, precision="mixed")
    assert from_xml.energies["potential"] != double.energies["potential"]


def test_a_notebook_shows_a_table():
    sim = taut.Simulation("chain", set={"run.seed": 2})
    assert "last row" not in sim._repr_html_()
    sim.run(10)
    shown = sim._repr_html_()
    assert shown.startswith("<table>") and shown.count("<tr>") == shown.count("</tr>") == 8
    assert "<td style='text-align:left'>10 (" in shown and "step 10: " in shown and sim.method in shown


def test_a_bar_shows_progress(capfd):
    sim, plain = taut.Simulation("water", set=SMALL), taut.Simulation("water", set=SMALL)
    sim.run(500, progress=True)
    plain.run(500)
    shown = capfd.readouterr().err
    assert shown.endswith("\n") and "[####################] 100 %  500 of 500 steps" in shown
    assert "ns/day" in shown and "left" in shown and np.array_equal(sim.positions, plain.positions)
    bar = taut.progress.RunProgress(100, 1000, 2.0)
    assert bar.text(250, 10.0) == "[#####               ]  25 %  250 of 1000 steps  4.32 ns/day  0:30 left"


def test_a_universe_goes_both_ways(tmp_path):
    MDAnalysis = pytest.importorskip("MDAnalysis", reason="needs MDAnalysis (Debian: python3-mdanalysis)")
    sim = taut.Simulation("water", set=SMALL)
    sim.run(20)
    universe = sim.universe()
    assert len(universe.residues) == 64 and len(universe.bonds) == 3 * 64
    assert universe.select_atoms("name O*").n_atoms == 64
    assert np.allclose(universe.atoms.positions, 10 * sim.positions, atol=1e-5)
    assert np.allclose(universe.dimensions[:3], 10 * np.diag(sim.box), atol=1e-5)
    other = taut.Simulation("water", set=SMALL)
    other.box, other.positions, other.velocities = universe, universe, universe
    assert np.allclose(other.positions, sim.positions, atol=1e-6)
    assert np.allclose(other.velocities, sim.velocities, atol=1e-5)
    assert other.energies["potential"] == pytest.approx(sim.energies["potential"], abs=0.05)
    system = sim.to_openmm_xml()[0]
    again = taut.Simulation.from_openmm(system, universe, topology=universe, dt_fs=2)
    assert np.allclose(again.positions, sim.positions, atol=1e-6)
    assert np.allclose(again.velocities, sim.velocities, atol=1e-5)
    assert again.names["atom"].tolist() == sim.names["atom"].tolist()
    assert again.names["residue_index"][-1] == 63
    still = MDAnalysis.Universe.empty(192, trajectory=True)
    with pytest.raises(taut.InputError, match="velocities: the universe's frame has none"):
        other.velocities = still
    with pytest.raises(taut.InputError, match="positions: expected 192 rows"):
        other.positions = universe.atoms[:5]
