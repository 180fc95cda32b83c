"""taut.Simulation."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, Callable, Dict, Iterable, Mapping, Optional, Tuple, Union

import numpy as np

from . import _core, inputs, openmm_objects, parts


def _shown(name: str) -> Any:
    """A property of the engine's."""
    return property(lambda self: getattr(self._engine, name), doc=getattr(_core.Simulation, name).__doc__)


def _unpickled(kind: Any, checkpoint: bytes, forces: Any, method: Optional[type],
               threads: Optional[int] = None) -> "Simulation":
    if method is not None:
        parts.register(method)
    simulation: Simulation = kind.resume(checkpoint, forces=forces, threads=threads)
    return simulation


class Simulation:
    """A scene made to run: forces and method made, the start brought to the bonds.

    ::

        sim = taut.Simulation("water", method="feedforward", dt_fs=2, set={"build.molecules": 1000})
        sim.run(10_000, every=100, callback=print)
        sim.positions            # (n, 3) [nm]

    scene   a name (``taut.scenes()``), a file, or a dict of what a file says, section by section
    method  a name (``taut.methods()``), options such as ``taut.Rattle(tolerance=1e-8)``, or a class of your own
            derived from ``taut.ConstraintMethod``; None: the scene's
    dt_fs   length of a step [fs]; None: the scene's
    set     any key of the scene: ``{"run.seed": 7, "run.thermostat": "langevin"}``
    forces  forces of your own, instances of classes derived from ``taut.Force``
    out     a folder for log.csv, checkpoints, trajectories (``run.trajectory_every``) and the final state, as the
            command ``taut run --out`` writes them
    overwrite  what run is in the folder is first moved aside
    threads  so many compute as long as it lives; None: as ``taut.threads()`` says now. The last bits depend on it

    Units are nm, ps, u, kJ/mol and K throughout. The same settings give the same bits as the command's.

    ``positions`` and ``velocities`` are live views, (n, 3): they show the state as it is, and as it last was when the
    simulation is gone. Write to them between steps (in a callback, too): what you wrote is brought to the bonds, and forces are
    evaluated, before anything else is asked of the simulation. Means and the energy's account then begin again.
    ``forces``, (n, 3) [kJ/mol/nm], cannot be written to; they hold what the method added.

    Raises InputError for wrong input, SimulationFailure where bonds or method cannot hold the start.
    """

    def __init__(self, scene: inputs.Scene, *, method: Optional[inputs.Method] = None, dt_fs: Optional[float] = None,
                 set: Optional[Mapping[str, Any]] = None, forces: Iterable[Any] = (),
                 out: Union[str, Path, None] = None, overwrite: bool = False, threads: Optional[int] = None) -> None:
        self._make(inputs.read(scene, inputs.overrides(set, method, dt_fs), threads), forces, out, overwrite)

    def _make(self, read: "_core.Input", forces: Iterable[Any], out: Union[str, Path, None], overwrite: bool) -> None:
        self._forces = inputs.own_forces(forces)
        _core.add_forces(read, self._forces)
        self._engine = _core.Simulation(read, str(out or ""), overwrite)

    @classmethod
    def from_openmm(cls, system: Any, positions: Any, *, velocities: Any = None, box: Any = None, topology: Any = None,
                    method: Optional[inputs.Method] = None, dt_fs: Optional[float] = None,
                    set: Optional[Mapping[str, Any]] = None, forces: Iterable[Any] = (),
                    out: Union[str, Path, None] = None, overwrite: bool = False,
                    threads: Optional[int] = None) -> "Simulation":
        """What was prepared with OpenMM.

        system     openmm.System, its XML, or a file of it
        positions  openmm.State, its XML or a file of it; or positions, (n, 3) [nm] or with a unit
        velocities (n, 3) [nm/ps] or with a unit; box: three vectors or edges [nm], else the System's own
        topology   openmm.app.Topology, or what has one (PDBFile, Modeller): names of atoms and residues

        The rest as for the class. Raises InputError for what taut does not have, by name.
        """
        state = openmm_objects.state_xml(positions, velocities, box)
        read = openmm_objects.read(system, state, inputs.overrides(set, method, dt_fs), topology, threads)
        simulation = cls.__new__(cls)
        simulation._make(read, forces, out, overwrite)
        return simulation

    @classmethod
    def resume(cls, checkpoint: Union[bytes, str, Path], *, set: Optional[Mapping[str, Any]] = None,
               forces: Iterable[Any] = (), yes: bool = False, threads: Optional[int] = None) -> "Simulation":
        """A run as it was at a checkpoint: goes on from there to the last bit.

        checkpoint  what checkpoint() gave, or the folder of a run, which is then gone on with
        set         what may change in a run that has begun: steps, log_every, trajectory_every, the thermostat, ...
        forces      the forces of your own that it had, in their order: they are code, which no checkpoint has
        yes         go on though outputs in the folder are cut back to less than half, or begin anew
        threads     None: as ``taut.use_threads()`` or OMP_NUM_THREADS says, or else as many as it had, which alone
                    gives the same bits

        Methods of your own have to be registered again (``taut.register``).
        """
        kept = isinstance(checkpoint, bytes)
        asked = {"bytes": checkpoint if kept else b"", "folder": "" if kept else str(checkpoint),
                 "overrides": inputs.overrides(set, None, None), "yes": yes, "threads": threads}
        simulation = cls.__new__(cls)
        simulation._forces = inputs.own_forces(forces)
        simulation._engine = _core.Simulation(asked, simulation._forces)
        return simulation

    def run(self, steps: int, *, every: int = 0, callback: Optional[Callable[["_core.Row"], Any]] = None) -> None:
        """Takes so many steps.

        every     steps from row to row of the log (0: as before), the first at the start
        callback  is called with every row; False, numpy's too, stops the run. Other Python threads run meanwhile

        Ctrl-C, or any exception in the callback, in a force or a method of your own, stops it between two steps: a step
        that was begun is taken back, all is whole, and can go on to the same numbers. Raises SimulationFailure, with
        the state as it was one step before.
        """
        self._engine._run(steps, every, callback, True)

    def step(self, steps: int = 1) -> None:
        """Takes a step, or a few, without a row of the log at the end. run() is faster for many."""
        self._engine._run(steps, 0, None, False)

    def minimise(self, force_kj_mol_nm: float = 1000.0) -> None:
        """Steepest descent along the bonds' manifold until no atom's force is above this [kJ/mol/nm].

        Other Python threads run meanwhile. Ctrl-C, or any exception in a force of your own, leaves all as it was.
        """
        self._engine._minimise(force_kj_mol_nm)

    def checkpoint(self, file: Union[str, Path, None] = None) -> bytes:
        """All that the steps to come depend on; written to a file, too, if one is named."""
        kept: bytes = self._engine._checkpoint()
        if file is not None:
            Path(file).write_bytes(kept)
        return kept

    positions = _shown("positions")
    velocities = _shown("velocities")
    forces = _shown("forces")
    box = _shown("box")
    bonds = _shown("bonds")
    lengths = _shown("lengths")
    masses = _shown("masses")
    tensions = _shown("tensions")
    energies = _shown("energies")
    temperature = _shown("temperature")
    pressure_tensor = _shown("pressure_tensor")
    constraint_work = _shown("constraint_work")
    log = _shown("log")
    time_ps = _shown("time_ps")
    steps_taken = _shown("steps_taken")
    dt_fs = _shown("dt_fs")
    threads = _shown("threads")
    method = _shown("method")
    setting = _shown("setting")
    degrees_of_freedom = _shown("degrees_of_freedom")
    name = _shown("name")
    notes = _shown("notes")
    folder = _shown("folder")

    @property
    def summary(self) -> Optional[Dict[str, Any]]:
        """What the last run came to, as summary.json has it; None before there was one."""
        summary: Optional[Dict[str, Any]] = json.loads(self._engine._summary())
        return summary

    @property
    def pressure(self) -> Optional[float]:
        """A third of the pressure tensor's trace [bar]; None without a box."""
        tensor = self.pressure_tensor
        return None if tensor is None else float(tensor.trace() / 3)

    @property
    def bond_errors(self) -> np.ndarray:
        """Relative error of each rigid bond's length, (m,)."""
        i, j = self.bonds.T
        errors: np.ndarray = np.linalg.norm(self.positions[j] - self.positions[i], axis=1) / self.lengths - 1
        return errors

    @property
    def names(self) -> Dict[str, Any]:
        """Of every atom: "atom", "residue" and "element", (n,) texts, and "residue_index", (n,)."""
        return dict(zip(("atom", "residue", "element", "residue_index"), map(np.array, self._engine._names())))

    def to_openmm(self) -> Tuple[Any, Any]:
        """openmm.System and openmm.State of the same system, as it is now."""
        return openmm_objects.objects_of(*self._engine._to_openmm())

    def to_openmm_xml(self) -> Tuple[str, str]:
        """The same as XML, for which OpenMM is not needed."""
        system, state = self._engine._to_openmm()
        return system, state

    def universe(self) -> Any:
        """An MDAnalysis.Universe of the state as it is: names, masses, bonds, positions [Å], velocities."""
        import MDAnalysis

        names = self.names
        residues, of_atom = np.unique(names["residue_index"], return_inverse=True)
        universe = MDAnalysis.Universe.empty(len(self.masses), n_residues=len(residues), atom_resindex=of_atom,
                                             trajectory=True, velocities=True)
        first = np.unique(of_atom, return_index=True)[1]
        universe.add_TopologyAttr("names", names["atom"])
        universe.add_TopologyAttr("elements", names["element"])
        universe.add_TopologyAttr("types", names["element"])
        universe.add_TopologyAttr("resnames", names["residue"][first])
        universe.add_TopologyAttr("resids", residues + 1)
        universe.add_TopologyAttr("masses", self.masses)
        universe.add_TopologyAttr("bonds", [tuple(bond) for bond in self.bonds])
        universe.atoms.positions = 10 * self.positions
        universe.atoms.velocities = 10 * self.velocities
        if self.box is not None:
            from MDAnalysis.lib.mdamath import triclinic_box

            universe.dimensions = triclinic_box(*(10 * self.box))
        return universe

    def __reduce__(self) -> Tuple[Any, ...]:
        return _unpickled, (type(self), self.checkpoint(), self._forces, parts.REGISTERED.get(self.method),
                            self.threads)

    def __repr__(self) -> str:
        return (f"<taut.Simulation {self.name}: {len(self.masses)} atoms, {len(self.lengths)} rigid bonds, "
                f"{self.method}, {self.dt_fs:g} fs, {self.steps_taken} steps taken>")
