"""A case as the lines of a LAMMPS input and data file.

`units lj` has no constants: nm, ps, u and kJ/mol fit as they are.
"""

from __future__ import annotations

from math import acos, degrees, sqrt
from typing import Any, Dict, List

import numpy as np

from forces import COULOMB
from shared import BOLTZMANN, clusters, start_velocities

Case = Dict[str, Any]
FAR = 1e4  # nm: half the edge of the box of a case that has none


class Unsayable(Exception):
    """LAMMPS has no words for something in the case."""


class Topology:
    """Types of atoms, and bonds, angles and dihedrals with the coefficients of their types, numbered from 1."""

    def __init__(self, case: Case) -> None:
        self.rows: Dict[str, List[List[int]]] = {"Bonds": [], "Angles": [], "Dihedrals": []}
        self.types: Dict[str, List[str]] = {"Bonds": [], "Angles": [], "Dihedrals": []}
        self.rigid: Dict[str, set] = {"Bonds": set(), "Angles": set()}

    def add(self, section: str, coefficients: str, atoms: List[int], rigid: bool = False) -> None:
        key = coefficients + (" # rigid" if rigid else "")
        if key not in self.types[section]:
            self.types[section].append(key)
        kind = self.types[section].index(key) + 1
        self.rows[section].append([kind, *[a + 1 for a in atoms]])
        if rigid:
            self.rigid[section].add(kind)


def add_rigid_bonds(case: Case, topology: Topology) -> None:
    """Bonds; of a triangle two bonds of one length and the angle between them, as fix shake wants it."""
    for atoms in clusters(case):
        listed = [(tuple(sorted(bond["atoms"])), bond["length_nm"]) for bond in case["system"]["bonds"]
                  if bond["atoms"][0] in atoms]
        here = dict(listed)
        if len(atoms) == 3 and len(here) == len(listed) == 3:
            for centre in atoms:
                a, b = (other for other in atoms if other != centre)
                da, db = here[tuple(sorted((centre, a)))], here[tuple(sorted((centre, b)))]
                if da == db:
                    break
            pair = tuple(sorted((a, b)))
            cosine = (da**2 + db**2 - here[pair] ** 2) / (2 * da * db)
            if abs(cosine) > 1:
                raise Unsayable("a triangle is two bonds and the angle between them, which this one has not")
            angle = degrees(acos(cosine))
            listed = [(other, d) for other, d in listed if other != pair]
            topology.add("Angles", f"1 {angle:.17g}", [a, centre, b], rigid=True)
        for pair, d in listed:
            topology.add("Bonds", f"1 {d:.17g}", list(pair), rigid=True)


def nonbonded_lines(case: Case, force: Case, types: List[Any]) -> List[str]:
    charged = any(force["charges_e"])
    if charged and "cutoff_nm" in force:
        raise Unsayable("no reaction field: Coulomb forces end at a cutoff by a damped shift or not at all")
    cut = force.get("cutoff_nm", FAR / 2)
    lines = [f"pair_style {'lj/cut/coul/cut' if charged else 'lj/cut'} {cut:.17g}", "pair_modify shift no"]
    for i, (_, si, ei) in enumerate(types):
        for j, (_, sj, ej) in enumerate(types[i:], i):
            lines.append(f"pair_coeff {i + 1} {j + 1} {sqrt(ei * ej):.17g} {max((si + sj) / 2, 1e-9):.17g}")
    return lines


def molecule_ids(case: Case) -> List[int]:
    """The molecule of each atom: that of the excluded pairs and bonds, from 1; 0 for a lone atom."""
    pairs = [pair for force in case["system"]["forces"] for pair in force.get("excluded", [])]
    joined = {"system": {"bonds": [*case["system"]["bonds"], *[{"atoms": pair} for pair in pairs]]}}
    ids = [0] * len(case["system"]["masses_u"])
    for number, atoms in enumerate(clusters(joined), 1):
        for atom in atoms:
            ids[atom] = number
        if pairs and len(atoms) * (len(atoms) - 1) // 2 != sum(set(p) <= set(atoms) for p in pairs):
            raise Unsayable("excluded pairs are those of whole molecules")
    return ids


def force_lines(case: Case, number: int, force: Case) -> List[str]:
    kind, name, lines = force["kind"], f"f{number}", []
    if kind == "gravity":
        g = np.array(force["acceleration_nm_per_ps2"], dtype=float)
        size = float(np.linalg.norm(g))
        x, y, z = g / size
        lines = [f"fix {name} all gravity {size:.17g} vector {x:.17g} {y:.17g} {z:.17g}"]
    elif kind in ("constant_force", "harmonic_position"):
        lines = [f"group {name} id {force['atom'] + 1}"]
        three = " ".join(f"{v:.17g}" for v in force.get("force_kj_per_mol_nm") or force["centre_nm"])
        if kind == "constant_force":
            lines += [f"fix {name} {name} addforce {three}"]
        else:
            lines += [f"fix {name} {name} spring tether {force['k_kj_per_mol_nm2']:.17g} {three} 0"]
    elif kind == "external":
        import sympy

        energy = sympy.sympify(force["energy_kj_per_mol"].replace("^", "**"))
        parts = {"e": energy, **{s: -energy.diff(s) for s in "xyz"}}
        lines = [f"variable {name}{s} atom \"{str(part).replace('**', '^')} + 0*x\"" for s, part in parts.items()]
        lines += [f"group {name} id {' '.join(str(a + 1) for a in force['atoms'])}",
                  f"fix {name} {name} addforce v_{name}x v_{name}y v_{name}z energy v_{name}e"]
    return lines + ([f"fix_modify {name} energy yes"] if lines else [])


