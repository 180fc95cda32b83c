"""taut's forces in ASE: against numerical gradients, against taut's own steps, and what is refused."""

import copy
import pickle

import numpy as np
import pytest

import taut

ase = pytest.importorskip("ase", reason="needs ASE from PyPI: pip install ase")
from ase.calculators.calculator import PropertyNotImplementedError  # noqa: E402
from ase.constraints import FixAtoms, FixBondLengths  # noqa: E402
from ase.md.verlet import VelocityVerlet  # noqa: E402
from ase.optimize import FIRE  # noqa: E402
from ase.units import fs, kJ, mol  # noqa: E402

WATER = {"build.molecules": 64, "forcefield.cutoff_nm": 0.55, "forcefield.switch_nm": 0.5, "run.seed": 3}
FLUID = {"molecule": {"a": {"atoms": [{"name": "A", "mass_u": 40, "sigma_nm": 0.3, "epsilon_kj_mol": 1}], "units": 4,
                            "springs": [[0, 1, 0.3, 3000]], "angles": [[0, 1, 2, 110, 80]]}},
         "place": [{"molecule": "a", "count": 40}], "build": {"box_nm": [2, 0, 0, 0.6, 2.1, 0, -0.5, 0.7, 2.2]},
         "forcefield": {"cutoff_nm": 0.8, "switch_nm": 0.6}, "run": {"dt_fs": 1, "seed": 2, "minimise": True}}


def droplet(**more):
    return taut.Simulation({"build": {"kind": "water", "model": "tip3p", "shape": "droplet", "molecules": 6,
                                      "density_g_cm3": 1},
                            "run": {"dt_fs": 1, "temperature_k": 300, "seed": 5}}, **more)


def test_what_is_no_simulation_is_refused():
    with pytest.raises(taut.InputError, match="expected a taut.Simulation, got 3"):
        taut.Calculator(3)


def slope_of_energy(atoms, atom, axis, by=1e-4):
    energies = []
    for sign in (1, -1):
        moved = atoms.copy()
        moved.calc = atoms.calc
        moved.positions[atom, axis] += sign * by
        energies.append(moved.get_potential_energy(apply_constraint=False))
    return (energies[0] - energies[1]) / (2 * by)


def test_energy_and_forces_are_those_of_the_simulation_and_its_slope_off_the_bonds():
    sim = taut.Simulation("water", set=WATER)
    before = sim.positions.copy()
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    assert atoms.get_potential_energy() == pytest.approx(sim.energies["potential"] * kJ / mol, rel=1e-12)
    assert np.allclose(atoms.get_velocities() * 1000 * fs, 10 * sim.velocities)
    atoms.set_constraint()
    atoms.calc = taut.Calculator(sim, bonds="free")
    atoms.positions += np.random.default_rng(1).normal(0, 0.02, (192, 3))
    forces = atoms.get_forces()
    for atom in (0, 1, 101):
        for axis in range(3):
            assert forces[atom, axis] == pytest.approx(-slope_of_energy(atoms, atom, axis), rel=1e-6, abs=1e-7)
    assert np.array_equal(sim.positions, before)


def test_stress_is_the_energys_slope_by_strain_in_any_orientation():
    sim = taut.Simulation(FLUID)
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    atoms.rotate(50, (1, 2, 3), rotate_cell=True)
    energy, stress = atoms.get_potential_energy(), atoms.get_stress(voigt=False)
    assert energy == pytest.approx(sim.energies["potential"] * kJ / mol, rel=1e-9)
    for i, j in ((0, 0), (1, 2), (2, 0)):
        by, energies = 1e-5, []
        for sign in (1, -1):
            strained = atoms.copy()
            strained.calc = atoms.calc
            strain = np.eye(3)
            strain[i, j] += sign * by / 2
            strain[j, i] += sign * by / 2
            strained.set_cell(atoms.cell @ strain, scale_atoms=True)
            energies.append(strained.get_potential_energy())
        assert stress[i, j] == pytest.approx((energies[0] - energies[1]) / (2 * by) / atoms.get_volume(), rel=1e-5)
    forces = atoms.get_forces()
    atoms.wrap()
    assert np.allclose(atoms.get_forces(), forces, atol=1e-9) and np.abs(forces).max() > 0.01
    assert forces[3, 0] == pytest.approx(-slope_of_energy(atoms, 3, 0), rel=1e-6)


