"""Other fixes and commands on the same atoms: carried out, or refused by name."""

import numpy as np
import pytest

import inputs
import lammps
import systems

THERMO = "thermo_style custom step temp pe etotal press f_hold[1]\nthermo_modify format float %.15g\nthermo 10\n"
HALVES = "group low id 1:65\ngroup high id 66:135\n"  # 13 and 14 molecules of five atoms


def methane(run, rest="", ranks=1, integrate="fix move all nve", hold="fix hold all taut feedforward b 1", head=""):
    text = inputs.of(inputs.METHANE, dt=0.002, integrate=head + integrate, rest=rest)
    return run(text.replace("fix hold all taut feedforward b 1", hold), ranks)


def refused(run, *args, **given):
    with pytest.raises(lammps.Failed) as failed:
        methane(run, *args, **given)
    assert "Fix taut hold" in str(failed.value)
    return str(failed.value)


# --- fixes that stand beside it ---

@pytest.mark.parametrize("body", ["rigid/nve molecule", "rigid/small molecule"])
def test_rigid_bodies_of_the_same_atoms(run, body):
    assert "rigid body of fix turn" in refused(run, "run 0\n", head=HALVES, integrate=f"fix move high nve\nfix turn low {body}")


def test_rigid_bodies_of_other_atoms(run):
    methane(run, "run 10\n", head=HALVES, integrate="fix move high nve\nfix turn low rigid/nve molecule",
            hold="fix hold high taut feedforward b 1")


def test_two_fixes_hold_bonds_of_different_molecules(run):
    """With fix taut on all molecules every number is the same."""
    holds = "fix hold low taut feedforward b 1\nfix other high taut feedforward b 1"
    both = lammps.table(methane(run, THERMO + "run 50\n", head=HALVES, hold=holds))
    one = lammps.table(methane(run, THERMO + "run 50\n", head=HALVES))
    assert np.allclose(both["TotEng"], one["TotEng"], rtol=1e-6)
    assert np.allclose(both["Temp"], one["Temp"], rtol=1e-6)


def test_two_fixes_on_atoms_of_one_molecule(folder, run):
    chains = systems.chains(6, 40)
    chains.bonds = [(1 + k % 2, i, j) for k, (_, i, j) in enumerate(chains.bonds)]
    (folder / "chains.data").write_text(chains.text([1.0]))
    text = inputs.of(inputs.CHAINS, dt=0.002, rest="fix other all taut feedforward b 2\nrun 0\n")
    text = text.replace("bond_coeff 1", "bond_coeff *")
    with pytest.raises(lammps.Failed, match="by one fix"):
        run(text)


def test_a_barostat_that_stands_before_is_told_of(run):
    npt = "fix move all npt temp 1 1 0.2 iso 0.1 0.1 2.0"
    assert "begins lacks the constraint" in methane(run, "run 0\n", integrate=npt)
    assert "begins lacks" not in methane(run, npt + "\nrun 0\n", integrate="")


def test_the_first_pressure_is_the_barostats_where_it_stands_after(run):
    npt = "fix move all npt temp 1 1 0.2 iso 0.1 0.1 2.0"
    methane(run, npt + "\nrun 20\n", integrate="")


# --- springs on pairs that are held ---

def sprung(folder, run, rest="", types="1", **given):
    """Methane with springs beside its bonds, half of them listed the other way round."""
    data = systems.methane()
    data.bonds += [(2, i, j) if j % 2 else (2, j, i) for _, i, j in data.bonds]
    (folder / "methane.data").write_text(data.text([12.0, 1.0]))
    text = inputs.of(inputs.METHANE, dt=0.002, rest=rest, **given).replace("bond_coeff 1", "bond_coeff 2 100 1.2\nbond_coeff 1")
    return run(text.replace("b 1\n", f"b {types}\n"), given.get("ranks", 1))


@pytest.mark.parametrize("given", [{}, {"newton": "off"}, {"ranks": 2}])
def test_springs_beside_held_bonds_add_their_energy_alone(folder, run, given):
    alone = lammps.table(methane(run, THERMO + "run 50\n"))
    both = lammps.table(sprung(folder, run, THERMO + "run 50\n", **given))
    assert np.allclose(both["PotEng"] - alone["PotEng"], 4 * 100 * 0.2**2 / 5, rtol=1e-6)  # of an atom
    assert np.allclose(both["Temp"], alone["Temp"], rtol=1e-6)


