"""Turns what a user gives, a name, a file, a dict or OpenMM's objects, into what the engine reads."""

from __future__ import annotations

import numbers
from pathlib import Path
from typing import Any, Dict, Iterable, List, Mapping, Optional, Tuple, Union

from . import _core, biases, openmm_objects, options, parts
from .errors import InputError

#: A scene: its name, as in taut.scenes(), its file, or a dict with the sections of a file. Studies also take
#: (system, positions) or (system, positions, topology) as Simulation.from_openmm does.
Scene = Union[str, Path, Mapping[str, Any], Tuple[Any, ...]]
#: A method: its name, a class of options, or a class of your own.
Method = Union[str, "options.Options", type, "parts.ConstraintMethod"]


def toml(value: Any, key: str) -> str:
    """Returns a value as TOML writes it. Raises InputError that names the key for what TOML has not."""
    if hasattr(value, "tolist"):  # numpy's
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (str, Path)):
        return _core.quoted(str(value))
    if isinstance(value, numbers.Integral):
        return str(int(value))
    if isinstance(value, numbers.Real):
        return repr(float(value))
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(one, key) for one in value) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_core.quoted(str(name))} = {toml(one, f'{key}.{name}')}"
                               for name, one in value.items() if one is not None) + "}"
    raise InputError(f"{key}: expected a number, a text, True or False, a list or a dict of these, got {value!r}")


def scene_text(scene: Mapping[str, Any]) -> str:
    """Returns the text of a scene's file from a dict of sections."""
    top, sections = [], []
    for name, content in scene.items():
        if isinstance(content, Mapping):
            lines = [f"{_core.quoted(str(key))} = {toml(value, f'{name}.{key}')}" for key, value in content.items()
                     if value is not None]
            sections.append("\n".join([f"[{_core.quoted(str(name))}]"] + lines))
        else:
            top.append(f"{_core.quoted(str(name))} = {toml(content, str(name))}")
    return "\n".join(top + sections) + "\n"


def whole(number: Any, what: str) -> int:
    """Returns a whole number, also of 1e4. Raises InputError that names the argument for any other."""
    try:
        asked = None if isinstance(number, (bool, str)) or int(number) != number else int(number)
    except (TypeError, ValueError, OverflowError):
        asked = None
    if asked is None:
        raise InputError(f"{what}: expected a whole number, got {number!r}")
    if abs(asked) >= 2**63:
        raise InputError(f"{what}: {number!r} is too large")
    return asked


def number_of_threads(threads: Any) -> Optional[int]:
    """Returns a number of threads, None for the default. Raises InputError for what is no whole number."""
    return None if threads is None else whole(threads, "threads")


def items(given: Iterable[Any], what: str) -> List[Any]:
    """Returns what an argument lists. Raises InputError that names the argument for what is no list."""
    if isinstance(given, type) or not hasattr(given, "__iter__"):
        raise InputError(f"{what}: expected a list, got {given!r}")
    return list(given)


def overrides(given: Optional[Mapping[str, Any]], method: Optional[Method], dt_fs: Optional[float],
              precision: Optional[str] = None, of_biases: Iterable[Any] = ()) -> List[str]:
    """Returns the settings that replace those of a scene, as in ``"run.dt_fs=2"``."""
    said: Dict[str, Any] = {}
    of_word: List[str] = []  # the settings of a method in a word, "rattle:sweeps=4"
    if isinstance(method, str):
        said["method.name"], of_word = method.split(":")[0], _core.overrides_of_method(method)[1:]
    elif isinstance(method, options.Options):
        said.update(method.settings())
    elif isinstance(method, type) and issubclass(method, options.Options):
        said.update(method().settings())
    elif method is not None and parts.is_method(method):
        said.update(parts.settings_of(method))
    elif method is not None:
        raise InputError(f"method: expected a name, taut.Rattle(...) or the like, or a class derived from "
                         f"taut.ConstraintMethod, got {method!r}")
    if dt_fs is not None:
        said["run.dt_fs"] = openmm_objects.number(dt_fs, "fs", "run.dt_fs")
    if precision is not None:
        said["forcefield.precision"] = precision
    if listed := biases.settings_of(items(of_biases, "biases")):
        said["bias"] = listed
    if given is not None and not isinstance(given, Mapping):
        raise InputError(f"set: expected a dict of a scene's keys, {{\"run.seed\": 7}}, got {given!r}")
    for key, value in (given or {}).items():
        if not isinstance(key, str):
            raise InputError(f"set: expected a scene's keys, \"run.seed\", got {key!r}")
        if any(setting.startswith(f"{key}=") for setting in of_word):
            raise InputError(f"{key} is said twice, in {method!r} and as {value!r}; leave one out")
        if key in said and said[key] != value:
            raise InputError(f"{key} is said twice, {said[key]!r} and {value!r}; leave one out")
        said[key] = value
    return [f"{key}={toml(value, key)}" for key, value in said.items() if value is not None] + of_word


def own_forces(forces: Iterable[Any]) -> List[Any]:
    """Returns forces of the user's own as a list. Raises InputError for what is none, or has no ``add``."""
    for force in (listed := items(forces, "forces")):
        if isinstance(force, type) or not callable(getattr(force, "add", None)):
            raise InputError(f"forces: expected instances of classes derived from taut.Force, got {force!r}")
        if getattr(type(force), "add", None) is parts.Force.add:
            raise InputError(f"forces: {type(force).__name__} has no method add(self, positions, forces); write it")
    return listed


def read(scene: Scene, said: List[str], threads: Optional[int] = None) -> "_core.Input":
    """Reads a scene with the settings that replace its own, for this number of threads."""
    if isinstance(scene, Mapping):
        return _core.Input.of_toml(scene_text(scene), said, threads)
    if isinstance(scene, (str, Path)):
        return _core.Input.of_scene(str(scene), said, threads)
    if isinstance(scene, tuple) and len(scene) in (2, 3):
        system, positions, topology = scene if len(scene) == 3 else (*scene, None)
        return openmm_objects.read(system, openmm_objects.state_xml(positions, None, None), said, topology, threads)
    raise InputError(f"expected a scene's name, its file, a dict, or (system, positions) of OpenMM's, got {scene!r}")


def ramp_stages(steps: int, ramp: Optional[Tuple[float, float]]) -> List[Tuple[int, Optional[float]]]:
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