def write_case(case: Case, folder: Any, shift: Any) -> Dict[str, Any]:
    """Writes the data file, with positions shifted by box vectors; returns the input's lines and the rigid types."""
    system, topology = case["system"], Topology(case)
    masses, count = system["masses_u"], len(system["masses_u"])
    add_rigid_bonds(case, topology)
    charges, kinds = [0.0] * count, [(m, 0.0, 0.0) for m in masses]
    pair, forces = ["pair_style zero 1.0", "pair_coeff * *"], []
    for number, force in enumerate(system["forces"]):
        atoms, kind = force.get("atoms"), force["kind"]
        if kind == "harmonic_bond":
            topology.add("Bonds", f"{force['k_kj_per_mol_nm2'] / 2:.17g} {force['length_nm']:.17g}", atoms)
        elif kind == "harmonic_angle":
            topology.add("Angles", f"{force['k_kj_per_mol_rad2'] / 2:.17g} {degrees(force['angle_rad']):.17g}", atoms)
        elif kind == "periodic_torsion":
            topology.add("Dihedrals", f"1 {force['k_kj_per_mol']:.17g} {force['periodicity']} "
                                      f"{degrees(force['phase_rad']):.17g}", atoms)
        elif kind == "nonbonded":
            charges = [q * sqrt(COULOMB) for q in force["charges_e"]]
            kinds = list(zip(masses, force["sigma_nm"], force["epsilon_kj_per_mol"]))
            pair = nonbonded_lines(case, force, sorted(set(kinds)))
        forces += force_lines(case, number, force)
    types, ids = sorted(set(kinds)), molecule_ids(case)
    box = system.get("box_nm")
    edges = box or [[2 * FAR, 0, 0], [0, 2 * FAR, 0], [0, 0, 2 * FAR]]
    low = 0 if box else -FAR
    text = ["a case", "", f"{count} atoms", f"{len(types)} atom types"]
    for section in topology.rows:
        word = section[:-1].lower()
        text += [f"{len(topology.rows[section])} {word}s", f"{len(topology.types[section])} {word} types"]
    text += [f"{low} {low + edges[k][k]:.17g} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
    if box and any((edges[1][0], edges[2][0], edges[2][1])):
        text += [f"{edges[1][0]:.17g} {edges[2][0]:.17g} {edges[2][1]:.17g} xy xz yz"]
    text += ["", "Masses", "", *[f"{k} {kind[0]:.17g}" for k, kind in enumerate(types, 1)], "", "Atoms # full", ""]
    three = "{:.17g} {:.17g} {:.17g}".format
    text += [f"{i + 1} {ids[i]} {types.index(kinds[i]) + 1} {charges[i]:.17g} {three(*x)}"
             for i, x in enumerate(np.array(case["start"]["positions_nm"]) + shift)]
    text += ["", "Velocities", "", *[f"{i + 1} {three(*v)}" for i, v in enumerate(start_velocities(case))]]
    for section, rows in topology.rows.items():
        if rows:
            text += ["", section, "", *[f"{n} {' '.join(map(str, row))}" for n, row in enumerate(rows, 1)]]
    (folder / "data").write_text("\n".join(text) + "\n")
    styles = {"Bonds": "harmonic", "Angles": "harmonic", "Dihedrals": "fourier"}
    used = {section: kinds for section, kinds in topology.types.items() if kinds}
    lines = ["units lj", f"boundary {'p p p' if box else 'f f f'}", "atom_style full", "atom_modify map yes sort 0 0",
             "newton on", "special_bonds lj/coul 1 1 1", *[pair[0]],
             *[f"{section[:-1].lower()}_style {styles[section]}" for section in used], "neighbor 0.1 nsq" if not box else
             "neighbor 0.1 bin", "read_data data extra/special/per/atom 20", *pair[1:]]
    for section, kinds in used.items():
        lines += [f"{section[:-1].lower()}_coeff {n} {row.split(' #')[0]}" for n, row in enumerate(kinds, 1)]
    if any(force.get("excluded") for force in system["forces"]):
        lines += ["neigh_modify exclude molecule/intra all"]
    reach = max([1.0, *[2.5 * bond["length_nm"] for bond in system["bonds"]]])
    lines += [f"comm_modify cutoff {reach:.6g}", "neigh_modify every 1 delay 0 check yes", *forces]
    if "langevin" in case["run"]:
        bath = case["run"]["langevin"]
        heat = BOLTZMANN * bath["temperature_k"]
        lines += [f"fix bath all langevin {heat:.17g} {heat:.17g} {1 / bath['friction_per_ps']:.17g} "
                  f"{7919 * case['run'].get('seed', 1)}"]
    return {"lines": lines, "rigid": topology.rigid, "molecules": ids}
