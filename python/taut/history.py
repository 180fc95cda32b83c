"""The log and the summary of what a simulation ran before it was resumed, copied or unpickled."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any, Dict, Optional, Tuple

import numpy as np


def texts_of(folder: str) -> Tuple[str, str]:
    """Returns the texts of log.csv and summary.json of a run's folder; "" and "null" where there is none."""
    log, summary = Path(folder) / "log.csv", Path(folder) / "summary.json"
    return log.read_text() if log.exists() else "", summary.read_text() if summary.exists() else "null"


class History:
    """Columns of the log, each of one length, and the summary as JSON ("null" if there is none)."""

    def __init__(self, log: Optional[Dict[str, Any]] = None, summary: str = "null") -> None:
        self.log, self.summary = log or {}, summary

    def to_bytes(self) -> bytes:
        """Returns both as a compressed archive of numpy's, without pickled objects."""
        if not len(self.log.get("step", ())) and self.summary == "null":
            return b""
        into = io.BytesIO()
        np.savez_compressed(into, summary=np.frombuffer(self.summary.encode(), np.uint8), **self.log)
        return into.getvalue()

    @classmethod
    def of_bytes(cls, kept: bytes) -> "History":
        if not kept:
            return cls()
        with np.load(io.BytesIO(kept), allow_pickle=False) as archive:
            columns = {name: archive[name] for name in archive.files}
        return cls(log=columns, summary=columns.pop("summary").tobytes().decode())

    @classmethod
    def of_texts(cls, log: str, summary: str, names: Dict[str, str]) -> "History":
        """Reads what `texts_of` returned. `names` has the names of columns by their titles in log.csv."""
        rows = [row for row in csv.reader(io.StringIO(log)) if row]
        if not rows:
            return cls(summary=summary)
        titles = [title.lstrip("#").strip('"') for title in rows[0]]
        rows = [row for row in rows[1:] if len(row) == len(titles)]
        place = {names[title]: n for n, title in enumerate(titles) if title in names}
        columns: Dict[str, Any] = {name: np.array([float(row[place[name]] or "nan") if name in place else np.nan
                                                   for row in rows]) for name in names.values()}
        columns["step"] = columns["step"].astype(np.int64)
        return cls(columns, summary)

    def cut(self, last_step: int) -> None:
        """Drops the rows after a step."""
        if self.log:
            kept = self.log["step"] <= last_step
            self.log = {name: column[kept] for name, column in self.log.items()}

    def before(self, later: Dict[str, Any]) -> Dict[str, Any]:
        """Returns this log followed by a later one. A row that both have is taken from the later one."""
        if not len(self.log.get("step", ())):
            return later
        own = self.log["step"] < later["step"][0] if len(later["step"]) else slice(None)
        return {name: np.concatenate([self.log[name][own], column]) for name, column in later.items()}

    def summary_or(self, later: str) -> Any:
        """Returns the later summary, or this one if there is none, as a dict; None if there is neither."""
        return json.loads(self.summary if later == "null" else later)
