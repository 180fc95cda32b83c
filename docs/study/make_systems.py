#!/usr/bin/env python3
"""Makes the study's systems that are not in the repository, from what it has and what OpenMM's package brings.

    docs/study/make_systems.py FOLDER [--taut build/taut]

Needs OpenMM and ParmEd (pip install openmm parmed). FOLDER/NAME.system.xml and .state.xml are for taut and OpenMM,
NAME.top and .gro for GROMACS. In water: PME to 0.9 nm, no dispersion correction, minimised, and 5 ps at 300 K by taut at
1 fs with a friction of 5/ps. What is there is not made again.

- villin, with other rigid bonds and masses villin-KIND: the headpiece in water, ff14SB and TIP3P (8867 atoms)
- dna-water: the repository's DNA of ten base pairs in TIP3P with 0.15 mol/L of sodium chloride, Amber14 (OL15)
- dipeptide-all: the repository's alanine dipeptide in water with all bonds rigid
- dipeptide-vacuum: the repository's alanine dipeptide without its water (22 atoms)
"""
import argparse
import gzip
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
from xml.etree import ElementTree

import numpy

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DATA = ROOT / "tests/data"
sys.path.insert(0, str(ROOT / "benchmarks"))


def make(folder, taut):
    makers = {"villin-angles-3u": make_villin, "dna-water": make_dna, "dipeptide-all": make_dipeptide_all,
              "dipeptide-vacuum": make_dipeptide}
    for name, maker in makers.items():
        if not (folder / f"{name}.state.xml").exists():
            with tempfile.TemporaryDirectory(dir=folder) as half:  # what a kill leaves is not taken for a system
                maker(pathlib.Path(half), taut)
                for file in pathlib.Path(half).iterdir():
                    file.replace(folder / file.name)


def make_villin(folder, taut):
    import openmm.app as app
    import parmed
    import real_systems

    kinds = {"villin": app.HBonds, "villin-all": app.AllBonds, "villin-angles": app.HAngles, "villin-3u": app.HBonds,
             "villin-angles-3u": app.HAngles}
    pdb = app.PDBFile(str(pathlib.Path(app.__file__).parent / "data" / "test.pdb"))
    described = real_systems.from_forcefield(pdb, "amber14-all.xml", "amber14/tip3p.xml")
    save(described, folder, "villin")
    real_systems.settle_down(folder, "villin", taut)
    for heavy in (False, True):
        if heavy:  # takes the mass from the atom that the hydrogen is bonded to; not in waters
            parmed.tools.HMassRepartition(described, 3).execute()
        for kind in (kind for kind in kinds if kind.endswith("-3u") == heavy):
            if kind != "villin":
                described.save(str(folder / f"{kind}.top"), overwrite=True)
                shutil.copy(folder / "villin.gro", folder / f"{kind}.gro")
            real_systems.write_xml(folder, kind, kinds[kind])
            bring_to_bath(folder, kind, taut)
            real_systems.write_xml(folder, kind, kinds[kind])


def make_dna(folder, taut):
    """Puts the DNA into a rectangular box with 0.8 nm of water on each side."""
    import openmm
    import openmm.app as app
    import openmm.unit as unit
    import real_systems

    system, state = own("dna-hbonds")
    xml = "amber14-all.xml", "amber14/tip3p.xml"
    modeller = app.Modeller(topology_of(system), state.getPositions())
    edges = numpy.ptp(state.getPositions(asNumpy=True).value_in_unit(unit.nanometer), axis=0) + 1.6
    random.seed(1)  # OpenMM chooses at random which waters become ions
    modeller.addSolvent(app.ForceField(*xml), boxSize=openmm.Vec3(*edges) * unit.nanometer, ionicStrength=0.15 * unit.molar)
    save(real_systems.from_forcefield(modeller, *xml), folder, "dna-water")
    real_systems.settle_down(folder, "dna-water", taut)
    real_systems.write_xml(folder, "dna-water")
    bring_to_bath(folder, "dna-water", taut)
    real_systems.write_xml(folder, "dna-water")


