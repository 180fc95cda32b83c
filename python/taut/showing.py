"""What notebooks show of a simulation, its log and its summary."""

from __future__ import annotations

import html
from typing import Any, Dict, Iterable, List, Mapping

import numpy as np


def table(caption: str, rows: Mapping[str, str]) -> str:
    """Returns an HTML table of names and values."""
    cells = "".join(f"<tr><th style='text-align:left'>{html.escape(what)}</th>"
                    f"<td style='text-align:left'>{html.escape(value)}</td></tr>" for what, value in rows.items())
    return f"<table><caption>{html.escape(caption)}</caption>{cells}</table>"


def sparkline(values: Any, width: int = 120, height: int = 20) -> str:
    """Returns a small line of the values as SVG; nothing for fewer than two finite ones."""
    numbers = np.asarray(values, float)
    numbers = numbers[np.isfinite(numbers)]
    if len(numbers) < 2:
        return ""
    numbers = numbers[np.linspace(0, len(numbers) - 1, min(len(numbers), 2 * width)).astype(int)]
    spread = np.ptp(numbers) or 1.0
    x = np.linspace(1, width - 1, len(numbers))
    y = height - 2 - (height - 4) * (numbers - numbers.min()) / spread
    points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x, y))
    return (f"<svg width='{width}' height='{height}'><polyline points='{points}' fill='none' stroke='#0072B2'/></svg>")


class Log(Dict[str, Any]):
    """Columns of the log, numpy arrays of one length. A notebook shows mean, last value and course of each."""

    @property
    def pressure_tensor(self) -> Any:
        """The pressure tensor of each row as xx, yy, zz, xy, xz, yz, (rows, 6) [bar], for ``taut.measure.viscosity``;
        nan without a box."""
        return np.column_stack([self[f"pressure_{two}_bar"] for two in ("xx", "yy", "zz", "xy", "xz", "yz")])

    def _repr_html_(self) -> str:
        lines: List[str] = []
        spans = np.diff(self["time_ps"], prepend=np.nan)  # a row stands for the time since the one before it
        spans[:1] = spans[1:2] if len(spans) > 1 else 1
        for name, column in self.items():
            numbers = np.asarray(column, float)
            if name == "step" or not np.isfinite(numbers).any():
                continue
            there = np.isfinite(numbers)
            mean = np.average(numbers[there], weights=spans[there])
            lines.append(f"<tr><th style='text-align:left'>{name}</th><td>{mean:.6g}</td>"
                         f"<td>{numbers[-1]:.6g}</td><td>{sparkline(numbers)}</td></tr>")
        rows = len(self.get("step", ()))
        return (f"<table><caption>log, {rows} rows</caption><tr><th></th><th>mean</th><th>last</th><th></th></tr>"
                f"{''.join(lines)}</table>")


class Summary(Dict[str, Any]):
    """Results of a run, with the keys of summary.json. A notebook shows a table of them."""

    def _repr_html_(self) -> str:
        return table("summary", dict(_flat("", self)))


def _flat(before: str, values: Mapping[str, Any]) -> Iterable[Any]:
    for name, value in values.items():
        if isinstance(value, dict) and set(value) == {"value", "error"}:
            error = value["error"]
            yield before + name, f"{value['value']:.6g}" + (f" ± {error:.2g}" if error else "")
        elif isinstance(value, dict):
            yield from _flat(f"{before}{name}: ", value)
        elif value is not None and value != []:
            yield before + name, f"{value:.6g}" if isinstance(value, float) else str(value)


def simulation_table(simulation: Any) -> str:
    """Returns the HTML table of a simulation and of the last row of its log."""
    rows = {"scene": simulation.name, "atoms": f"{len(simulation.masses)}", "rigid bonds": f"{len(simulation.lengths)}",
            "method": f"{simulation.method}: {simulation.setting}" if simulation.setting else simulation.method,
            "step": f"{simulation.dt_fs:g} fs", "steps taken": f"{simulation.steps_taken} ({simulation.time_ps:g} ps)",
            "threads": f"{simulation.threads}"}
    if simulation.folder:
        rows["folder"] = simulation.folder
    if len(simulation.log["step"]):
        last = {name: column[-1] for name, column in simulation.log.items()}
        rows["last row of the log"] = (f"step {last['step']}: {last['total_kj_mol']:.8g} kJ/mol, "
                                       f"{last['temperature_k']:.2f} K, largest bond error "
                                       f"{last['max_rel_bond_error']:.1e}")
    return table("taut.Simulation", rows)
