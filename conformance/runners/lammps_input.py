"""A case as LAMMPS's input and data file. `units lj` has no constants: nm, ps, u and kJ/mol fit as they are."""

from __future__ import annotations

from math import acos, degrees, sqrt
from typing import Any, Dict, Iterable, List

import numpy as np

from forces import COULOMB
from shared import BOLTZMANN, Case, clusters, digits, start_velocities

FAR = 1e4  # nm: half the edge of the box of a case that has none
STYLES = {"Bonds": "harmonic", "Angles": "harmonic", "Dihedrals": "fourier"}


class Unsayable(Exception):
    """LAMMPS has no words for something in the case."""


class Topology:
    """Bonds, angles and dihedrals with the coefficients of their types, numbered from 1."""

    def __init__(self) -> None:
        self.rows: Dict[str, List[str]] = {section: [] for section in STYLES}
        self.types: Dict[str, List[Any]] = {section: [] for section in STYLES}
        self.rigid: Dict[str, set] = {"Bonds": set(), "Angles": set()}

    def add(self, section: str, coefficients: str, atoms: Iterable[int], rigid: bool = False) -> None:
        if (coefficients, rigid) not in self.types[section]:
            self.types[section].append((coefficients, rigid))
        kind = self.types[section].index((coefficients, rigid)) + 1
        self.rows[section].append(f"{len(self.rows[section]) + 1} {kind} {' '.join(str(a + 1) for a in atoms)}")
        if rigid:
            self.rigid[section].add(kind)


def add_rigid_bonds(case: Case, topology: Topology) -> None:
    """Bonds; of a triangle two bonds, of one length if it has such, and the angle between them, as fix shake wants it."""
    for atoms in clusters(case):
        listed = [(tuple(sorted(bond["atoms"])), bond["length_nm"]) for bond in case["system"]["bonds"]
                  if bond["atoms"][0] in atoms]
        length = dict(listed)
        if len(atoms) == 3 and len(length) == len(listed) == 3:
            for centre in atoms:
                ends = tuple(atom for atom in atoms if atom != centre)
                a, b = (length[tuple(sorted((centre, end)))] for end in ends)
                if a == b:
                    break
            cosine = (a**2 + b**2 - length[ends] ** 2) / (2 * a * b)
            if abs(cosine) > 1:
                raise Unsayable("a triangle is two bonds and the angle between them, which this one has not")
            listed.remove((ends, length[ends]))
            topology.add("Angles", digits(1, degrees(acos(cosine))), [ends[0], centre, ends[1]], rigid=True)
        for pair, d in listed:
            topology.add("Bonds", digits(1, d), pair, rigid=True)


def nonbonded_lines(force: Case, types: List[Any]) -> List[str]:
    charged = any(force["charges_e"])
    if charged and "cutoff_nm" in force:
        raise Unsayable("no reaction field: Coulomb forces end at a cutoff by a damped shift or not at all")
    lines = [f"pair_style lj/cut{'/coul/cut' * charged} {digits(force.get('cutoff_nm', FAR / 2))}", "pair_modify shift no"]
    return lines + [f"pair_coeff {i} {j} {digits(sqrt(ei * ej), max((si + sj) / 2, 1e-9))}"
                    for i, (_, si, ei) in enumerate(types, 1) for j, (_, sj, ej) in enumerate(types, 1) if i <= j]


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


def force_lines(name: str, force: Case) -> List[str]:
    """Of a force that is a fix, called name."""
    kind = force["kind"]
    group = f"group {name} id {' '.join(str(a + 1) for a in force.get('atoms', [force.get('atom', 0)]))}"
    if kind == "gravity":
        g = np.array(force["acceleration_nm_per_ps2"], dtype=float)
        size = float(np.linalg.norm(g))
        lines = [f"fix {name} all gravity {digits(size)} vector {digits(*g / size)}"]
    elif kind == "constant_force":
        lines = [group, f"fix {name} {name} addforce {digits(*force['force_kj_per_mol_nm'])}"]
    elif kind == "harmonic_position":
        lines = [group, f"fix {name} {name} spring tether {digits(force['k_kj_per_mol_nm2'], *force['centre_nm'])} 0"]
    else:
        import sympy

        energy = sympy.sympify(force["energy_kj_per_mol"].replace("^", "**"))
        parts = {"e": energy, **{s: -energy.diff(s) for s in "xyz"}}
        lines = [f"variable {name}{s} atom \"{str(part).replace('**', '^')} + 0*x\"" for s, part in parts.items()]
        lines += [group, f"fix {name} {name} addforce v_{name}x v_{name}y v_{name}z energy v_{name}e"]
    return lines + [f"fix_modify {name} energy yes"]


