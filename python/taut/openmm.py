"""taut's rigid bonds in OpenMM: an integrator of OpenMM's own kind, for any of its scripts.

    >>> import taut.openmm
    >>> integrator = taut.openmm.Integrator(0.002, method="feedforward")                     # constant energy
    >>> integrator = taut.openmm.Integrator(0.002, temperature=300, friction=1)              # Langevin
    >>> simulation = openmm.app.Simulation(topology, system, integrator)

It holds the System's constraints, and besides them those that are given to it:

    >>> bonds = taut.openmm.rigid_bonds(system)                     # OpenMM's own constraints never see them
    >>> integrator = taut.openmm.Integrator(0.02, bonds=bonds)

openmm_plugin/README.md of the sources has the rest.
"""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from typing import Any, Dict, Iterable, List, Optional, Tuple
from xml.sax.saxutils import quoteattr

import openmm
from openmm import unit

from . import _core

Number = Any  # a number, or a Quantity of OpenMM's
Bond = Tuple[int, int, Number]  # two atoms, and their distance in nm
_PICOSECOND, _RATE = unit.picosecond, unit.picosecond**-1
_plugin: Optional[ctypes.CDLL] = None


def _number(value: Number, of_unit: Any) -> float:
    return float(value.value_in_unit(of_unit) if unit.is_quantity(value) else value)


def plugin_path() -> Path:
    """Returns where the plug-in for this OpenMM is: TAUT_OPENMM_PLUGIN, or beside the module."""
    if named := os.environ.get("TAUT_OPENMM_PLUGIN"):
        return Path(named)
    version = ".".join(openmm.Platform.getOpenMMVersion().split(".")[:2])
    folder = Path(_core.__file__).parent / "openmm_plugin"
    path = folder / version / "libtaut_openmm.so"
    if path.exists():
        return path
    built = ", ".join(sorted(p.parent.name for p in folder.glob("*/libtaut_openmm.so"))) or "none"
    raise ImportError(f"taut.openmm: no plug-in for OpenMM {version} in {folder} (built for: {built}); build it with "
                      f"cmake -DTAUT_OPENMM_ROOT={Path(openmm.__file__).parents[1] / 'OpenMM.libs'}")


def _parts() -> Dict[str, Path]:
    """The plug-in's parts for platforms of devices that OpenMM has here."""
    known = [openmm.Platform.getPlatform(n).getName() for n in range(openmm.Platform.getNumPlatforms())]
    paths = {name: plugin_path().with_name(f"libtaut_openmm_{name.lower()}.so") for name in ("OpenCL", "CUDA", "HIP")}
    return {name: path for name, path in paths.items() if name in known and path.exists()}


def platforms() -> List[str]:
    """Returns the platforms that hold the bonds. OpenMM refuses others, and takes the fastest if none is named."""
    load()
    return ["Reference", "CPU", *_parts()]


def load() -> ctypes.CDLL:
    """Loads the plug-in, once, for all platforms that OpenMM has by then. Integrator() calls it."""
    global _plugin
    if _plugin is None:
        path = str(plugin_path())
        openmm.Platform.loadPluginLibrary(path)
        _plugin = ctypes.CDLL(path)
        _plugin.taut_set_bath.restype = ctypes.c_char_p
        _plugin.taut_set_bath.argtypes = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double]
        _plugin.taut_temperature.restype = ctypes.c_char_p
        _plugin.taut_temperature.argtypes = [ctypes.c_void_p, ctypes.POINTER(ctypes.c_double)]
        _plugin.taut_set_seed.argtypes = [ctypes.c_void_p, ctypes.c_uint64]
        for part in _parts().values():
            openmm.Platform.loadPluginLibrary(str(part))
    return _plugin


def rigid_bonds(system: openmm.System, bonds: Optional[Iterable[Bond]] = None) -> List[Bond]:
    """Returns rigid bonds for Integrator(bonds=…), and puts springs of 10⁶ kJ/mol/nm² in their place into the System.

    They are the System's constraints, which leave it, or `bonds`. By the springs minimizers know of the bonds, and
    barostats of the molecules; in a run they do nothing, since the bonds keep their lengths.
    """
    if bonds is None:
        bonds = [system.getConstraintParameters(k) for k in range(system.getNumConstraints())]
        for k in reversed(range(system.getNumConstraints())):
            system.removeConstraint(k)
    taken = [(int(i), int(j), _number(length, unit.nanometer)) for i, j, length in bonds]
    springs = openmm.HarmonicBondForce()
    springs.setName("taut's rigid bonds")
    for i, j, length in taken:
        springs.addBond(i, j, length, 1e6)
    system.addForce(springs)
    return taken


