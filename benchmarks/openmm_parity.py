#!/usr/bin/env python3
"""Compares energies and forces of real systems with OpenMM's Reference platform at equal PME parameters.

    python benchmarks/openmm_parity.py --taut build/taut [--systems DIR] [NAME ...]

Needs openmm (8.6, from PyPI), numpy and h5py. DIR holds files of OpenMM's own tests (wrappers/python/tests/systems
of its repository); without it only the files of openmm.app are compared. Prints a row a system. Exit code 1: one is
refused, or differs by more than 1e-9 of the energy or 1e-7 of the forces' rms.
"""
import argparse
import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np
import openmm as mm
from openmm import app, unit

DATA = Path(app.__file__).parent / "data"
NM = unit.nanometer
USUAL = dict(nonbondedMethod=app.PME, nonbondedCutoff=0.9 * NM, constraints=app.HBonds)


def of_forcefield(pdb, *xml, **options):
    field = app.ForceField(*xml)
    return field.createSystem(pdb.topology, **{**USUAL, **options}), pdb.positions


def solvated(pdb, *xml, **options):
    modeller = app.Modeller(pdb.topology, pdb.positions)
    field = app.ForceField(*xml)
    modeller.addHydrogens(field)
    modeller.addSolvent(field, padding=0.8 * NM, ionicStrength=0.15 * unit.molar, **options)
    return field.createSystem(modeller.topology, **USUAL), modeller.positions


def amber(d, name):
    coordinates = app.AmberInpcrdFile(str(d / f"{name}.inpcrd"))
    top = app.AmberPrmtopFile(str(d / f"{name}.prmtop"), periodicBoxVectors=coordinates.boxVectors)
    return top.createSystem(**USUAL), coordinates.positions


def charmm(d, name, coordinates, edges, *parameters):
    psf = app.CharmmPsfFile(str(d / f"{name}.psf"))
    psf.setBox(*(edge * NM for edge in edges))
    parameters = app.CharmmParameterSet(*(str(d / f) for f in parameters))
    return psf.createSystem(parameters, **USUAL, switchDistance=0.75 * NM), coordinates.positions


def gromacs(d, name, coordinates, **options):
    gro = app.GromacsGroFile(str(d / coordinates))
    top = app.GromacsTopFile(str(d / f"{name}.top"), periodicBoxVectors=gro.getPeriodicBoxVectors())
    return top.createSystem(**{**USUAL, **options}), gro.positions


def brought():
    """What openmm.app brings: name -> a function that makes (system, positions)."""
    pdb = lambda name: app.PDBFile(str(DATA / name))
    charmm36 = ("charmm36.xml", "charmm36/water.xml")
    return {
        "tip3p": lambda: of_forcefield(pdb("tip3p.pdb"), "tip3p.xml"),
        "tip4pew": lambda: of_forcefield(pdb("tip4pew.pdb"), "tip4pew.xml"),
        "tip5p": lambda: of_forcefield(pdb("tip5p.pdb"), "tip5p.xml"),
        "villin-amber14": lambda: of_forcefield(pdb("test.pdb"), "amber14-all.xml", "amber14/tip3pfb.xml"),
        "villin-charmm36": lambda: of_forcefield(pdb("test.pdb"), *charmm36, switchDistance=0.75 * NM),
        "villin-charmm36-2024": lambda: of_forcefield(pdb("test.pdb"), "charmm36_2024.xml", "charmm36_2024/water.xml"),
        "villin-all-bonds": lambda: of_forcefield(
            pdb("test.pdb"), "amber14-all.xml", "amber14/tip3p.xml", constraints=app.AllBonds),
        "lipids-amber14": lambda: of_forcefield(pdb("DPPC.pdb"), "amber14-all.xml", "amber14/tip3p.xml"),
        "lipids-charmm36": lambda: of_forcefield(pdb("DPPC.pdb"), *charmm36),
    }


