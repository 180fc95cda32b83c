"""Writes options.pyi, the types of the methods' options, from the engine's own list of methods.

python3 stubs.py FOLDER    FOLDER is that of the package, with _core in it
"""

import importlib
import sys
from pathlib import Path

folder = Path(sys.argv[1])
sys.path.insert(0, str(folder))
described = importlib.import_module("_core").describe_methods()
SPELT = {"mshake": "MShake", "none": "Uncorrected"}

text = """# Made from the engine's list of methods by python/stubs.py.
from dataclasses import dataclass
from typing import Any, ClassVar, Dict, Optional, Type

__all__ = NAMES

CLASSES: Dict[str, Type[Options]]

def methods() -> Dict[str, str]: ...
@dataclass
class Options:
    method: ClassVar[str]
    def settings(self) -> Dict[str, Any]: ...
"""
for method in described:
    text += f"\n@dataclass\nclass {SPELT.get(method['name'], method['name'].capitalize())}(Options):\n"
    for option in method["options"]:
        kind = "Optional[float]" if option["number"] else type(option["default"]).__name__
        text += f"    {option['key']}: {kind} = ...\n"
    text += "" if method["options"] else "    ...\n"
names = [SPELT.get(method["name"], method["name"].capitalize()) for method in described] + ["Options", "methods"]
text = text.replace("NAMES", "[" + ", ".join(f'"{name}"' for name in names) + "]")
(folder / "options.pyi").write_text(text)
