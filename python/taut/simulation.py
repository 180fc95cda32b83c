"""taut.Simulation: a system that runs."""

from __future__ import annotations

import os
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, List, Mapping, Optional, Tuple, Union

import numpy as np
import numpy.typing as npt

from . import _core, ase_calculator, inputs, mdanalysis, openmm_objects, parts
from .biases import Bias
from .errors import InputError, suggest
from .history import History
from .progress import MinimiseProgress, RunProgress
from .reporters import Reporters, Schedule
from .showing import Log, Summary, table

Reals = npt.NDArray[np.float64]
Integers = npt.NDArray[np.int32]

#: The simulation of this process that last opened a folder, by the folder's real path.
_WRITERS: "weakref.WeakValueDictionary[str, Simulation]" = weakref.WeakValueDictionary()


def _release_folder(folder: str, close: bool) -> None:
    """Closes the simulation of this process that writes to a folder, or refuses the folder."""
    writer = _WRITERS.get(os.path.realpath(folder))
    if writer is None or not writer.folder or writer._process != os.getpid():
        return
    if not close:
        raise InputError(f"{folder}: another Simulation of this process writes there; call its close(), or give "
                         "overwrite=True, which closes it and moves its run aside")
    writer.close()


@dataclass(frozen=True)
class Minimisation:
    """What a minimisation came to.

    - ``energy_before``, ``energy``: potential energy [kJ/mol]
    - ``largest_force``: on an atom, without its part along rigid bonds [kJ/mol/nm]
    - ``steps``: moves, kept or taken back
    - ``converged``: True if the largest force is no larger than asked for
    """

    energy_before: float
    energy: float
    largest_force: float
    steps: int
    converged: bool


#: Settings that may change between two runs of a simulation.
_CHANGEABLE = ["run.barostat", "run.barostat_every", "run.barostat_ps", "run.compressibility_per_bar", "run.coupling",
               "run.dt_fs", "run.friction_per_ps", "run.log_every", "run.pressure_bar", "run.temperature_k", "run.thermostat",
               "run.thermostat_ps"]


