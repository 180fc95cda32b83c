"""A case's system as the XML of an OpenMM System, which taut reads. OpenMM need not be installed."""

from __future__ import annotations

from collections import defaultdict, deque
from typing import Any, Dict, Iterable, List, Optional, Set
from xml.sax.saxutils import quoteattr

import numpy as np

Case = Dict[str, Any]


def tag(tag_name: str, inside: Iterable[str] = (), **attributes: Any) -> str:
    said = "".join(f" {key}={quoteattr(value if isinstance(value, str) else repr(value))}"
                   for key, value in attributes.items())
    return f"<{tag_name}{said}>{''.join(inside)}</{tag_name}>"


def numbered(atoms: Iterable[int]) -> Dict[str, Any]:
    return {f"p{n + 1}": atom for n, atom in enumerate(atoms)}


def force(kind: str, inside: List[str], **attributes: Any) -> str:
    version = {"NonbondedForce": 4, "CustomExternalForce": 1}.get(kind, 2)
    return tag("Force", inside, type=kind, name=kind, forceGroup=0, version=version, **attributes)


def external(energy: str, atoms: List[int]) -> str:
    particles = tag("Particles", [tag("Particle", index=atom) for atom in atoms])
    return force("CustomExternalForce", [tag("PerParticleParameters"), tag("GlobalParameters"), particles], energy=energy)


def towards(vector: List[float]) -> str:
    return "-(" + "+".join(f"({part!r})*{axis}" for part, axis in zip(vector, "xyz")) + ")"


def nonbonded(of: Case, periodic: bool) -> str:
    atoms = [tag("Particle", q=q, sig=sigma, eps=epsilon) for q, sigma, epsilon
             in zip(of["charges_e"], of["sigma_nm"], of["epsilon_kj_per_mol"])]
    excluded = [tag("Exception", q=0, sig=1, eps=0, **numbered(pair)) for pair in of["excluded"]]
    method = (2 if periodic else 1) if "cutoff_nm" in of else 0
    return force("NonbondedForce", [tag("GlobalParameters"), tag("ParticleOffsets"), tag("ExceptionOffsets"),
                                    tag("Particles", atoms), tag("Exceptions", excluded)],
                 method=method, cutoff=of.get("cutoff_nm", 1), rfDielectric=of.get("solvent_dielectric", 78.3),
                 dispersionCorrection=0, exceptionsUsePeriodic=0, useSwitchingFunction=0, switchingDistance=-1,
                 ewaldTolerance=0.0005, alpha=0, nx=0, ny=0, nz=0, ljAlpha=0, ljnx=0, ljny=0, ljnz=0,
                 includeDirectSpace=1, recipForceGroup=-1)


def one_force(of: Case, system: Case) -> List[str]:
    kind, masses = of["kind"], system["masses_u"]
    if kind == "gravity":
        return [external(towards([m * part for part in of["acceleration_nm_per_ps2"]]), [atom])
                for atom, m in enumerate(masses) if m > 0]
    if kind == "constant_force":
        return [external(towards(of["force_kj_per_mol_nm"]), [of["atom"]])]
    if kind == "harmonic_position":
        squares = "+".join(f"({axis}-({centre!r}))^2" for axis, centre in zip("xyz", of["centre_nm"]))
        return [external(f"0.5*{of['k_kj_per_mol_nm2']!r}*({squares})", [of["atom"]])]
    if kind == "external":
        return [external(of["energy_kj_per_mol"], of["atoms"])]
    if kind == "nonbonded":
        return [nonbonded(of, "box_nm" in system)]
    atoms = numbered(of["atoms"])
    if kind == "harmonic_bond":
        term = tag("Bond", d=of["length_nm"], k=of["k_kj_per_mol_nm2"], **atoms)
        return [force("HarmonicBondForce", [tag("Bonds", [term])], usesPeriodic=0)]
    if kind == "harmonic_angle":
        term = tag("Angle", a=of["angle_rad"], k=of["k_kj_per_mol_rad2"], **atoms)
        return [force("HarmonicAngleForce", [tag("Angles", [term])], usesPeriodic=0)]
    term = tag("Torsion", periodicity=of["periodicity"], phase=of["phase_rad"], k=of["k_kj_per_mol"], **atoms)
    return [force("PeriodicTorsionForce", [tag("Torsions", [term])], usesPeriodic=0)]


