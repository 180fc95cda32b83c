"""Reporters: what a simulation writes or calls while it runs.

A reporter of taut's has ``every``, the number of steps between its reports, and ``report(simulation)``. Reporters of
OpenMM's (``describeNextReport``, ``report``) are taken as they are. All write unwrapped positions.
"""

from __future__ import annotations

import csv
from functools import cached_property
from pathlib import Path
from typing import Any, Callable, List, Optional, Sequence, Union

import numpy as np

from . import _core
from .errors import InputError, suggest
from .mdanalysis import show_state


class Reporter:
    """The base of taut's reporters. Derive from it and write ``report``.

    ``every`` is the number of steps between reports, which fall on multiples of it. ``close`` is called by
    ``Simulation.close``.
    """

    def __init__(self, every: int) -> None:
        if isinstance(every, bool) or int(every) != every or every < 1:
            raise InputError(f"every={every!r}: expected a number of steps, 1 or more")
        self.every = int(every)

    def begin(self, simulation: Any) -> None:
        """Is called before a run takes its first step."""

    def report(self, simulation: Any) -> None:
        """Is called between two steps."""
        raise NotImplementedError("a Reporter needs report(simulation)")

    def close(self) -> None:
        """Closes what the reporter has open."""


def _new_file(file: Union[str, Path], overwrite: bool) -> Path:
    path = Path(file)
    if path.exists() and not overwrite:
        raise InputError(f"{file}: there is such a file; overwrite=True replaces it")
    if not path.absolute().parent.is_dir():
        raise InputError(f"{file}: there is no folder {path.absolute().parent}")
    return path


def _indices(atoms: Any) -> Optional[List[int]]:
    """Returns atoms given as indices, as a mask, as a slice's range or as MDAnalysis's AtomGroup; None for all."""
    if atoms is None:
        return None
    atoms = np.asarray(getattr(atoms, "indices", atoms))
    if atoms.dtype == bool:
        atoms = np.flatnonzero(atoms)
    if atoms.ndim != 1 or not len(atoms) or atoms.dtype.kind not in "iu":
        raise InputError("atoms: expected indices from 0, or a mask, of one atom or more")
    return [int(a) for a in atoms]


class _Frames(Reporter):
    format = ""

    def __init__(self, file: Union[str, Path], every: int = 100, atoms: Any = None, overwrite: bool = False) -> None:
        super().__init__(every)
        self.file, self.atoms = _new_file(file, overwrite), _indices(atoms)
        self._open: Any = None

    def report(self, simulation: Any) -> None:
        engine = simulation._engine
        if self._open is None:
            self._open = _core.TrajectoryFile(engine, str(self.file), self.format, self.every, self.atoms or [])
        self._open.add(engine)

    def close(self) -> None:
        if self._open is not None:
            self._open.close()
        self._open = None


class DCD(_Frames):
    """Writes frames to a DCD file.

    ``atoms``: indices, a mask or an AtomGroup of MDAnalysis's; None for all. Raises InputError for a file that is
    there, unless ``overwrite``.
    """

    format = "dcd"


class H5MD(_Frames):
    """Writes frames to an H5MD file in double precision, with velocities, forces and tensions of the bonds.

    The arguments are those of ``taut.DCD``.
    """

    format = "h5md"


class XTC(_Frames):
    """Writes frames to an XTC file with MDAnalysis, rounded to 0.001 nm. The arguments are those of ``taut.DCD``."""

    def report(self, simulation: Any) -> None:
        if self._open is None:
            import MDAnalysis

            universe = simulation.universe()
            self._group = universe.atoms if self.atoms is None else universe.atoms[self.atoms]
            self._open = MDAnalysis.Writer(str(self.file), len(self._group))
        show_state(simulation, self._group.universe)
        self._open.write(self._group)


class CSV(Reporter):
    """Writes rows of the log to a CSV file.

    ``columns``: names of columns of ``sim.log``; None for all. Raises InputError for a file that is there, unless
    ``overwrite``, and, when a run begins, for a column that the simulation does not have.
    """

    def __init__(self, file: Union[str, Path], every: int = 100, columns: Optional[Sequence[str]] = None,
                 overwrite: bool = False) -> None:
        super().__init__(every)
        self.columns = [] if columns is None else list(columns)
        self._all = columns is None
        self.file = _new_file(file, overwrite)
        self._open: Any = None

    def begin(self, simulation: Any) -> None:
        known = list(simulation._engine._titles().values())
        if self._all and self._open is None:
            self.columns = known
        for name in self.columns:
            if name not in known:
                raise InputError(f"columns: the simulation has no {name!r}{suggest(name, known)}")

    def report(self, simulation: Any) -> None:
        first = self._open is None
        if first:
            self.begin(simulation)
            self._open = open(self.file, "w", newline="")
        writer = csv.writer(self._open)
        if first:
            writer.writerow(self.columns)
        row = simulation._engine._row()
        writer.writerow([repr(getattr(row, name)) for name in self.columns])
        self._open.flush()

    def close(self) -> None:
        if self._open is not None:
            self._open.close()
        self._open = None


class Call(Reporter):
    """Calls ``function(simulation)`` every so many steps. The run stops if it returns False."""

    def __init__(self, function: Callable[[Any], Any], every: int = 100) -> None:
        super().__init__(every)
        self.function = function

    def report(self, simulation: Any) -> Any:
        return self.function(simulation)