def own(name):
    """The repository's System and State of this name."""
    import openmm

    return [openmm.XmlSerializer.deserialize(gzip.open(DATA / f"{name}.{kind}.xml.gz", "rt").read())
            for kind in ("system", "state")]


def topology_of(system):
    """The topology of nucleic acids whose System is all that there is; a nucleotide begins at its phosphorus."""
    import openmm
    import openmm.app as app

    springs = next(force for force in system.getForces() if isinstance(force, openmm.HarmonicBondForce))
    bonds = [springs.getBondParameters(k)[:2] for k in range(springs.getNumBonds())]
    bonds += [system.getConstraintParameters(k)[:2] for k in range(system.getNumConstraints())]
    joined = [False] * system.getNumParticles()  # to the atom before
    for i, j in bonds:
        for k in range(min(i, j) + 1, max(i, j) + 1):
            joined[k] = True
    topology, atoms = app.Topology(), []
    for i in range(system.getNumParticles()):
        element = app.Element.getByMass(system.getParticleMass(i))
        if not joined[i]:
            chain = topology.addChain()
        if not joined[i] or element.symbol == "P":
            residue = topology.addResidue("N", chain)
        atoms.append(topology.addAtom(f"{element.symbol}{len(list(residue.atoms())) + 1}", element, residue))
    for i, j in bonds:
        topology.addBond(atoms[i], atoms[j])
    return topology


def make_dipeptide_all(folder, taut):
    """Makes the springs between two atoms rigid at the lengths where they rest."""
    import openmm

    system, state = own("ala2-hbonds-rf")
    number, springs = next(each for each in enumerate(system.getForces()) if isinstance(each[1], openmm.HarmonicBondForce))
    for k in range(springs.getNumBonds()):
        system.addConstraint(*springs.getBondParameters(k)[:3])
    system.removeForce(number)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setState(state)
    context.applyConstraints(1e-8)
    context.applyVelocityConstraints(1e-8)
    state = context.getState(positions=True, velocities=True)
    for kind, thing in (("system", system), ("state", state)):
        (folder / f"dipeptide-all.{kind}.xml").write_text(openmm.XmlSerializer.serialize(thing))


def make_dipeptide(folder, taut, atoms=22):
    """Takes the first atoms of the dipeptide in water, with what acts between them."""
    for kind in ("system", "state"):
        tree = ElementTree.parse(gzip.open(DATA / f"ala2-hbonds-rf.{kind}.xml.gz"))
        for parent in list(tree.iter()):
            if parent.tag in ("Particles", "Positions", "Velocities", "Forces"):
                del parent[atoms:]
            if parent.get("type") == "NonbondedForce":
                parent.set("method", "0")  # no cutoff
            for term in [term for term in parent if max(int(term.get(f"p{n}", 0)) for n in range(1, 5)) >= atoms]:
                parent.remove(term)
        tree.write(folder / f"dipeptide-vacuum.{kind}.xml")


def save(described, folder, name):
    described.save(str(folder / f"{name}.top"), overwrite=True)
    described.save(str(folder / f"{name}.gro"), overwrite=True, precision=7)


def bring_to_bath(folder, kind, taut):
    import real_systems
    with tempfile.TemporaryDirectory() as out:
        subprocess.run([taut, "run", "--openmm", folder / f"{kind}.system.xml", folder / f"{kind}.state.xml", "--threads", "1",
                        "--steps", "5000", "--dt-fs", "1", "--set", "run.thermostat=langevin", "run.friction_per_ps=5",
                        "run.temperature_k=300", "--out", out], check=True, stdout=subprocess.DEVNULL)
        real_systems.write_gro_of(folder / f"{kind}.gro", out)


def main():
    ask = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    ask.add_argument("folder", type=pathlib.Path)
    ask.add_argument("--taut", default=str(ROOT / "build/taut"))
    asked = ask.parse_args()
    asked.folder.mkdir(parents=True, exist_ok=True)
    make(asked.folder, asked.taut)


if __name__ == "__main__":
    main()
