"""Writes the examples as one notebook, taut.ipynb, and as one page with pictures, docs/gallery.md.

Pictures and what the examples print are those of the tests' last run that was told to keep them:
TAUT_GALLERY=docs/pictures/gallery pytest python/tests/test_examples.py && python3 python/examples/notebook.py
"""

import ast
import json
from pathlib import Path

HERE = Path(__file__).resolve().parent
DOCS = HERE.parents[1] / "docs"
ORDER = ["first_run", "water", "own_method", "gains", "polymer", "pulled_chain", "tables", "analysis", "scan",
         "protein", "jax_potential"]


def words_and_code(name: str) -> "tuple[str, str]":
    """Returns the docstring, its first words up to a colon as a heading of Markdown, and the code."""
    text = (HERE / f"{name}.py").read_text()
    title, _, words = (ast.get_docstring(ast.parse(text)) or "").partition(": ")
    return f"## {title}\n{words[:1].upper()}{words[1:]}", text[text.index('"""', 3) + 3:].strip()


def cells_of(name: str) -> "list[dict[str, object]]":
    words, code = words_and_code(name)
    return [{"cell_type": "markdown", "metadata": {}, "source": words},
            {"cell_type": "code", "metadata": {}, "source": code, "outputs": [], "execution_count": None}]


def notebook() -> str:
    title: "dict[str, object]" = {"cell_type": "markdown", "metadata": {}, "source": "# taut, by example"}
    cells = [title] + [cell for name in ORDER for cell in cells_of(name)]
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    kernel = {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}, indent=1,
                      ensure_ascii=False) + "\n"


def gallery() -> str:
    """Returns the page: for each example its words, its picture, the end of what it prints, and its code."""
    parts = ["# Gallery\nEach example runs as it stands and draws its picture; the tests run all of them.\n"
             "[taut.ipynb](../python/examples/taut.ipynb) holds them as one notebook."]
    for name in ORDER:
        words, code = words_and_code(name)
        printed = (DOCS / "pictures" / "gallery" / f"{name}.txt").read_text().splitlines()[-6:]
        parts.append(f"{words}\n\n![{name}](pictures/gallery/{name}.png)")
        if printed:
            parts.append("\n".join(["It prints, at the end:", "```text", *printed, "```"]))
        parts.append(f"```python\n{code}\n```")
    return "\n\n".join(parts) + "\n"


if __name__ == "__main__":
    (HERE / "taut.ipynb").write_text(notebook())
    (DOCS / "gallery.md").write_text(gallery())
