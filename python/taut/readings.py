"""What a taut.Simulation shows of its state and of its run, to Python and to other programs."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import _core, ase_calculator, mdanalysis, openmm_objects
from .history import History
from .showing import Log, Summary

Reals = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int32]


class Readings:
    """Numbers and names of the system as it is now, and the log of its run. taut.Simulation derives from it."""

    _engine: "_core.Simulation"
    _earlier: History

    @property
    def positions(self) -> Reals:
        """Positions, (n, 3) [nm], a live view. They are unwrapped: molecules stay whole and may leave the box.

        Assign an array of the same shape, numbers with an OpenMM unit or a Universe of MDAnalysis's, or write to the
        view.
        """
        return self._engine.positions

    @positions.setter
    def positions(self, given: Any) -> None:
        self._write(self.positions, given, "positions", "nm")

    @property
    def velocities(self) -> Reals:
        """Velocities, (n, 3) [nm/ps], a live view. Assign an array of the same shape, or write to the view."""
        return self._engine.velocities

    @velocities.setter
    def velocities(self, given: Any) -> None:
        self._write(self.velocities, given, "velocities", "nm/ps")

    @staticmethod
    def _write(view: Reals, given: Any, what: str, unit: str) -> None:
        if isinstance(given, np.ndarray) and given.__array_interface__ == view.__array_interface__:
            return  # `sim.positions += d` has written to the view already
        view[:] = openmm_objects.vectors(given, unit, what, len(view))

    @property
    def forces(self) -> Reals:
        """Forces, (n, 3) [kJ/mol/nm], a live view that cannot be written to. They include what the method added.

        Where momentum is taken out beside anchors or forces from outside, the force on the whole is left out."""
        return self._engine.forces

    @property
    def box(self) -> Optional[Reals]:
        """The three vectors of the periodic box in rows, (3, 3) [nm]; None without a box.

        They are in reduced form: a along x, b in the xy plane. The array is a live view that cannot be written to.
        Assign three vectors or three edges to change the box. Positions stay what they are.
        """
        return self._engine.box

    @box.setter
    def box(self, given: Any) -> None:
        self._engine._set_box(openmm_objects.box_vectors(given))

    @property
    def bonds(self) -> Integers:
        """The two atoms of each rigid bond, (m, 2), counted from 0."""
        return self._engine.bonds

    @property
    def lengths(self) -> Reals:
        """The length that each rigid bond is held at, (m,) [nm]."""
        return self._engine.lengths

    @property
    def masses(self) -> Reals:
        """Masses, (n,) [u]. An atom of mass 0 is an anchor, which no force moves, or a virtual site."""
        return self._engine.masses

    @property
    def tensions(self) -> Reals:
        """The force with which each rigid bond pulls its atoms together, (m,) [kJ/mol/nm]; below 0 it pushes."""
        return self._engine.tensions

    @property
    def energies(self) -> Dict[str, float]:
        """Energies by term, and "potential", "kinetic" and "total" [kJ/mol]."""
        return self._engine.energies

    @property
    def temperature(self) -> float:
        """Temperature of the present state [K], of the velocity that the drift ahead has; ``energies["kinetic"]`` is of
        ``velocities``, those of the full step."""
        return self._engine.temperature

    @property
    def pressure_tensor(self) -> Optional[Reals]:
        """Pressure tensor of the present state, (3, 3) [bar]; None without a box."""
        return self._engine.pressure_tensor

    @property
    def pressure(self) -> Optional[float]:
        """A third of the pressure tensor's trace [bar]; None without a box."""
        tensor = self.pressure_tensor
        return None if tensor is None else float(tensor.trace() / 3)

    @property
    def bond_errors(self) -> Reals:
        """Relative error of each rigid bond's length, (m,)."""
        i, j = self.bonds.T
        errors: Reals = np.linalg.norm(self.positions[j] - self.positions[i], axis=1) / self.lengths - 1
        return errors

    @property
    def constraint_work(self) -> float:
        """How much the constraints changed the energy since the start [kJ/mol]: not forces, not a thermostat."""
        return self._engine.constraint_work

    @property
    def time_ps(self) -> float:
        """Time of the present state [ps]."""
        return self._engine.time_ps

    @property
    def steps_taken(self) -> int:
        """Number of steps taken so far."""
        return self._engine.steps_taken

    @property
    def threads(self) -> int:
        """Number of threads that compute. The order of sums, and so the last bits, depend on it."""
        return self._engine.threads

    @property
    def setting(self) -> str:
        """Options of the constraint method, in one line."""
        return self._engine.setting

    @property
    def degrees_of_freedom(self) -> int:
        """Degrees of freedom that the temperature counts: 3n less bonds, anchored atoms and a fixed momentum."""
        return self._engine.degrees_of_freedom

    @property
    def name(self) -> str:
        """Name of the scene."""
        return self._engine.name

    @property
    def notes(self) -> List[str]:
        """Remarks on the start and on the present step, a line each, and where the folder's earlier run is kept."""
        return self._engine.notes

    @property
    def folder(self) -> str:
        """The folder that the simulation writes to; empty if there is none, or after ``close``."""
        return self._engine.folder

    @property
    def names(self) -> Dict[str, Any]:
        """Names of every atom: "atom", "residue" and "element", (n,) texts, and "residue_index", (n,)."""
        return dict(zip(("atom", "residue", "element", "residue_index"), map(np.array, self._engine._names())))

    def to_openmm(self) -> Tuple[Any, Any]:
        """Returns an openmm.System and an openmm.State of the present system and state. Needs OpenMM."""
        return openmm_objects.objects_of(*self._engine._to_openmm())

    def to_openmm_xml(self) -> Tuple[str, str]:
        """Returns the XML of both, for which OpenMM is not needed."""
        system, state = self._engine._to_openmm()
        return system, state

    def universe(self) -> Any:
        """Returns an MDAnalysis.Universe with names, masses, bonds, positions [Å], velocities [Å/ps] and box.

        The other way, ``sim.positions = universe`` takes a frame's positions, ``sim.velocities`` its velocities, and
        ``sim.box`` its box. ``Simulation.from_openmm(system, universe)`` starts from a frame.
        """
        return mdanalysis.universe_of(self)

    def to_ase(self) -> Any:
        """Returns ase.Atoms with masses, names, positions [Å], velocities and cell.

        Rigid bonds are ASE's FixBondLengths, anchors its FixAtoms. ``atoms.calc = taut.Calculator(sim)`` gives it
        taut's forces; ``sim.positions = atoms.positions / 10`` goes on from where ASE ended.
        """
        return ase_calculator.atoms_of(self)

    @property
    def log(self) -> Log:
        """Rows of the log so far: a dict of columns "step", "time_ps", "temperature_k", ..., numpy arrays.

        ``help(taut.Row)`` describes the columns; walls, steered atoms and biases have columns of their own. A number that
        the run does not have is nan. ``sim.log.pressure_tensor`` is (rows, 6).
        """
        return Log(self._earlier.before(self._engine.log))

    @property
    def summary(self) -> Any:
        """Results of the last run, a dict with the keys of summary.json; None before the first."""
        results = self._earlier.summary_or(self._engine._summary())
        return None if results is None else Summary(results)

    @property
    def timings(self) -> Any:
        """Where the time of the last run went: the summary's "timings"; None where parts were not measured.

        "parts" has for every part its calls, ms_per_step, percent of the run, and the percentage of the threads' time
        in it in which they had nothing to do. Systems of 1000 atoms and more are measured unasked, others with
        ``run(steps, timings=True)``.
        """
        return (self.summary or {}).get("timings")

    def plot(self, size: int = 170, panels: Iterable[str] = ()) -> Any:
        """Draws the log as `taut plot` does: energy and its account, temperature, bond errors, and pressure in a box, with
        means of the equilibrated part. Returns matplotlib's figure, ``size`` mm wide: 85 or 170. ``panels``: parts of the
        titles of those that are wanted, as ["temperature"]; empty: all."""
        from . import measure, pictures

        tables = pictures.log_tables(self.log, measure)
        if panels := [panels] if isinstance(panels, str) else list(panels):
            tables["panels"] = {"panel": panels}
        return pictures.draw("run", tables, size, self.name)