@pytest.mark.parametrize("given", [{}, {"newton": "off"}, {"ranks": 2}])
def test_two_bonds_of_a_pair_are_not_both_held(folder, run, given):
    with pytest.raises(lammps.Failed, match="atoms \\d+ and \\d+ have 2 bonds of the types .* name its type alone"):
        sprung(folder, run, types="*", **given)


def test_a_held_bond_made_a_spring_is_told_of(folder, run):
    with pytest.raises(lammps.Failed, match="held bonds are not in the list"):
        sprung(folder, run, "run 5\nset group all bond 2\nrun 5\n")


# --- bonds that change under it ---

CHANGES = {
    "set": "set group all bond 1\n",
    "undo": "delete_bonds all bond 1 undo\n",
}


@pytest.mark.parametrize("change", CHANGES)
def test_types_of_held_bonds_set_anew(run, change):
    assert "made or changed" in refused(run, "run 5\n" + CHANGES[change] + "run 5\n")


def test_bonds_that_are_deleted(run):
    assert "not in the list of bonds" in refused(run, "run 5\ngroup one id 1:5\ndelete_bonds one multi remove\nrun 5\n")


def test_a_bond_counts_as_one_where_one_of_its_atoms_is_deleted(run):
    rest = "run 5\ngroup end id 1\ndelete_atoms group end compress no\nrun 5\n"
    with pytest.raises(lammps.Failed, match="1 held bond is not in the list of bonds"):
        run(inputs.of(inputs.CHAINS, dt=0.002, rest=rest))


def test_bonds_that_are_made(folder, run):
    text = inputs.of(inputs.CHAINS, dt=0.002, rest="fix join all bond/create 1 1 1 1.08 1 iparam 3 1 jparam 3 1\nrun 100\n")
    chains = systems.chains(6, 40).text([1.0]).replace("240 atoms", "240 atoms\n2 extra bond per atom\n30 extra special per atom")
    (folder / "chains.data").write_text(chains)
    with pytest.raises(lammps.Failed, match="made or changed"):
        run(text)


def test_bonds_that_are_swapped(folder, run):
    chains = systems.chains(6, 40)
    chains.molecules = [1 + min(k % 40, 39 - k % 40) for k in range(240)]
    (folder / "chains.data").write_text(chains.text([1.0]))
    text = inputs.of(inputs.CHAINS, dt=0.002, rest="compute pe all pe\nfix swap all bond/swap 1 1.0 3.0 12345\nrun 100\n")
    with pytest.raises(lammps.Failed, match="made or changed"):
        run(text.replace("special_bonds lj 0 0 0", "special_bonds lj 0 1 1"))


MOLECULE = """
5 atoms
4 bonds

Coords

1 0.0 0.0 0.0
2 0.57735026919 0.57735026919 0.57735026919
3 0.57735026919 -0.57735026919 -0.57735026919
4 -0.57735026919 0.57735026919 -0.57735026919
5 -0.57735026919 -0.57735026919 0.57735026919

Types

1 1
2 2
3 2
4 2
5 2

Charges

1 0
2 0
3 0
4 0
5 0

Bonds

1 {type} 1 2
2 {type} 1 3
3 {type} 1 4
4 {type} 1 5
"""
ADDS = {
    "deposit": "region box block 0 9 0 9 0 9\nfix add all deposit 1 0 5 7 region box mol new near 1.0 attempt 5000\n",
    "gcmc": "fix add all gcmc 5 20 0 0 7 1.0 20.0 0 mol new tfac_insert 1 group all\n",
}


@pytest.mark.parametrize("fix", ADDS)
@pytest.mark.parametrize("bond", [1, 2])
def test_fixes_that_add_molecules(folder, run, fix, bond):
    """Bonds that they make of a held type are refused; of another type they are springs, and the run goes on."""
    data = systems.methane().text([12.0, 1.0]).replace("1 bond types", "2 bond types")
    data = data.replace("0 angle types", "0 angle types\n4 extra bond per atom\n30 extra special per atom")
    (folder / "methane.data").write_text(data)
    (folder / "methane.txt").write_text(MOLECULE.format(type=bond))
    head = "bond_coeff * 100 1.0\nmolecule new methane.txt\n"
    if bond == 1:
        assert "molecules added" in refused(run, ADDS[fix] + "run 10\n", head=head)
    else:
        assert "Total wall time" in methane(run, ADDS[fix] + THERMO + "run 20\n", head=head)