def test_ases_dynamics_with_its_fixed_bonds_are_tauts():
    sim = droplet()
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    VelocityVerlet(atoms, 1 * fs).run(4)
    sim.step(4)
    assert np.allclose(atoms.positions / 10, sim.positions, atol=1e-9)
    assert np.allclose(atoms.get_velocities() * 1000 * fs / 10, sim.velocities, atol=1e-7)
    sim.positions = atoms.positions / 10
    assert abs(sim.bond_errors).max() < 1e-10


def test_ase_optimises_with_fixed_bonds():
    sim = droplet()
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    first = atoms.get_potential_energy()
    FIRE(atoms, logfile=None).run(steps=15)
    assert atoms.get_potential_energy() < first - 0.5
    i, j = sim.bonds.T
    assert np.allclose(np.linalg.norm(atoms.positions[j] - atoms.positions[i], axis=1), 10 * sim.lengths, rtol=1e-9)


def test_bonds_that_nothing_holds_are_refused_by_name():
    sim = droplet()
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    last = tuple(sim.bonds[-1].tolist())
    for constraint, words in ((FixBondLengths(sim.bonds[:-1]), f"the bond {last[0]}-{last[1]} is rigid"),
                              (FixBondLengths(sim.bonds, bondlengths=10.5 * sim.lengths), "and its length is"),
                              (FixAtoms([0, 1]), "no FixBondLengths of the atoms holds")):
        atoms.set_constraint(constraint)
        atoms.positions += 1e-6
        with pytest.raises(taut.InputError, match=words):
            atoms.get_forces()
    atoms.set_constraint([FixBondLengths(sim.bonds[1:]), FixAtoms(sim.bonds[0])])
    assert np.isfinite(atoms.get_potential_energy())


def test_what_cannot_be_is_refused():
    sim = taut.Simulation("water", set=WATER)
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    with pytest.raises(PropertyNotImplementedError, match="of the force field alone"):
        atoms.get_stress()
    atoms.calc = taut.Calculator(sim, bonds="free")
    assert atoms.get_stress().shape == (6,)
    atoms.pbc = False
    with pytest.raises(taut.InputError, match="pbc"):
        atoms.get_forces()
    with pytest.raises(taut.InputError, match="expected the simulation's 192"):
        taut.Calculator(sim).calculate(atoms[:3])
    atoms.pbc = True
    atoms.set_cell([10, 20, 20])
    with pytest.raises(taut.InputError, match="cutoff"):
        atoms.get_forces()
    with pytest.raises(taut.InputError, match="virtual site"):
        taut.Calculator(taut.Simulation("water", set={**WATER, "build.model": "tip4pew"}))
    with pytest.raises(taut.InputError, match="expected 'fixed' or 'free'"):
        taut.Calculator(sim, bonds="loose")


def test_own_forces_count_and_calculators_are_copied():
    class Well(taut.Force):
        def add(self, positions, forces):
            forces -= 2 * positions
            return float((positions**2).sum())

    sim = droplet(forces=[Well()])
    atoms = sim.to_ase()
    atoms.calc = taut.Calculator(sim)
    energy = atoms.get_potential_energy()
    assert energy == pytest.approx(sim.energies["potential"] * kJ / mol, rel=1e-12)
    again = copy.deepcopy(atoms.calc)
    assert isinstance(again, taut.Calculator) and again.get_potential_energy(atoms) == pytest.approx(energy)
    plain = taut.Calculator(droplet())
    assert pickle.loads(pickle.dumps(plain)).get_potential_energy(atoms) == plain.get_potential_energy(atoms) != energy
