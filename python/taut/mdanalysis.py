"""Shows a simulation to MDAnalysis, in Å and Å/ps. MDAnalysis is imported only where it is asked for."""

from __future__ import annotations

from typing import Any

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
