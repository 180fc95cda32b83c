"""A case as sander's topology, and its restart files in netCDF."""

from __future__ import annotations

from pathlib import Path
from typing import Any, List, Tuple

import numpy as np
from scipy.io import netcdf_file

from shared import Case

PS = 20.455  # of sander's units of time in a ps
KCAL = 4.184


def section(name: str, form: str, values: List[Any]) -> str:
    """A block of the topology file."""
    count = {"20a4": 20, "10I8": 10, "3E24.16": 3}[form]
    text = [f"{v:<4}" if form == "20a4" else f"{v:8d}" if form == "10I8" else f"{v:24.16E}" for v in values]
    lines = ["".join(text[k : k + count]) for k in range(0, len(text), count)] or [""]
    return "\n".join([f"%FLAG {name}", f"%FORMAT({form})", *lines])


def write_topology(case: Case, folder: Path) -> None:
    """Bonds are listed as those with hydrogen, each with a type of its own; springs as those without."""
    system = case["system"]
    n, bonds = len(system["masses_u"]), system["bonds"]
    springs = [f for f in system["forces"] if f["kind"] == "harmonic_bond"]
    angles = [f for f in system["forces"] if f["kind"] == "harmonic_angle"]
    torsions = [f for f in system["forces"] if f["kind"] == "periodic_torsion"]
    if any(f["kind"] not in ("harmonic_bond", "harmonic_angle", "periodic_torsion") for f in system["forces"]):
        raise NotImplementedError("forces other than springs along bonds, of angles and torsions are not written by this runner")
    pointers = [n, 1, len(bonds), len(springs), 0, len(angles), 0, len(torsions), 0, 0, n, 1, len(springs), len(angles),
                len(torsions), len(bonds) + len(springs), len(angles), len(torsions), 1, 0] + [0] * 8 + [n, 0, 0]
    rigid = [v for k, b in enumerate(bonds, 1) for v in (3 * b["atoms"][0], 3 * b["atoms"][1], k)]
    soft = [v for k, f in enumerate(springs, len(bonds) + 1) for v in (*(3 * a for a in f["atoms"]), k)]
    bent = [v for k, f in enumerate(angles, 1) for v in (*(3 * a for a in f["atoms"]), k)]
    turned = [v for k, f in enumerate(torsions, 1) for v in (*(3 * a for a in f["atoms"]), k)]
    blocks = [
        section("TITLE", "20a4", ["case"]), section("POINTERS", "10I8", pointers),
        section("ATOM_NAME", "20a4", ["H"] * n), section("CHARGE", "3E24.16", [0.0] * n),
        section("ATOMIC_NUMBER", "10I8", [1] * n), section("MASS", "3E24.16", system["masses_u"]),
        section("ATOM_TYPE_INDEX", "10I8", [1] * n), section("NUMBER_EXCLUDED_ATOMS", "10I8", [1] * n),
        section("NONBONDED_PARM_INDEX", "10I8", [1]), section("RESIDUE_LABEL", "20a4", ["RES"]),
        section("RESIDUE_POINTER", "10I8", [1]),
        section("BOND_FORCE_CONSTANT", "3E24.16", [1.0] * len(bonds) + [f["k_kj_per_mol_nm2"] / KCAL / 200 for f in springs]),
        section("BOND_EQUIL_VALUE", "3E24.16", [10 * b["length_nm"] for b in bonds] + [10 * f["length_nm"] for f in springs]),
        section("ANGLE_FORCE_CONSTANT", "3E24.16", [f["k_kj_per_mol_rad2"] / KCAL / 2 for f in angles]),
        section("ANGLE_EQUIL_VALUE", "3E24.16", [f["angle_rad"] for f in angles]),
        section("DIHEDRAL_FORCE_CONSTANT", "3E24.16", [f["k_kj_per_mol"] / KCAL for f in torsions]),
        section("DIHEDRAL_PERIODICITY", "3E24.16", [float(f["periodicity"]) for f in torsions]),
        section("DIHEDRAL_PHASE", "3E24.16", [f["phase_rad"] for f in torsions]),
        section("SCEE_SCALE_FACTOR", "3E24.16", [1.2] * len(torsions)), section("SCNB_SCALE_FACTOR", "3E24.16", [2.0] * len(torsions)),
        section("SOLTY", "3E24.16", [0.0]), section("LENNARD_JONES_ACOEF", "3E24.16", [0.0]),
        section("LENNARD_JONES_BCOEF", "3E24.16", [0.0]), section("BONDS_INC_HYDROGEN", "10I8", rigid),
        section("BONDS_WITHOUT_HYDROGEN", "10I8", soft), section("ANGLES_INC_HYDROGEN", "10I8", []),
        section("ANGLES_WITHOUT_HYDROGEN", "10I8", bent), section("DIHEDRALS_INC_HYDROGEN", "10I8", []),
        section("DIHEDRALS_WITHOUT_HYDROGEN", "10I8", turned), section("EXCLUDED_ATOMS_LIST", "10I8", [0] * n),
        section("HBOND_ACOEF", "3E24.16", []), section("HBOND_BCOEF", "3E24.16", []), section("HBCUT", "3E24.16", []),
        section("AMBER_ATOM_TYPE", "20a4", ["H"] * n), section("TREE_CHAIN_CLASSIFICATION", "20a4", ["M"] * n),
        section("JOIN_ARRAY", "10I8", [0] * n), section("IROTAT", "10I8", [0] * n),
        section("RADIUS_SET", "20a4", ["none"]), section("RADII", "3E24.16", [1.0] * n), section("SCREEN", "3E24.16", [1.0] * n)]
    (folder / "prmtop").write_text("%VERSION  VERSION_STAMP = V0001.000  DATE = 01/01/26  00:00:00\n" + "\n".join(blocks) + "\n")


def write_restart(path: Path, x: np.ndarray, v: np.ndarray) -> None:
    with netcdf_file(path, "w", version=2) as file:
        file.title = "case"
        file.Conventions, file.ConventionVersion, file.program, file.programVersion = "AMBERRESTART", "1.0", "case", "1"
        file.createDimension("atom", len(x))
        file.createDimension("spatial", 3)
        file.createVariable("spatial", "c", ("spatial",))[:] = np.array(["x", "y", "z"], dtype="S1")
        time = file.createVariable("time", "d", ())
        time.data[...] = 0.0
        time.units = "picosecond"
        for name, values in (("coordinates", 10 * x), ("velocities", 10 * v / PS)):
            made = file.createVariable(name, "d", ("atom", "spatial"))
            made.units = "angstrom" if name == "coordinates" else "angstrom/picosecond"
            made[:] = values
            if name == "velocities":
                made.scale_factor = PS


def read_restart(path: Path) -> Tuple[np.ndarray, np.ndarray]:
    with netcdf_file(path, mmap=False) as file:
        x, v = (np.array(file.variables[key][:], dtype=float) for key in ("coordinates", "velocities"))
    return x / 10, v * PS / 10