@pytest.mark.parametrize("change", ["fix swell all adapt 1 bond harmonic r0 1 v_d\n", ""])
def test_lengths_that_change_in_a_run(run, change):
    steps = 'run 40\n' if change else 'run 40 pre no every 10 "bond_coeff 1 100 1.01"\n'
    rest = "variable d equal 1.0+0.0002*step\n" + change + ("" if change else "run 0\n") + steps
    assert "was held at 1 and has" in refused(run, rest)


def test_lengths_that_change_between_runs(run):
    found = lammps.table(methane(run, THERMO + "run 20\nbond_coeff 1 100 1.02\nrun 40\n"))
    assert found["f_hold[1]"].max() < 1e-8


def test_atoms_are_numbered_anew(run):
    with pytest.raises(lammps.Failed, match="stor(es|ing) atom IDs"):
        methane(run, "run 0\nreset_atom_ids\nrun 0\n")


# --- atoms that do not move ---

FROZEN = "group anchor id 1 6 11\ngroup free subtract all anchor\nvelocity anchor set 0 0 0\n"


def test_held_atoms_that_nothing_moves_are_told_of(run):
    output = methane(run, "neigh_modify delay 0 every 5 check no\nrun 50\n", head=FROZEN, integrate="fix move free nve")
    assert "every held atom must be moved by velocity Verlet" in output


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("method, off", [("feedforward", 1e-8), ("baumgarte", 1e-4), ("feedforward clear yes", 1e-8)])
def test_fixed_atoms(folder, run, ranks, method, off):
    """Their bonds hold, they stay, energy is kept, and the others lose one degree of freedom for each of these bonds."""
    rest = "velocity anchor set 0 0 0\nvariable d equal 2*ke/temp\ncompute t free temp\ncompute_modify t extra/dof 0\n" \
           "compute pull anchor reduce sum fx\nthermo_style custom step c_t ke etotal f_hold[1] c_pull\n" \
           "thermo_modify norm no format float %.15g\nthermo 10\nrun 200\n"
    output = methane(run, rest + inputs.END.format(dump="last.dump"), ranks, head=FROZEN, integrate="fix move free nve",
                     hold=f"fix hold all taut {method} fixed anchor b 1")
    found = lammps.table(output)
    assert "velocity Verlet" not in output
    assert found["f_hold[1]"][1:].max() < off and np.isfinite(found["c_pull"]).all()
    assert np.ptp(found["TotEng"]) < 2e-2 * found["KinEng"].max()
    assert np.allclose(2 * found["KinEng"] / found["c_t"], 3 * (135 - 3) - 108, rtol=1e-9)
    assert np.abs(lammps.dump(folder / "last.dump")[[0, 5, 10], 3:]).max() == 0


def test_a_group_that_is_none(run):
    assert 'no group "walls"' in refused(run, hold="fix hold all taut feedforward fixed walls b 1")


# --- rerun and minimisation ---

def test_rerun_leaves_frames_as_they_are(folder, run):
    frames = "dump d all custom 10 {} id xu yu zu vx vy vz\ndump_modify d format float %.16g sort id\n"
    moved = "displace_atoms all random 1e-4 1e-4 1e-4 5\nreset_timestep 0\n"
    methane(run, moved + "write_dump all custom first.dump id x y z vx vy vz modify format float %.16g\n")
    methane(run, frames.format("again.dump") + THERMO + "rerun first.dump dump x y z vx vy vz\n")
    methane(run, frames.format("plain.dump") + "unfix hold\nrerun first.dump dump x y z vx vy vz\n")
    assert np.abs(lammps.dump(folder / "again.dump") - lammps.dump(folder / "plain.dump")).max() == 0


@pytest.mark.parametrize("style", ["fire", "quickmin"])
def test_minimisers_that_integrate(run, style):
    output = methane(run, THERMO + f"min_style {style}\nminimize 0 1e-4 3000 30000\nvelocity all create 1 3 loop geom\nrun 40\n")
    energies = lammps.table(output, 0)["PotEng"]
    assert energies[-1] < energies[0]
    assert lammps.table(output)["f_hold[1]"][1:].max() < 1e-8
