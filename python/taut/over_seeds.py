"""Means and errors of a study's tables over seeds."""

from __future__ import annotations

from typing import Any, Dict, Iterable, List, Mapping, Optional, Union

import numpy as np

from . import inputs
from .errors import InputError

Columns = Dict[str, Any]
Seeds = Union[int, Iterable[int], None]


def settings_of_seeds(seeds: Seeds, given: Optional[Mapping[str, Any]]) -> List[Dict[str, Any]]:
    """Returns the scene's settings for every seed. A number of seeds counts on from that of `given`, or from 1."""
    said = dict(given or {})
    if seeds is None:
        return [said]
    if isinstance(seeds, (int, float)):
        count, first = inputs.whole(seeds, "seeds"), inputs.whole(said.get("run.seed", 1), "run.seed")
        if count < 1:
            raise InputError(f"seeds: {count}, expected 1 or more")
        return [{**said, "run.seed": first + n} for n in range(count)]
    listed = [inputs.whole(seed, "seeds") for seed in seeds]
    if "run.seed" in said:
        raise InputError("run.seed: seeds lists them already; leave one out")
    if not listed or len(set(listed)) < len(listed):
        raise InputError(f"seeds: {listed}, expected one or more, each once")
    return [{**said, "run.seed": seed} for seed in listed]


def _texts(column: Any) -> Any:
    """Returns a column as texts. A column of empty cells was read as numbers."""
    if column.dtype.kind == "U":
        return column
    return np.array(["" if np.isnan(cell) else repr(float(cell)) for cell in column], str)


def over_seeds(tables: List[Columns], seeds: List[int]) -> Columns:
    """Returns one table of those of all seeds.

    Where they have the same rows a column of numbers that differ becomes its mean, and a column NAME_error beside it
    has the mean's standard error. Texts that differ, such as failures, are listed. Where the rows differ the tables
    stand one below the other, with a column "seed".
    """
    if len(tables) == 1:
        return tables[0]
    lengths = {len(next(iter(table.values()), ())) for table in tables}
    if len(lengths) > 1:
        rows = [len(next(iter(table.values()), ())) for table in tables]
        texts = {name for name in tables[0] if any(table[name].dtype.kind == "U" for table in tables)}
        joined = {name: np.concatenate([_texts(t[name]) if name in texts else t[name] for t in tables])
                  for name in tables[0]}
        return {"seed": np.repeat(seeds, rows), **joined}
    result: Columns = {}
    for name in tables[0]:
        columns = [table[name] for table in tables]
        if any(column.dtype.kind == "U" for column in columns):
            columns = [_texts(column) for column in columns]
            result[name] = np.array(["; ".join(dict.fromkeys(cell for cell in row if cell)) for row in zip(*columns)],
                                    str)
        elif all(np.array_equal(column, columns[0], equal_nan=True) for column in columns):
            result[name] = columns[0]
        else:
            result[name], result[f"{name}_error"] = mean_and_error(columns)
    return result


def mean_and_error(values: List[Any]) -> Any:
    """Returns the mean over the seeds, nan where one of them failed, and its standard error."""
    return np.mean(values, 0), np.std(values, 0, ddof=1) / np.sqrt(len(values))