def of_tests(d):
    """Those of OpenMM's tests, in folder d."""
    nucleic = lambda: app.PDBFile(str(d / "nucleic.pdb"))
    pdb = lambda name: app.PDBFile(str(d / name))
    crd = lambda name: app.CharmmCrdFile(str(d / name))
    return {
        "ala2": lambda: amber(d, "alanine-dipeptide-explicit"),
        "dna-ions": lambda: solvated(nucleic(), "amber14-all.xml", "amber14/tip3p.xml"),
        "dna-dodecahedron": lambda: solvated(
            nucleic(), "amber14-all.xml", "amber14/tip3p.xml", boxShape="dodecahedron"),
        "ala3-charmm": lambda: charmm(d, "ala3_solv", crd("ala3_solv.crd"), (3.271195, 3.299596, 3.300715),
                                     "par_all36_prot.prm", "toppar_water_ions.str"),
        "dhfr-charmm": lambda: charmm(d, "5dhfr_cube", pdb("5dhfr_cube.pdb"), (6.223, 6.223, 6.223),
                                     "charmm22.rtf", "charmm22.par"),
        "nbfix-gromacs": lambda: gromacs(d, "apgr.nbfix.nopairs.comb2", "apgr.gro", nonbondedMethod=app.NoCutoff),
        "geometric-gromacs": lambda: gromacs(
            d, "apgr.nonbfix.nopairs.comb3", "apgr.gro", nonbondedMethod=app.NoCutoff),
    }


def reference(system, positions):
    """A Context of OpenMM's Reference platform, bonds at their lengths; the System says PME's parameters."""
    platform = mm.Platform.getPlatformByName("Reference")
    for _ in range(2):
        context = mm.Context(system, mm.VerletIntegrator(0.001), platform)
        pme = [f for f in system.getForces() if isinstance(f, mm.NonbondedForce) and f.getNonbondedMethod() == f.PME]
        if not pme or pme[0].getPMEParameters()[1] != 0:
            break
        pme[0].setPMEParameters(*pme[0].getPMEParametersInContext(context))
    context.setPositions(positions)
    context.applyConstraints(1e-12)
    context.computeVirtualSites()
    return context


def of_taut(taut, system, context, folder):
    """taut's energy, forces, and positions, which it mends to the last digit of the bonds."""
    (folder / "system.xml").write_text(mm.XmlSerializer.serialize(system))
    (folder / "state.xml").write_text(mm.XmlSerializer.serialize(context.getState(getPositions=True)))
    ran = subprocess.run(
        [taut, "run", "--openmm", folder / "system.xml", folder / "state.xml", "--method", "newton", "--steps", "1",
         "--precision", "double", "--dt-fs", "1e-6", "--set", "run.trajectory=h5md", "run.trajectory_every=1",
         "run.log_every=1", "--out", folder / "out"], capture_output=True, text=True)
    if ran.returncode:
        raise RuntimeError(ran.stderr.strip().splitlines()[-1])
    with open(folder / "out" / "log.csv") as log:
        energy = float(next(csv.DictReader(log))["Potential Energy (kJ/mole)"])
    with h5py.File(folder / "out" / "trajectory.h5md") as frames:
        atoms = frames["particles/all"]
        return energy, atoms["force/value"][0], atoms["position/value"][0]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--taut", default="build/taut")
    arguments.add_argument("--systems", type=Path)
    arguments.add_argument("names", nargs="*")
    given = arguments.parse_args()
    systems = brought() | (of_tests(given.systems) if given.systems else {})
    failed = False
    print("system,atoms,constraints,energy_kj_mol,energy_rel_error,force_error_rms", flush=True)
    for name in given.names or systems:
        with tempfile.TemporaryDirectory() as folder:
            try:
                system, positions = systems[name]()
                context = reference(system, positions)
                energy, ours, at = of_taut(given.taut, system, context, Path(folder))
                context.setPositions(at)
                state = context.getState(getEnergy=True, getForces=True)
                theirs = state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole)
                forces = state.getForces(asNumpy=True)._value
                real = [a for a in range(len(forces)) if not system.isVirtualSite(a)]
                error = abs(energy / theirs - 1)
                off = np.abs(ours - forces)[real].max() / np.sqrt((forces[real] ** 2).mean())
                failed |= not (error < 1e-9 and off < 1e-7)
                print(f"{name},{len(forces)},{system.getNumConstraints()},{theirs:.6f},{error:.1e},{off:.1e}", flush=True)
            except Exception as e:  # a row that says so, and on to the next
                failed = True
                print(f"{name},,,,,{e}", flush=True)
    sys.exit(failed)


if __name__ == "__main__":
    main()