def _stages(steps: int, ramp: Optional[Tuple[float, float]]) -> List[Tuple[int, Optional[float]]]:
    """Returns how many steps each stage of a run has, and its temperature [K], None for the present one."""
    if ramp is None:
        return [(steps, None)]
    try:
        first, last = (float(temperature) for temperature in ramp)
    except (TypeError, ValueError):
        raise InputError(f"ramp={ramp!r}: expected two temperatures [K], at the start and at the end") from None
    count = max(1, min(steps, 100))
    ends = [steps * (n + 1) // count for n in range(count)]
    return [(end - begin, first + (last - first) * (n + 1) / count)
            for n, (begin, end) in enumerate(zip([0, *ends], ends))]


def _unpickled(kind: Any, checkpoint: bytes, forces: Any, method: Optional[type],
               threads: Optional[int] = None) -> "Simulation":
    if method is not None:
        parts.register(method)
    simulation: Simulation = kind.resume(checkpoint, forces=forces, threads=threads)
    return simulation


class Simulation:
    """A system with a constraint method, forces and a start, ready to run.

    ::

        with taut.Simulation("water", method="feedforward", out="out", overwrite=True) as sim:
            sim.run(10_000, every=100, callback=print)
        sim.positions            # (n, 3) [nm]

    Arguments:

    - ``scene``: a name (``taut.scenes()`` lists them), a file, or a dict with the sections of such a file
    - ``method``: a name (``taut.methods()`` lists them), options such as ``taut.Rattle(tolerance=1e-8)``, or a class
      of your own derived from ``taut.ConstraintMethod``; None takes the scene's
    - ``dt_fs``: length of a step [fs]; None takes the scene's
    - ``set``: any keys of the scene, as in ``{"run.seed": 7, "run.thermostat": "langevin"}``
    - ``forces``: forces of your own, instances of classes derived from ``taut.Force``
    - ``out``: a folder for log.csv, checkpoints, trajectories (``run.trajectory_every``) and the final state, which
      are those of the command ``taut run --out``
    - ``overwrite``: moves a run that the folder holds aside, and closes a simulation of this process that writes there
    - ``precision``: ``"double"`` or ``"mixed"`` (``forcefield.precision``); None takes the scene's
    - ``threads``: number of threads that compute; None takes ``taut.threads()``. The last bits depend on it
    - ``biases``: restraints, walls and pulls of a distance, an angle, a torsion or a radius of gyration of groups:
      taut.Distance, Angle, Torsion, Gyration. They take the place of those of the scene, and add to an OpenMM System's

    Units are nm, ps, u, kJ/mol and K. Equal settings and an equal number of threads give the same bits, as the command
    does.

    ``positions`` and ``velocities`` are live views: they show the present state. Write to them, or assign to them,
    between steps or in a callback. taut then brings what you wrote to the bonds and evaluates the forces before it
    answers anything else. Means and the account of the energy begin again.

    Raises InputError for wrong input, and SimulationFailure if the method cannot hold the bonds at the start.
    """

    def __init__(self, scene: inputs.Scene, *, method: Optional[inputs.Method] = None, dt_fs: Optional[float] = None,
                 set: Optional[Mapping[str, Any]] = None, forces: Iterable[Any] = (),
                 out: Union[str, Path, None] = None, overwrite: bool = False, precision: Optional[str] = None,
                 threads: Optional[int] = None, biases: Iterable[Bias] = ()) -> None:
        settings = inputs.overrides(set, method, dt_fs, precision, biases)
        self._make(inputs.read(scene, settings, inputs.number_of_threads(threads)), forces, out, overwrite)

    def _make(self, read: "_core.Input", forces: Iterable[Any], out: Union[str, Path, None], overwrite: bool) -> None:
        self._forces = inputs.own_forces(forces)
        _core.add_forces(read, self._forces)
        if out:
            _release_folder(str(out), close=overwrite)
        self._take_engine(_core.Simulation(read, str(out or ""), overwrite))

    def _take_engine(self, engine: "_core.Simulation") -> None:
        self._engine = engine
        self._process = os.getpid()
        self._earlier = History()
        self._reporters = Reporters()
        if engine.folder:
            _WRITERS[os.path.realpath(engine.folder)] = self

    @classmethod
    def from_openmm(cls, system: Any, positions: Any, *, velocities: Any = None, box: Any = None, topology: Any = None,
                    method: Optional[inputs.Method] = None, dt_fs: Optional[float] = None,
                    set: Optional[Mapping[str, Any]] = None, forces: Iterable[Any] = (),
                    out: Union[str, Path, None] = None, overwrite: bool = False, precision: Optional[str] = None,
                    threads: Optional[int] = None, biases: Iterable[Bias] = ()) -> "Simulation":
        """Makes a simulation of a system that was prepared with OpenMM.

        - ``system``: an openmm.System, its XML, or a file with its XML
        - ``positions``: (n, 3) [nm] or with a unit; or an openmm.State, its XML, or a file with its XML; or a Universe
          of MDAnalysis's, whose present frame also gives velocities and box if it has them
        - ``velocities``: (n, 3) [nm/ps] or with a unit
        - ``box``: three vectors or three edges [nm]; None takes the System's
        - ``topology``: an openmm.app.Topology, or an object that has one (PDBFile, Modeller), or a Universe, for names
          of atoms and residues

        The other arguments are those of the class. Raises InputError that names what taut does not have.
        """
        state = openmm_objects.state_xml(positions, velocities, box)
        settings = inputs.overrides(set, method, dt_fs, precision, biases)
        read = openmm_objects.read(system, state, settings, topology, inputs.number_of_threads(threads))
        simulation = cls.__new__(cls)
        simulation._make(read, forces, out, overwrite)
        return simulation

    @classmethod
    def resume(cls, checkpoint: Union[bytes, bytearray, memoryview, str, Path], *,
               set: Optional[Mapping[str, Any]] = None, forces: Iterable[Any] = (), yes: bool = False,
               threads: Optional[int] = None) -> "Simulation":
        """Makes a simulation that continues from a checkpoint with the same bits.

        - ``checkpoint``: bytes that ``checkpoint()`` returned, a file that it wrote, or the folder of a run, to which
          the simulation then writes. A simulation of this process that writes to the folder is closed. Log and
          summary go on from those of the checkpoint
        - ``set``: settings that may change during a run: steps, log_every, trajectory_every, the thermostat, ...
        - ``forces``: the run's forces of your own, in their order, since a checkpoint holds no code
        - ``yes``: continues even if a file in the folder is cut to less than half, or is gone and begins again
        - ``threads``: None takes ``taut.use_threads()`` or OMP_NUM_THREADS, or else the number that the run had; only
          that number gives the same bits

        Register methods of your own again first (``taut.register``). Raises InputError for what is no checkpoint.
        """
        kept, folder = b"", ""
        if isinstance(checkpoint, (bytes, bytearray, memoryview)):
            kept = bytes(checkpoint)
        elif Path(checkpoint).is_file():
            kept = Path(checkpoint).read_bytes()
        else:
            folder = str(checkpoint)
            _release_folder(folder, close=True)
        asked = {"bytes": kept, "folder": folder, "overrides": inputs.overrides(set, None, None), "yes": yes,
                 "threads": inputs.number_of_threads(threads)}
        simulation = cls.__new__(cls)
        simulation._forces = inputs.own_forces(forces)
        earlier = History.of_folder(folder) if folder else None  # before the run that goes on replaces its files
        simulation._take_engine(_core.Simulation(asked, simulation._forces))
        simulation._earlier = earlier or History.of_bytes(simulation._engine._history())
        simulation._earlier.cut(simulation.steps_taken)
        return simulation

    def run(self, steps: int, *, every: int = 0, callback: Optional[Callable[["_core.Row"], Any]] = None,
            progress: bool = False, timings: bool = False, ramp: Optional[Tuple[float, float]] = None) -> None:
        """Takes this many steps.

        - ``every``: number of steps between rows of the log, the first at the start; 0 keeps the present number
        - ``callback``: is called with every row; the run stops if it returns False
        - ``progress``: shows a bar with ns/day and the time that is left on standard error
        - ``timings``: measures where the time goes also in systems of fewer than 1000 atoms
        - ``ramp``: the thermostat's temperature at the start and at the end [K]. It rises or falls in 100 equal stages,
          or in one a step for fewer steps. Means are those of the last stage

        Meanwhile ``reporters`` report, and other Python threads run. Ctrl-C, and any exception in the callback or in
        a force or method of your own, stop the run between two steps. taut takes a step back that was not finished,
        so the run can continue with the same numbers. Raises SimulationFailure; the state is then that of one step
        before the failure.
        """
        steps, every = inputs.whole(steps, "run(steps)"), inputs.whole(every, "run(every)")
        if timings:
            self._engine._measure_parts()
        bar = RunProgress(self.steps_taken, steps, self.dt_fs) if progress else None
        schedule = Schedule(self._reporters, self) if self._reporters else None
        last = self.steps_taken + steps
        try:
            for stage, temperature in _stages(steps, ramp):
                if temperature is not None:
                    self.set_temperature(temperature)
                ends_at = self.steps_taken + stage
                first_report = schedule.next_after(self.steps_taken) if schedule else 0
                self._engine._run(stage, every, callback, bar, schedule, first_report, ends_at == last)
                if self.steps_taken < ends_at:  # a callback or a reporter stopped it
                    break
        finally:
            if bar is not None:
                bar.end(self.steps_taken)

    @property
    def reporters(self) -> Reporters:
        """What writes or is called while ``run`` takes steps, a list: ``sim.reporters.append(taut.DCD("x.dcd", 100))``.

        It takes taut.DCD, taut.H5MD, taut.XTC, taut.CSV, taut.Call, classes derived from taut.Reporter, and OpenMM's
        reporters that ask for positions, velocities, forces, energies and the box. ``close`` closes their files.
        """
        return self._reporters

    def change(self, settings: Mapping[str, Any]) -> None:
        """Changes settings of thermostat, barostat, method and step, and ``run.log_every``, as ``taut resume --set``.

        ``sim.change({"run.thermostat": "langevin", "run.friction_per_ps": 2})``. Means and the account of the energy
        begin again where the ensemble, the method or the step changes. Raises InputError for a setting that cannot
        change between two runs, or has no effect.
        """
        for key, value in settings.items():
            if value is None:
                raise InputError(f"{key}: expected a value, got None")
            if key not in _CHANGEABLE and not key.startswith("method."):
                raise InputError(f"{key} cannot change between two runs{suggest(key, _CHANGEABLE)}; expected one of "
                                 f"{', '.join(_CHANGEABLE)}, or a key of the method. For others make a Simulation, "
                                 "and assign positions, velocities and box to it")
        if "run.dt_fs" in settings:
            self._reporters.refuse_another_step()
        self._engine._change(inputs.overrides(settings, None, None))

    def set_temperature(self, temperature_k: float) -> None:
        """Changes the temperature of the thermostat [K]. Raises InputError where there is no thermostat."""
        self.change({"run.temperature_k": openmm_objects.number(temperature_k, "K", "set_temperature")})

    @property
    def thermostat(self) -> str:
        """The thermostat: "langevin", "rescaling" or "none". Assign a name, None, or a dict of settings as in

        ``sim.thermostat = {"thermostat": "rescaling", "thermostat_ps": 0.5, "temperature_k": 300}``.
        """
        return str(self._engine._settings()["thermostat"])

    @thermostat.setter
    def thermostat(self, given: Union[str, Mapping[str, Any], None]) -> None:
        self._change_ensemble("thermostat", given)

    @property
    def barostat(self) -> str:
        """The barostat: "c-rescale", "monte-carlo" or "none". Assign a name, None, or a dict of settings as in

        ``sim.barostat = {"barostat": "c-rescale", "pressure_bar": 100}``.
        """
        return str(self._engine._settings()["barostat"])

    @barostat.setter
    def barostat(self, given: Union[str, Mapping[str, Any], None]) -> None:
        self._change_ensemble("barostat", given)

    def _change_ensemble(self, what: str, given: Union[str, Mapping[str, Any], None]) -> None:
        settings = given if isinstance(given, Mapping) else {what: "none" if given is None else given}
        if not isinstance(settings.get(what), str):
            raise InputError(f"{what}: expected a name, None, or a dict with the key {what!r}, got {given!r}")
        self.change({f"run.{key}": value for key, value in settings.items()})

    def step(self, steps: int = 1) -> None:
        """Takes a step, or a few, without a row of the log at the end. Reporters report.

        ``run`` is faster for many steps.
        """
        schedule = Schedule(self._reporters, self) if self._reporters else None
        first_report = schedule.next_after(self.steps_taken) if schedule else 0
        steps = inputs.whole(steps, "step(steps)")
        if steps < 1:
            raise InputError(f"step({steps}): expected 1 or more")
        self._engine._run(steps, 0, None, None, schedule, first_report, False)

    def minimise(self, force_kj_mol_nm: float = 1000.0, *, steps: int = 5000, progress: bool = False) -> Minimisation:
        """Moves the atoms downhill by steepest descent, with bonds at their lengths, and returns what it came to.

        It ends when no atom's force is above ``force_kj_mol_nm`` [kJ/mol/nm], when no move lowers the energy any more,
        or after this many ``steps``. ``progress`` shows a line on standard error. Other Python threads run meanwhile.
        After Ctrl-C, or an exception in a force of your own, the state is what it was before.
        """
        force = openmm_objects.number(force_kj_mol_nm, "kJ/mol/nm", "minimise")
        line = MinimiseProgress() if progress else None
        try:
            taken, before, energy, left = self._engine._minimise(force, inputs.whole(steps, "steps"), line)
        finally:
            if line is not None:
                line.end()
        return Minimisation(before, energy, left, taken, left <= force)

    def checkpoint(self, file: Union[str, Path, None] = None) -> bytes:
        """Returns all that the next steps depend on, with log and summary, and writes it to a file if one is named.

        ``Simulation.resume`` takes the bytes and the file.
        """
        kept: bytes = self._engine._checkpoint(History(self.log, self._engine._summary()).to_bytes())
        if file is not None:
            Path(file).write_bytes(kept)
        return kept

    def close(self) -> None:
        """Ends the run and releases its folder. State, log and summary can still be read; no further step is taken.

        Raises RuntimeError while another thread runs the simulation.
        """
        self._engine._close()
        for reporter in self._reporters:
            if hasattr(reporter, "close"):
                reporter.close()

    def __enter__(self) -> "Simulation":
        return self

    def __exit__(self, *error: Any) -> None:
        self.close()

    def __setattr__(self, name: str, value: Any) -> None:
        there = getattr(type(self), name, None)
        if not name.startswith("_") and getattr(there, "fset", None) is None:
            if there is not None:
                raise AttributeError(f"{name} cannot be set; positions, velocities, box, dt_fs, method, thermostat "
                                     "and barostat can")
            nearest = suggest(name, [known for known in dir(Simulation) if not known.startswith("_")])
            if nearest or type(self) is Simulation:  # a class derived from this one may have attributes of its own
                raise AttributeError(f"a Simulation has no attribute {name}{nearest}")
        super().__setattr__(name, value)

    if not TYPE_CHECKING:

        def __getattr__(self, name):
            nearest = suggest(name, [known for known in dir(type(self)) if not known.startswith("_")])
            raise AttributeError(f"a Simulation has no attribute {name}{nearest}")

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
        """Forces, (n, 3) [kJ/mol/nm], a live view that cannot be written to. They include what the method added."""
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
        """Masses, (n,) [u]. An atom of mass 0 is anchored and never moves, or is a virtual site."""
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
        """Temperature of the present state [K]."""
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
    def log(self) -> Log:
        """Rows of the log so far: a dict of columns "step", "time_ps", "temperature_k", ..., numpy arrays.

        ``help(taut.Row)`` describes the columns. A number that the run does not have is nan.
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

    @property
    def time_ps(self) -> float:
        """Time of the present state [ps]."""
        return self._engine.time_ps

    @property
    def steps_taken(self) -> int:
        """Number of steps taken so far."""
        return self._engine.steps_taken

    @property
    def dt_fs(self) -> float:
        """Length of a step [fs]. Assign another one between two runs."""
        return self._engine.dt_fs

    @dt_fs.setter
    def dt_fs(self, given: float) -> None:
        self.change({"run.dt_fs": openmm_objects.number(given, "fs", "dt_fs")})

    @property
    def threads(self) -> int:
        """Number of threads that compute. The order of sums, and so the last bits, depend on it."""
        return self._engine.threads

    @property
    def method(self) -> str:
        """Name of the constraint method. Assign a name, ``taut.Rattle(tolerance=1e-8)`` or a class of your own."""
        return self._engine.method

    @method.setter
    def method(self, given: inputs.Method) -> None:
        if given is None:
            raise InputError("method: expected a name, taut.Rattle(...) or the like, or a class of your own, got None")
        self._engine._change(inputs.overrides(None, given, None))

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
        """Remarks on the start, a line each, and where the folder's earlier run is kept."""
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

    def __reduce__(self) -> Tuple[Any, ...]:
        return _unpickled, (type(self), self.checkpoint(), self._forces, parts.REGISTERED.get(self.method),
                            self.threads)

    def __repr__(self) -> str:
        return (f"<taut.Simulation {self.name}: {len(self.masses)} atoms, {len(self.lengths)} rigid bonds, "
                f"{self.method}, {self.dt_fs:g} fs, {self.steps_taken} steps taken>")

    def _repr_html_(self) -> str:
        """Returns what a notebook shows: a small table of the system and of the last row of the log."""
        rows = {"scene": self.name, "atoms": f"{len(self.masses)}", "rigid bonds": f"{len(self.lengths)}",
                "method": f"{self.method}: {self.setting}" if self.setting else self.method,
                "step": f"{self.dt_fs:g} fs", "steps taken": f"{self.steps_taken} ({self.time_ps:g} ps)",
                "threads": f"{self.threads}"}
        if self.folder:
            rows["folder"] = self.folder
        if len(self.log["step"]):
            last = {name: column[-1] for name, column in self.log.items()}
            rows["last row of the log"] = (f"step {last['step']}: {last['total_kj_mol']:.8g} kJ/mol, "
                                           f"{last['temperature_k']:.2f} K, largest bond error "
                                           f"{last['max_rel_bond_error']:.1e}")
        return table("taut.Simulation", rows)

    def plot(self) -> Any:
        """Draws the log: energy, temperature, bond errors, and pressure in a box. Returns matplotlib's figure."""
        from . import drawing

        return drawing.log(self.log, self.name)
