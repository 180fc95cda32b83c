"""The classes taut.Rattle, taut.Baumgarte, ...: the options of each method, made from the engine's own list."""

from __future__ import annotations

import dataclasses
from typing import Any, ClassVar, Dict, Optional

from . import _core


@dataclasses.dataclass
class Options:
    """The options of a method: ``taut.Simulation("water", method=taut.Rattle(tolerance=1e-8))``."""

    method: ClassVar[str]

    def __post_init__(self) -> None:
        """Raises InputError for a value that the method does not take, with the nearest name."""
        from . import inputs  # which takes options itself

        said = {key: value for key, value in self.settings().items() if value is not None}
        _core.check_method([f"{key}={inputs.toml(value, key)}" for key, value in said.items()])

    def settings(self) -> Dict[str, Any]:
        """Returns the settings that choose the method: its name, and the options that are not the default."""
        said = {f"method.{f.name}": getattr(self, f.name) for f in dataclasses.fields(self)
                if getattr(self, f.name) != f.default}
        return {"method.name": self.method, **said}


def _type_of(option: Dict[str, Any]) -> Any:
    return Optional[float] if option["number"] else type(option["default"])


def _line(option: Dict[str, Any]) -> str:
    unit = f" [{option['unit']}]" if option["unit"] else ""
    limits = f" ({option['allowed']})" if option["allowed"] else ""
    return f"- ``{option['key']}`` = {option['default']!r}: {option['meaning']}{unit}{limits}"


_SPELT = {"mshake": "MShake", "none": "Uncorrected"}


def _options_class(method: Dict[str, Any]) -> type:
    fields = [(o["key"], _type_of(o), dataclasses.field(default=o["default"])) for o in method["options"]]
    name = _SPELT.get(method["name"], method["name"].capitalize())
    made = dataclasses.make_dataclass(name, fields, bases=(Options,), namespace={"method": method["name"]})
    lines = [method["summary"], ""] + [_line(o) for o in method["options"]]
    made.__doc__ = "\n".join(lines).strip()
    made.__module__ = __name__
    return made


CLASSES: Dict[str, type] = {m["name"]: _options_class(m) for m in _core.describe_methods()}
globals().update({made.__name__: made for made in CLASSES.values()})
__all__ = [made.__name__ for made in CLASSES.values()] + ["Options", "methods"]


def methods() -> Dict[str, str]:
    """Returns the constraint methods that come with taut, by name, with a line on each.

    ``help(taut.Baumgarte)`` describes the options of one.
    """
    return {m["name"]: m["summary"] for m in _core.describe_methods()}
