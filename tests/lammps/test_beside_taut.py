"""The same melt and water in LAMMPS and in taut itself: forces of constraint, and where atoms go."""

import os
import pathlib
import sys

import numpy as np
import pytest

import lammps
import systems

sys.path.append(os.environ.get("TAUT_PYTHON", str(pathlib.Path(lammps.PROGRAM).parent / "python")))
try:
    import taut
except ImportError as missing:  # not built, or not for this Python
    pytest.skip(f"the module taut: {missing}", allow_module_level=True)

COULOMB = 138.93545764438198  # kJ/mol nm/e²
MELT = dict(scene="melt", given={}, kinds=1, masses=[1.0], charges=[0.0], angles=False, styles="""
pair_style lj/cut 1.122462048309373
pair_coeff 1 1 1.0 1.0
bond_coeff 1 100 0.97
""")
WATER = dict(scene="water", given={"forcefield.rf_dielectric": 1, "forcefield.dispersion_correction": False}, kinds=3,
             masses=[15.99943, 1.007947], charges=np.sqrt(COULOMB) * np.array([-0.834, 0.417, 0.417]), angles=True,
             styles="""
pair_style lj/cut/coul/cut 0.9
pair_coeff * * 0 1
pair_coeff 1 1 0.6364 0.315061
bond_coeff 1 100 0.09572
angle_style harmonic
angle_coeff 1 100 104.52
""")

# taut's own units (nm, u, ps, kJ/mol) are consistent, as LAMMPS's lj units are.
INPUT = """
units lj
atom_style full
read_data start.data
bond_style harmonic
{styles}
special_bonds lj/coul 0 {special}
neighbor 0.05 bin
neigh_modify every 1 delay 0 check yes
comm_modify cutoff {reach}
timestep {dt}
fix move all nve
fix hold all taut {method} store yes b 1 {angles}
dump b all local 1 bonds.dump f_hold[1] f_hold[2] f_hold[3]
dump_modify b format float %.17g
run {steps}
write_dump all custom last.dump id xu yu zu modify sort id format float %.17g
"""


def in_lammps(folder, system, sim, method, steps):
    """Tensions by bond, positions."""
    n, kinds = len(sim.masses), system["kinds"]
    bonds = [(1, i + 1, j + 1) for i, j in sim.bonds if not (system["angles"] and i % 3 == 1)]
    angles = [(1, i + 2, i + 1, i + 3) for i in range(0, n, 3)] if system["angles"] else []
    atoms = ([min(i % kinds, 1) + 1 for i in range(n)], [1] * n, [system["charges"][i % kinds] for i in range(n)], sim.positions)
    text = systems.Topology(atoms, bonds, angles, np.diag(sim.box)).text(system["masses"])
    velocities = [f"{i + 1} {v[0]:.17g} {v[1]:.17g} {v[2]:.17g}" for i, v in enumerate(sim.velocities)]
    (folder / "start.data").write_text(text + "\n".join(["", "Velocities", "", *velocities, ""]))
    lammps.run(folder, INPUT.format(styles=system["styles"], method=method, dt=sim.dt_fs / 1000, steps=steps,
                                    special="0 0" if angles else "1 1", reach=12 * sim.lengths.max(), angles="a 1" if angles else ""))
    rows = (folder / "bonds.dump").read_text().split("ITEM: ENTRIES")[1].split("ITEM:")[0].splitlines()[1:]
    tension = {(int(a) - 1, int(b) - 1): float(t) for a, b, t in (row.split() for row in rows)}
    return np.array([tension[tuple(sorted(bond))] for bond in sim.bonds.tolist()]), lammps.dump(folder / "last.dump")


@pytest.mark.parametrize("system", [MELT, WATER], ids=["melt", "water"])
def test_forces_of_constraint(tmp_path, system):
    """Of constrained acceleration, which is what taut's tensions are."""
    sim = taut.Simulation(system["scene"], method="newton", set=system["given"])
    found, _ = in_lammps(tmp_path, system, sim, "none", 0)
    assert np.abs(found - sim.tensions).max() < 1e-10 * np.abs(sim.tensions).max()


@pytest.mark.parametrize("system", [MELT, WATER], ids=["melt", "water"])
@pytest.mark.parametrize("method, near", [("feedforward", 1e-10), ("baumgarte", 1e-9)])
def test_atoms_go_where_they_go_in_taut(tmp_path, system, method, near):
    tight = {"method.tolerance": 1e-14} if method == "feedforward" else {}
    sim = taut.Simulation(system["scene"], method=method, set={**system["given"], **tight})
    options = " tol 1e-14" if tight else ""
    _, found = in_lammps(tmp_path, system, sim, method + options, 20)
    sim.step(20)
    assert np.abs(found - sim.positions).max() < near * np.abs(sim.positions).max()
