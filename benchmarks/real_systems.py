#!/usr/bin/env python3
"""Makes molecules of other people's as GROMACS's .top and .gro, from what OpenMM's repository brings.

    benchmarks/real_systems.py OPENMM --out FOLDER [--systems dhfr,charmm,lipid,dna]

OPENMM is a checkout of https://github.com/openmm/openmm. Needs OpenMM and ParmEd (pip install openmm parmed), whose
writer makes GROMACS's files, so that all programs read the same numbers; step_peers.py --real FOLDER times them.

- ala2: alanine dipeptide in water, Amber (2269 atoms)
- dhfr: dihydrofolate reductase in water, ff99SB and TIP3P, OpenMM's own benchmark (23,558 atoms)
- dhfr8, dhfr48: the same eight and 48 times over (188,464 and 1,130,784 atoms)
- charmm: the same protein with CHARMM22's parameters, correction maps and Urey-Bradley terms (23,558 atoms)
- lipid: a patch of DPPC, Lipid17 and TIP3P (28,160 atoms)
- dna: DNA with RNA in TIP3P with 0.15 mol/L of sodium chloride, Amber14 (53,259 atoms)

FOLDER/NAME.top and .gro are GROMACS's, .system.xml and .state.xml what OpenMM's reader makes of them, after 1 ps at 300 K
by taut: PME to 0.9 nm, no dispersion correction, rigid bonds of hydrogen and rigid waters.
"""
import argparse
import itertools
import math
import pathlib
import random
import re
import subprocess
import tempfile
import tomllib

import numpy
import openmm
import openmm.app as app
import openmm.unit as unit
import parmed

EXAMPLES = "examples/benchmarks"
TESTS = "wrappers/python/tests/systems"
CHARMM = "examples/python-examples"


def from_forcefield(pdb, *xml):
    """Describes a PDB file's molecules by one of OpenMM's force fields."""
    system = app.ForceField(*xml).createSystem(pdb.topology, rigidWater=False)
    described = parmed.openmm.load_topology(pdb.topology, system, pdb.positions)
    described.box = parmed.openmm.load_topology(pdb.topology).box
    return described


def make_dhfr(openmm):
    return from_forcefield(app.PDBFile(str(openmm / EXAMPLES / "5dfr_solv-cube_equil.pdb")), "amber99sb.xml", "tip3p.xml")


def make_charmm(openmm):
    described = parmed.charmm.CharmmPsfFile(str(openmm / TESTS / "5dhfr_cube.psf"))
    described.load_parameters(parmed.charmm.CharmmParameterSet(
        str(openmm / CHARMM / "charmm22.rtf"), str(openmm / CHARMM / "charmm22.par")))
    for kind in {atom.atom_type for atom in described.atoms}:  # CHARMM writes wells as negative numbers
        kind.set_lj_params(abs(kind.epsilon), kind.rmin, abs(kind.epsilon_14), kind.rmin_14)
    described.coordinates = app.PDBFile(str(openmm / TESTS / "5dhfr_cube.pdb")).getPositions(asNumpy=True) / unit.angstrom
    described.box = [62.23, 62.23, 62.23, 90, 90, 90]
    return described


def make_lipid(openmm):
    return from_forcefield(app.PDBFile(str(pathlib.Path(app.__file__).parent / "data" / "DPPC.pdb")),
                           "amber14/lipid17.xml", "amber14/tip3p.xml")


def make_dna(openmm):
    random.seed(1)  # OpenMM chooses at random which waters become ions
    pdb = app.PDBFile(str(openmm / TESTS / "nucleic.pdb"))
    modeller = app.Modeller(pdb.topology, pdb.positions)
    xml = "amber14-all.xml", "amber14/tip3p.xml"
    modeller.addSolvent(app.ForceField(*xml), padding=1 * unit.nanometer, ionicStrength=0.15 * unit.molar)
    return from_forcefield(modeller, *xml)


def make_ala2(openmm):
    path = str(openmm / TESTS / "alanine-dipeptide-explicit")
    return parmed.load_file(f"{path}.prmtop", f"{path}.inpcrd")


COPIES = {"dhfr8": ("dhfr", (2, 2, 2)), "dhfr48": ("dhfr", (4, 4, 3))}  # of what, and how often along each edge
MAKERS = {"ala2": make_ala2, "dhfr": make_dhfr, "charmm": make_charmm, "lipid": make_lipid, "dna": make_dna}


