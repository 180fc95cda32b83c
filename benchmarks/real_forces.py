#!/usr/bin/env python3
"""Compares potential energy and forces of taut, GROMACS and OpenMM on other people's molecules, at equal settings.

    GMX=/path/to/gmx benchmarks/real_forces.py FOLDER [--systems dhfr,charmm,lipid,dna]

FOLDER is real_systems.py's. PME has the same α and grid everywhere, order 4 beside GROMACS and 5 beside OpenMM, whose
orders these are. Prints relative differences from taut in double precision: of the potential energy, and of the forces,
rms over rms (those of GROMACS's trajectories are without constraint forces). OpenMM's platform is Reference. Needs openmm, MDAnalysis and taut's Python module.
"""
import argparse
import pathlib
import subprocess
import tempfile

import MDAnalysis
import numpy
import openmm
import openmm.unit as unit
import taut

import machine
import peer_gromacs
import peer_systems


def of_taut(prepared, order, precision):
    settings = {"forcefield.pme_order": order, "forcefield.ewald_alpha_per_nm": prepared.alpha,
                "forcefield.pme_grid": list(prepared.mesh), "forcefield.precision": precision}
    sim = taut.Simulation.from_openmm(str(prepared.file("system.xml")), str(prepared.file("state.xml")), set=settings)
    return sim.energies["potential"], numpy.array(sim.forces), numpy.array(sim.positions)


def of_openmm(prepared, positions):
    system = openmm.XmlSerializer.deserialize(prepared.file("system.xml").read_text())
    for force in system.getForces():
        if isinstance(force, openmm.NonbondedForce):
            force.setPMEParameters(prepared.alpha, *prepared.mesh)
    context = openmm.Context(system, openmm.VerletIntegrator(0.001), openmm.Platform.getPlatformByName("Reference"))
    context.setPositions(positions)
    state = context.getState(getEnergy=True, getForces=True)
    return (state.getPotentialEnergy().value_in_unit(unit.kilojoule_per_mole),
            state.getForces(asNumpy=True).value_in_unit(unit.kilojoule_per_mole / unit.nanometer))


def of_gromacs(program, prepared, positions):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_mdp = peer_gromacs.put_input(prepared, folder)
        rows = (folder / "in.gro").read_text().splitlines()
        rows[2:-1] = [row[:20] + "".join(f"{c:14.9f}" for c in x) for row, x in zip(rows[2:-1], positions)]
        (folder / "in.gro").write_text("\n".join(rows) + "\n")
        write_mdp(0)
        (folder / "in.mdp").write_text((folder / "in.mdp").read_text() + "nstfout = 1\ncoulomb-modifier = none\n")
        run = lambda *a, **more: subprocess.run([program, "-nobackup", *a], cwd=folder, check=True, capture_output=True, **more)
        run("grompp", "-f", "in.mdp", "-c", "in.gro", "-p", "in.top", "-o", "in.tpr", "-maxwarn", "9")
        run("mdrun", "-s", "in.tpr", "-ntomp", "1", "-ntmpi", "1", "-o", "f.trr")
        run("energy", "-f", "ener.edr", "-dp", "-o", "e.xvg", input=b"Potential\n\n")
        energy = float((folder / "e.xvg").read_text().splitlines()[-1].split()[1])
        frame = MDAnalysis.coordinates.TRR.TRRReader(str(folder / "f.trr"), convert_units=False)[0]
        return energy, numpy.array(frame.forces)


def rms(a):
    return numpy.sqrt(numpy.mean(a * a))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--systems", default="dhfr,charmm,lipid,dna")
    told = parser.parse_args()
    print(f"# {machine.describe()}; OpenMM {openmm.version.full_version}; "
          f"{'; '.join(map(peer_gromacs.version, peer_gromacs.engines()))}")
    for name in told.systems.split(","):
        prepared = peer_systems.Prepared(name, told.folder)
        for order in (4, 5):
            energy, forces, positions = of_taut(prepared, order, "double")
            mixed = of_taut(prepared, order, "mixed")
            others = {"taut, mixed": mixed[:2]}
            if order == 5:
                others["OpenMM Reference"] = of_openmm(prepared, positions)
            else:
                for program in peer_gromacs.engines():
                    others["GROMACS"] = of_gromacs(program, prepared, positions)
            for other, (its_energy, its_forces) in others.items():
                print(f"{name:8} order {order}  {other:18} energy {abs(its_energy / energy - 1):.1e}  "
                      f"forces {rms(its_forces - forces) / rms(forces):.1e}", flush=True)


if __name__ == "__main__":
    main()
