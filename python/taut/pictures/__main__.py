"""Draws for the command: reads as JSON from standard input what is to be drawn, and writes what was as JSON to standard
output. Ends with 4 where matplotlib is missing, and says so."""

import contextlib
import importlib
import io
import json
import os
import shutil
import signal
import sys
import tempfile
from pathlib import Path
from typing import Any, Dict

NO_MATPLOTLIB = 4


def _keep_caches_out(environment: Any) -> None:
    """Gives matplotlib a folder of its own for this process where it has none yet, or may not write there."""
    usual = Path(environment.get("XDG_CACHE_HOME") or Path(environment.get("HOME") or "/nonexistent") / ".cache") / "matplotlib"
    if "MPLCONFIGDIR" not in environment and not os.access(usual, os.W_OK):
        environment["MPLCONFIGDIR"] = tempfile.mkdtemp(prefix="taut-")
        _folders.append(environment["MPLCONFIGDIR"])


_folders: "list[str]" = []


def _draw(pictures: Any, asked: Dict[str, Any], picture: Dict[str, Any]) -> Dict[str, Any]:
    """Draws one picture; what goes wrong is one line."""
    try:
        tables = {name: pictures.table_of(text) for name, text in picture["tables"].items()}
        figure = pictures.draw(picture["name"], tables, asked["size"], picture["title"])
        path = Path(asked["folder"]) / picture["name"]
        made = {"files": pictures.save(figure, path, asked["formats"])}
        if picture.get("svg"):
            text = io.StringIO()
            with pictures.styled():
                figure.savefig(text, format="svg", metadata={"Date": None})
            made["svg"] = text.getvalue()
        sys.modules["matplotlib.pyplot"].close(figure)
        return made
    except pictures.NothingToDraw:
        return {"files": []}
    except pictures.Refused as why:
        return {"refused": str(why)}
    except OSError as error:
        return {"failed": f"{error.filename or ''}: {error.strerror or error}".lstrip(": ")}
    except Exception as error:
        return {"failed": " ".join(f"{type(error).__name__}: {error}".split())}


def main() -> int:
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    asked = json.load(sys.stdin)
    _keep_caches_out(os.environ)
    os.environ["MPLBACKEND"] = "Agg"
    try:
        with contextlib.redirect_stdout(sys.stderr):
            # The package by its folder's name, which is all that Python shall find beside this file.
            sys.path[0] = str(Path(__file__).parent.parent)
            pictures = importlib.import_module(Path(__file__).parent.name)
            pictures.styled()
            print(json.dumps([_draw(pictures, asked, picture) for picture in asked["pictures"]]), file=sys.__stdout__)
    except ImportError as error:
        print(error, file=sys.stderr)
        return NO_MATPLOTLIB
    finally:
        for folder in _folders:
            shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