def write_copies(folder, name, counts):
    """Writes NAMEn.top and NAMEn.gro: the system repeated counts[d] times along each edge of its rectangular box."""
    copies = math.prod(counts)
    head, molecules = re.split(r"(?=\[ molecules \])", (folder / f"{name}.top").read_text())
    title, *rows = molecules.splitlines()
    counted = "\n".join(row for row in rows if row.strip() and not row.startswith(";"))
    (folder / f"{name}{copies}.top").write_text(head + title + "\n" + (counted + "\n") * copies)
    _, _, *atoms, box = (folder / f"{name}.gro").read_text().splitlines()
    edges = [float(edge) for edge in box.split()]
    if len(edges) != 3:
        raise SystemExit(f"{name}: expected a rectangular box, got {box}")
    numbers = lambda row: [float(c) for c in row[20:].split()]
    rows = [(row[:20], [c + edge * k for c, edge, k in zip(numbers(row), edges, cell)], numbers(row)[3:])
            for cell in itertools.product(*map(range, counts)) for row in atoms]
    write_gro(folder / f"{name}{copies}.gro", rows, [n * edge for n, edge in zip(counts, edges)])


def write_gro(path, rows, edges):
    """Writes rows of (residue and atom, positions [nm], velocities [nm/ps]) with seven decimals."""
    lines = [head + "".join(f"{c:12.7f}" for c in (*x, *v)) for head, x, v in rows]
    path.write_text("\n".join([path.stem, str(len(lines)), *lines, " ".join(f"{edge:.7f}" for edge in edges)]) + "\n")


def write_xml(folder, name, constraints=app.HBonds, **options):
    """Writes NAME.system.xml and NAME.state.xml of what GROMACS's files say, with PME to 0.9 nm."""
    _, _, *atoms, edges = (folder / f"{name}.gro").read_text().splitlines()  # OpenMM reads three decimals alone
    rows = [[float(c) for c in row[20:].split()] for row in atoms]
    box = [openmm.Vec3(*row) for row in numpy.diag([float(edge) for edge in edges.split()])]
    system = app.GromacsTopFile(str(folder / f"{name}.top"), periodicBoxVectors=box * unit.nanometer).createSystem(
        nonbondedMethod=app.PME, nonbondedCutoff=0.9 * unit.nanometer, constraints=constraints, removeCMMotion=False, **options)
    for force in system.getForces():
        if isinstance(force, openmm.NonbondedForce):
            force.setUseDispersionCorrection(False)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions([row[:3] for row in rows])
    if len(rows[0]) == 6:
        context.setVelocities([row[3:] for row in rows])
    else:
        context.setVelocitiesToTemperature(300 * unit.kelvin, 1)
    (folder / f"{name}.system.xml").write_text(openmm.XmlSerializer.serialize(system))
    (folder / f"{name}.state.xml").write_text(openmm.XmlSerializer.serialize(
        context.getState(getPositions=True, getVelocities=True)))


def settle_down(folder, name, taut):
    """Minimises the energy, runs 1 ps at 300 K, and writes the end as NAME.gro."""
    write_xml(folder, name)
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([taut, "run", "--openmm", folder / f"{name}.system.xml", folder / f"{name}.state.xml", "--steps", "1000",
                        "--dt-fs", "1", "--precision", "mixed", "--set", "run.minimise=true", "run.temperature_k=300",
                        "run.thermostat=langevin", "--out", out], check=True, stdout=subprocess.DEVNULL)
        write_gro_of(folder / f"{name}.gro", out)


def write_gro_of(path, run):
    """Writes the end of the run in folder `run` to the .gro file, whose names of atoms stay."""
    start = tomllib.loads((pathlib.Path(run) / "final.start.toml").read_text())
    heads = [row[:20] for row in path.read_text().splitlines()[2:-1]]
    write_gro(path, [(head, row[:3], row[3:]) for head, row in zip(heads, start["atoms"])], start["box_nm"])


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("openmm", type=pathlib.Path)
    arguments.add_argument("--out", type=pathlib.Path, required=True)
    arguments.add_argument("--systems", default="dhfr,dhfr8,charmm,lipid,dna")
    arguments.add_argument("--taut", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "build" / "taut")
    told = arguments.parse_args()
    told.out.mkdir(parents=True, exist_ok=True)
    for name in told.systems.split(","):
        if name in COPIES:
            write_copies(told.out, *COPIES[name])
        else:
            described = MAKERS[name](told.openmm)
            described.save(str(told.out / f"{name}.top"), overwrite=True)
            described.save(str(told.out / f"{name}.gro"), overwrite=True, precision=7)
            settle_down(told.out, name, told.taut)
        write_xml(told.out, name)
        print(f"{name}: {(told.out / f'{name}.gro').read_text().splitlines()[1]} atoms", flush=True)


if __name__ == "__main__":
    main()
