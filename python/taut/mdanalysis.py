"""Shows a simulation to MDAnalysis, and reads its universes, in Å and Å/ps. It is imported only where it is used."""

from __future__ import annotations

from typing import Any, List

import numpy as np


def universe_of(simulation: Any) -> Any:
    """Returns an MDAnalysis.Universe of a simulation's atoms, bonds and present state."""
    import MDAnalysis

    names = simulation.names
    residues, of_atom = np.unique(names["residue_index"], return_inverse=True)
    universe = MDAnalysis.Universe.empty(len(simulation.masses), n_residues=len(residues), atom_resindex=of_atom,
                                         trajectory=True, velocities=True)
    first = np.unique(of_atom, return_index=True)[1]
    universe.add_TopologyAttr("names", names["atom"])
    universe.add_TopologyAttr("elements", names["element"])
    universe.add_TopologyAttr("types", names["element"])
    universe.add_TopologyAttr("resnames", names["residue"][first])
    universe.add_TopologyAttr("resids", residues + 1)
    universe.add_TopologyAttr("masses", simulation.masses)
    universe.add_TopologyAttr("bonds", [tuple(bond) for bond in simulation.bonds])
    show_state(simulation, universe)
    return universe


def show_state(simulation: Any, universe: Any) -> None:
    """Writes positions, velocities, box, time and step of a simulation to the frame of its universe."""
    universe.atoms.positions = 10 * simulation.positions
    universe.atoms.velocities = 10 * simulation.velocities
    frame = universe.trajectory.ts
    frame.time, frame.data["step"] = simulation.time_ps, simulation.steps_taken
    if simulation.box is not None:
        from MDAnalysis.lib.mdamath import triclinic_box

        universe.dimensions = triclinic_box(*(10 * simulation.box))


def is_group(given: Any) -> bool:
    """True for a Universe or an AtomGroup of MDAnalysis."""
    return type(given).__module__.split(".")[0] == "MDAnalysis" and hasattr(given, "atoms")


def numbers_of(group: Any, what: str) -> Any:
    """Returns the positions [nm], the velocities [nm/ps] or the box [nm] of a universe's present frame; None if there
    are none."""
    if what == "box":
        if group.universe.dimensions is None:
            return None
        from MDAnalysis.lib.mdamath import triclinic_vectors

        return triclinic_vectors(group.universe.dimensions).astype(float) / 10
    if what == "velocities" and not group.universe.trajectory.ts.has_velocities:
        return None
    return getattr(group.atoms, what).astype(float) / 10


def names_of(group: Any) -> List[str]:
    """Returns a line of name, residue, element and residue's index for every atom. What it lacks is empty."""
    atoms = group.atoms
    columns = [getattr(atoms, what, [""] * len(atoms)) for what in ("names", "resnames", "elements")]
    return [f"{name}\t{residue}\t{element}\t{index}\n"
            for name, residue, element, index in zip(*columns, atoms.resindices)]
