"""Writes taut.ipynb, the examples as one notebook: python3 notebook.py"""

import ast
import json
from pathlib import Path

HERE = Path(__file__).resolve().parent
ORDER = ["first_run", "water", "own_method", "gains", "polymer", "pulled_chain", "analysis", "protein", "jax_potential"]


def cells_of(name):
    text = (HERE / f"{name}.py").read_text()
    words = ast.get_docstring(ast.parse(text))
    code = text[text.index('"""', 3) + 3:].strip()
    return [{"cell_type": "markdown", "metadata": {}, "source": f"## {words}"},
            {"cell_type": "code", "metadata": {}, "source": code, "outputs": [], "execution_count": None}]


def notebook():
    title = {"cell_type": "markdown", "metadata": {}, "source": "# taut, by example"}
    cells = [title] + [cell for name in ORDER for cell in cells_of(name)]
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}, indent=1,
                      ensure_ascii=False) + "\n"


if __name__ == "__main__":
    (HERE / "taut.ipynb").write_text(notebook())