class Integrator(openmm.Integrator):  # type: ignore[misc, unused-ignore]
    """Velocity Verlet, or with friction Langevin's dynamics, with rigid bonds held by a method of taut's: the
    System's constraints and, besides, `bonds`, a list of (atom, atom, length), where the length is in nm.

    dt: the step, a Quantity or in ps. method: one of taut.methods(), with its options by name, as help(taut.Newton)
    and so on list them: Integrator(0.002, "newton", tolerance=1e-8). temperature in K and friction in 1/ps belong
    together. seed 0: every Context draws its own.
    """

    def __init__(self, dt: Number, method: str = "feedforward", *, temperature: Number = 0.0, friction: Number = 0.0,
                 seed: int = 0, bonds: Iterable[Bond] = (), **options: Any) -> None:
        load()
        kelvin, rate = _number(temperature, unit.kelvin), _number(friction, _RATE)
        words = {key: str(value).lower() if isinstance(value, bool) else str(value) for key, value in options.items()}
        said = " ".join(f"{key}={quoteattr(word)}" for key, word in words.items())
        held = "".join(f'<Bond p1="{int(i)}" p2="{int(j)}" d="{_number(length, unit.nanometer)!r}"/>'
                       for i, j, length in bonds)
        self._take(openmm.XmlSerializer.deserialize(
            f'<Integrator type="TautIntegrator" version="1" stepSize="{_number(dt, _PICOSECOND)!r}" '
            f'method={quoteattr(method)} temperature="{kelvin!r}" friction="{rate!r}" randomSeed="{int(seed)}">'
            f"<Options {said}/><Bonds>{held}</Bonds></Integrator>"), kelvin, rate, int(seed))

    def _take(self, made: openmm.Integrator, kelvin: float, rate: float, seed: int) -> None:
        self.this = made.this
        self._kelvin, self._rate, self._seed = kelvin, rate, seed

    def _ask(self, call: Any, *arguments: Any) -> None:
        refused = call(int(self.this), *arguments)
        if refused:
            raise openmm.OpenMMException(refused.decode())

    def computeSystemTemperature(self) -> unit.Quantity:
        """Returns the Context's temperature now, with all rigid bonds counted; StateDataReporter writes it."""
        kelvin = ctypes.c_double()
        self._ask(load().taut_temperature, ctypes.byref(kelvin))
        return kelvin.value * unit.kelvin

    def _set_bath(self, kelvin: float, rate: float) -> None:
        self._ask(load().taut_set_bath, kelvin, rate)
        self._kelvin, self._rate = kelvin, rate

    def getTemperature(self) -> unit.Quantity:
        return self._kelvin * unit.kelvin

    def setTemperature(self, temperature: Number) -> None:
        self._set_bath(_number(temperature, unit.kelvin), self._rate)

    def getFriction(self) -> unit.Quantity:
        return self._rate * _RATE

    def setFriction(self, friction: Number) -> None:
        self._set_bath(self._kelvin, _number(friction, _RATE))

    def getRandomNumberSeed(self) -> int:
        return self._seed

    def setRandomNumberSeed(self, seed: int) -> None:
        load().taut_set_seed(int(self.this), int(seed))
        self._seed = int(seed)

    def __copy__(self) -> Integrator:
        copy = Integrator.__new__(Integrator)
        copy._take(openmm.XmlSerializer.clone(self), self._kelvin, self._rate, self._seed)
        return copy

    def __deepcopy__(self, memo: Any) -> Integrator:
        return self.__copy__()

    def __getstate__(self) -> Tuple[str, float, float, int]:
        return openmm.XmlSerializer.serialize(self), self._kelvin, self._rate, self._seed

    def __setstate__(self, state: Tuple[str, float, float, int]) -> None:
        load()
        self._take(openmm.XmlSerializer.deserialize(state[0]), *state[1:])