def box_xml(system: Case) -> str:
    box = system.get("box_nm", [[2, 0, 0], [0, 2, 0], [0, 0, 2]])  # OpenMM's, for nothing where no force is periodic
    return tag("PeriodicBoxVectors", [tag(name, x=x, y=y, z=z) for name, (x, y, z) in zip("ABC", box)])


def system_xml(case: Case) -> str:
    system = case["system"]
    sites = {site["atom"]: tag(("Two" if len(site["of"]) == 2 else "Three") + "ParticleAverageSite",
                               **numbered(site["of"]), **{f"w{n + 1}": w for n, w in enumerate(site["weights"])})
             for site in system.get("virtual_sites", [])}
    particles = [tag("Particle", [sites[atom]] if atom in sites else [], mass=mass)
                 for atom, mass in enumerate(system["masses_u"])]
    bonds = [tag("Constraint", d=bond["length_nm"], **numbered(bond["atoms"])) for bond in system["bonds"]]
    forces = [one for of in system["forces"] for one in one_force(of, system)]
    if "box_nm" in system and not any(of["kind"] == "nonbonded" for of in system["forces"]):
        nothing = [0] * len(particles)  # OpenMM's Systems have a box only where a force is periodic
        cutoff = 0.1 * min(system["box_nm"][k][k] for k in range(3))
        forces.append(nonbonded({"charges_e": nothing, "sigma_nm": [1] * len(particles), "epsilon_kj_per_mol": nothing,
                                 "excluded": [], "cutoff_nm": cutoff}, periodic=True))
    return '<?xml version="1.0" ?>' + tag(
        "System", [box_xml(system), tag("Particles", particles), tag("Constraints", bonds), tag("Forces", forces)],
        type="System", version=1, openmmVersion="8.0")


def bonds_are_nearest(case: Case) -> bool:
    """Whether bonds are of nearest images, being under half the box, and no two of them are of the same atoms."""
    bonds, box = case["system"]["bonds"], np.array(case["system"]["box_nm"], dtype=float)
    alone = len({frozenset(bond["atoms"]) for bond in bonds}) == len(bonds)
    return alone and 1.01 * max(bond["length_nm"] for bond in bonds) < min(np.diag(box)) / 2


def whole_by_images(case: Case) -> Optional[np.ndarray]:
    """What to add to positions so that bonds go between atoms as they stand, nothing if bonds close through the box, as
    taut then takes nearest images; None if such a bond is of another image, or two are of the same atoms."""
    neighbours: Dict[int, List[Any]] = defaultdict(list)
    for bond in case["system"]["bonds"]:
        (i, j), image = bond["atoms"], np.array(bond.get("image", [0, 0, 0]))
        neighbours[i].append((j, image))
        neighbours[j].append((i, -image))
    shifts = np.zeros((len(case["system"]["masses_u"]), 3), dtype=int)
    seen: Set[int] = set()
    for first in range(len(shifts)):
        queue = deque([] if first in seen else [first])
        seen.add(first)
        while queue:
            i = queue.popleft()
            for j, image in neighbours[i]:
                if j not in seen:
                    seen.add(j)
                    shifts[j] = shifts[i] + image
                    queue.append(j)
                elif (shifts[j] != shifts[i] + image).any():
                    return np.zeros(shifts.shape) if bonds_are_nearest(case) else None
    return shifts @ np.array(case["system"].get("box_nm", np.eye(3)), dtype=float)
