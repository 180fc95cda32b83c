"""Writes the examples as one notebook, taut.ipynb, into the current folder."""

import ast
import json
from pathlib import Path

HERE = Path(__file__).resolve().parent
ORDER = ["first_run", "water", "own_method", "gains", "polymer", "pulled_chain", "tables", "analysis", "scan",
         "protein", "jax_potential"]


def cells_of(name: str) -> "list[dict[str, object]]":
    """Returns an example's docstring, its first words up to a colon as a heading, and its code."""
    text = (HERE / f"{name}.py").read_text()
    title, _, words = (ast.get_docstring(ast.parse(text)) or "").partition(": ")
    code = text[text.index('"""', 3) + 3:].strip()
    return [{"cell_type": "markdown", "metadata": {}, "source": f"## {title}\n{words[:1].upper()}{words[1:]}"},
            {"cell_type": "code", "metadata": {}, "source": code, "outputs": [], "execution_count": None}]


def notebook() -> str:
    title: "dict[str, object]" = {"cell_type": "markdown", "metadata": {}, "source": "# taut, by example"}
    cells = [title] + [cell for name in ORDER for cell in cells_of(name)]
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}, indent=1,
                      ensure_ascii=False) + "\n"


if __name__ == "__main__":
    Path("taut.ipynb").write_text(notebook())