def write_case(case: Case, folder: Any, shift: Any) -> Dict[str, Any]:
    """Writes the data file, with positions shifted by box vectors; returns the input's lines and the rigid types."""
    system, topology, ids = case["system"], Topology(), molecule_ids(case)
    masses, box, pair, forces = system["masses_u"], system.get("box_nm"), ["pair_style zero 1.0", "pair_coeff * *"], []
    add_rigid_bonds(case, topology)
    charges, kinds = [0.0] * len(masses), [(m, 0.0, 0.0) for m in masses]
    for number, force in enumerate(system["forces"]):
        atoms, kind = force.get("atoms"), force["kind"]
        if kind == "harmonic_bond":
            topology.add("Bonds", digits(force["k_kj_per_mol_nm2"] / 2, force["length_nm"]), atoms)
        elif kind == "harmonic_angle":
            topology.add("Angles", digits(force["k_kj_per_mol_rad2"] / 2, degrees(force["angle_rad"])), atoms)
        elif kind == "periodic_torsion":
            numbers = 1, force["k_kj_per_mol"], force["periodicity"], degrees(force["phase_rad"])
            topology.add("Dihedrals", digits(*numbers), atoms)
        elif kind == "nonbonded":
            charges = [q * sqrt(COULOMB) for q in force["charges_e"]]
            kinds = list(zip(masses, force["sigma_nm"], force["epsilon_kj_per_mol"]))
            pair = nonbonded_lines(force, sorted(set(kinds)))
        else:
            forces += force_lines(f"f{number}", force)
    types, used = sorted(set(kinds)), {section: of for section, of in topology.types.items() if of}
    edges, low = (box, 0) if box else (2 * FAR * np.eye(3), -FAR)
    text = ["a case", "", f"{len(masses)} atoms", f"{len(types)} atom types"]
    text += [f"{len(topology.rows[section])} {section.lower()}\n{len(of)} {section[:-1].lower()} types"
             for section, of in used.items()]
    text += [f"{digits(low, low + edges[k][k])} {axis}lo {axis}hi" for k, axis in enumerate("xyz")]
    if box and any((edges[1][0], edges[2][0], edges[2][1])):
        text += [f"{digits(edges[1][0], edges[2][0], edges[2][1])} xy xz yz"]
    text += ["", "Masses", "", *[f"{k} {digits(kind[0])}" for k, kind in enumerate(types, 1)], "", "Atoms # full", ""]
    text += [f"{i + 1} {ids[i]} {types.index(kinds[i]) + 1} {digits(charges[i], *x)}"
             for i, x in enumerate(np.array(case["start"]["positions_nm"]) + shift)]
    text += ["", "Velocities", "", *[f"{i} {digits(*v)}" for i, v in enumerate(start_velocities(case), 1)]]
    text += [line for section in used for line in ("", section, "", *topology.rows[section])]
    (folder / "data").write_text("\n".join(text) + "\n")
    reach = max([1.0, *[2.5 * bond["length_nm"] for bond in system["bonds"]]])
    lines = ["units lj", f"boundary {'p p p' if box else 'f f f'}", "atom_style full", "atom_modify map yes sort 0 0",
             "newton on", "special_bonds lj/coul 1 1 1", pair[0],
             *[f"{section[:-1].lower()}_style {STYLES[section]}" for section in used],
             f"neighbor 0.1 {'bin' if box else 'nsq'}", "read_data data extra/special/per/atom 20", *pair[1:],
             *[f"{section[:-1].lower()}_coeff {n} {row}" for section, of in used.items() for n, (row, _) in enumerate(of, 1)],
             *["neigh_modify exclude molecule/intra all" for force in system["forces"] if force.get("excluded")],
             f"comm_modify cutoff {reach:.6g}", "neigh_modify every 1 delay 0 check yes", *forces]
    if "langevin" in case["run"]:
        bath = case["run"]["langevin"]
        heat, seed = BOLTZMANN * bath["temperature_k"], 7919 * case["run"].get("seed", 1)
        lines += [f"fix bath all langevin {digits(heat, heat, 1 / bath['friction_per_ps'])} {seed}"]
    return {"lines": lines, "rigid": topology.rigid, "molecules": ids}
