"""taut.Simulation: a system that runs."""

from __future__ import annotations

import os
import warnings
import weakref
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Optional, Tuple, Union

from . import _core, inputs, openmm_objects, parts
from .biases import Bias
from .errors import InputError, suggest
from .history import History, texts_of
from .readings import Readings
from .progress import MinimiseProgress, RunProgress
from .reporters import Reporters, Schedule
from .showing import simulation_table

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
_CHANGEABLE = [f"run.{key}" for key in (
    "barostat", "barostat_every", "barostat_ps", "compressibility_per_bar", "coupling", "dt_fs", "friction_per_ps",
    "log_every", "pressure_bar", "temperature_k", "thermostat", "thermostat_ps")]


def _unpickled(kind: Any, checkpoint: bytes, forces: Any, method: Optional[type],
               threads: Optional[int] = None) -> "Simulation":
    if method is not None:
        parts.register(method)
    simulation: Simulation = kind.resume(checkpoint, forces=forces, threads=threads)
    return simulation


class Simulation(Readings):
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
        if out == "":
            raise InputError("out: expected a folder, got an empty name; None writes nothing")
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
        texts = texts_of(folder) if folder else None  # before the run that goes on replaces its files
        simulation._take_engine(_core.Simulation(asked, simulation._forces))
        engine = simulation._engine
        simulation._earlier = (History.of_texts(*texts, engine._titles()) if texts
                               else History.of_bytes(engine._history()))
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
            for stage, temperature in inputs.ramp_stages(steps, ramp):
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
        begin again where the ensemble, the method or the step changes. What then speaks against the run, a step that does
        not resolve a spring, is a warning, and in ``notes``. Raises InputError for a setting that cannot
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
        known = self.notes
        self._engine._change(inputs.overrides(settings, None, None))
        for note in self.notes:
            if note not in known:
                warnings.warn(note, stacklevel=2)

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
    def dt_fs(self) -> float:
        """Length of a step [fs]. Assign another one between two runs."""
        return self._engine.dt_fs

    @dt_fs.setter
    def dt_fs(self, given: float) -> None:
        self.change({"run.dt_fs": openmm_objects.number(given, "fs", "dt_fs")})

    @property
    def method(self) -> str:
        """Name of the constraint method. Assign a name, ``taut.Rattle(tolerance=1e-8)`` or a class of your own."""
        return self._engine.method

    @method.setter
    def method(self, given: inputs.Method) -> None:
        if given is None:
            raise InputError("method: expected a name, taut.Rattle(...) or the like, or a class of your own, got None")
        self._engine._change(inputs.overrides(None, given, None))

    def __reduce__(self) -> Tuple[Any, ...]:
        return _unpickled, (type(self), self.checkpoint(), self._forces, parts.REGISTERED.get(self.method),
                            self.threads)

    def __repr__(self) -> str:
        return (f"<taut.Simulation {self.name}: {len(self.masses)} atoms, {len(self.lengths)} rigid bonds, "
                f"{self.method}, {self.dt_fs:g} fs, {self.steps_taken} steps taken>")

    def _repr_html_(self) -> str:
        """Returns what a notebook shows: a small table of the system and of the last row of the log."""
        return simulation_table(self)