class _OpenMMState:
    """What OpenMM's reporters ask of a State."""

    def __init__(self, simulation: Any) -> None:
        from openmm import unit

        self._simulation, self._unit = simulation, unit

    def _rows(self, rows: Any, unit: Any) -> Any:
        return self._unit.Quantity(np.array(rows), unit)

    def getPositions(self, asNumpy: bool = False) -> Any:
        return self._rows(self._simulation.positions, self._unit.nanometer)

    def getVelocities(self, asNumpy: bool = False) -> Any:
        return self._rows(self._simulation.velocities, self._unit.nanometer / self._unit.picosecond)

    def getForces(self, asNumpy: bool = False) -> Any:
        return self._rows(self._simulation.forces, self._unit.kilojoule_per_mole / self._unit.nanometer)

    def getPotentialEnergy(self) -> Any:
        return self._simulation.energies["potential"] * self._unit.kilojoule_per_mole

    def getKineticEnergy(self) -> Any:
        return self._simulation.energies["kinetic"] * self._unit.kilojoule_per_mole

    def getTime(self) -> Any:
        return self._simulation.time_ps * self._unit.picosecond

    def getStepCount(self) -> int:
        return int(self._simulation.steps_taken)

    def getPeriodicBoxVectors(self, asNumpy: bool = False) -> Any:
        if self._simulation.box is None:
            return None
        from openmm import Vec3

        rows = [Vec3(*row) for row in self._simulation.box.tolist()]
        return self._unit.Quantity(rows, self._unit.nanometer)

    def getPeriodicBoxVolume(self) -> Any:
        return float(np.linalg.det(self._simulation.box)) * self._unit.nanometer ** 3


class _OpenMMSimulation:
    """What OpenMM's reporters ask of an openmm.app.Simulation."""

    def __init__(self, simulation: Any) -> None:
        self._simulation = simulation
        self.context = self.integrator = self

    @cached_property
    def system(self) -> Any:
        return self._simulation.to_openmm()[0]

    @cached_property
    def topology(self) -> Any:
        return _topology(self._simulation)

    @property
    def currentStep(self) -> int:
        return int(self._simulation.steps_taken)

    def getSystem(self) -> Any:
        return self.system

    def getIntegrator(self) -> Any:
        return self

    def getStepSize(self) -> Any:
        from openmm import unit

        return self._simulation.dt_fs * unit.femtosecond

    def computeSystemTemperature(self) -> Any:
        """With the degrees of freedom that taut counts."""
        from openmm import unit

        return self._simulation.temperature * unit.kelvin


def _topology(simulation: Any) -> Any:
    """Makes an openmm.app.Topology of names, residues, bonds and box."""
    from openmm import unit
    from openmm.app import Element, Topology

    topology, names = Topology(), simulation.names
    chain, residue, last, atoms = topology.addChain(), None, None, []
    for atom, kind, element, index in zip(names["atom"], names["residue"], names["element"], names["residue_index"]):
        if index != last:
            residue, last = topology.addResidue(str(kind), chain), index
        try:
            symbol = Element.getBySymbol(str(element))
        except KeyError:
            symbol = None
        atoms.append(topology.addAtom(str(atom), symbol, residue))
    for i, j in simulation.bonds.tolist():
        topology.addBond(atoms[i], atoms[j])
    if simulation.box is not None:
        topology.setPeriodicBoxVectors(unit.Quantity(simulation.box.tolist(), unit.nanometer))
    return topology


class _OfOpenMM(Reporter):
    """A reporter of OpenMM's."""

    def __init__(self, reporter: Any, simulation: Any) -> None:
        super().__init__(1)
        self.reporter, self.view = reporter, _OpenMMSimulation(simulation)

    def steps_left(self) -> int:
        asked = self.reporter.describeNextReport(self.view)
        return int(asked["steps"] if isinstance(asked, dict) else asked[0])

    def report(self, simulation: Any) -> None:
        self.reporter.report(self.view, _OpenMMState(simulation))


class Reporters(List[Any]):
    """The reporters of a simulation, a list."""

    def append(self, reporter: Any) -> None:
        """Adds a reporter of taut's, of OpenMM's, or of your own."""
        own = hasattr(reporter, "report") and hasattr(reporter, "every")
        if not own and not (hasattr(reporter, "describeNextReport") and hasattr(reporter, "report")):
            raise InputError(f"{reporter!r} is no reporter: expected taut.DCD, taut.H5MD, taut.XTC, taut.CSV, "
                             "taut.Call, a class derived from taut.Reporter, or a reporter of OpenMM's")
        super().append(reporter)

    def refuse_another_step(self) -> None:
        """Raises InputError where a file is open whose frames are equally spaced in time."""
        for reporter in self:
            if isinstance(reporter, (DCD, H5MD)) and reporter._open is not None:
                raise InputError(f"run.dt_fs: frames of {reporter.file} are equally spaced in time; call the reporter's "
                                 "close(), and take it out or give it another file")


class Schedule:
    """Says after which steps of a run which reporters report."""

    def __init__(self, reporters: Sequence[Any], simulation: Any) -> None:
        self._simulation = simulation
        self._reporters = [reporter if hasattr(reporter, "every") else _OfOpenMM(reporter, simulation)
                           for reporter in reporters]
        self._due: List[Any] = []
        for reporter in self._reporters:
            if isinstance(reporter, Reporter):
                reporter.begin(simulation)

    def next_after(self, taken: int) -> int:
        """Finds the reporters that are due next, and returns after which step."""
        left = [reporter.steps_left() if isinstance(reporter, _OfOpenMM) else reporter.every - taken % reporter.every
                for reporter in self._reporters]
        self._due = [reporter for reporter, steps in zip(self._reporters, left) if steps == min(left)]
        return taken + min(left)

    def __call__(self, taken: int) -> Any:
        """Lets those report that are due. Returns the step of the next reports, or False to stop the run."""
        answers = [reporter.report(self._simulation) for reporter in self._due]
        if any(isinstance(answer, (bool, np.bool_)) and not answer for answer in answers):
            return False
        return self.next_after(taken)
