"""Draws logs and the results of studies with matplotlib."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np


def _pyplot() -> Any:
    try:
        from matplotlib import pyplot
    except ImportError:
        raise ImportError("pictures need matplotlib: pip install matplotlib") from None
    return pyplot


def expect_matplotlib(draw: bool) -> None:
    """Raises ImportError before anything is run whose picture could not be drawn."""
    if draw:
        _pyplot()


def _figure(columns: int) -> Any:
    pyplot = _pyplot()
    import matplotlib

    figure, axes = pyplot.subplots(1, columns, figsize=(5.5 * columns, 4.2), layout="constrained")
    if "inline" in matplotlib.get_backend():  # a notebook draws open figures when a cell ends, besides the one a cell returns
        pyplot.close(figure)
    return figure, axes


def _curves(axis: Any, table: Any, by: str, x: str, y: str) -> None:
    """Draws a line for each name in the column `by`, without failed runs."""
    names, across, up = np.array(table[by]), abs(np.array(table[x], float)), np.array(table[y], float)
    for name in dict.fromkeys(names):
        of = (names == name) & np.isfinite(across) & np.isfinite(up) & (up != 0)
        if of.any():
            axis.plot(across[of], up[of], "o-", label=name, markersize=4)
    axis.set(xscale="log", yscale="log")
    axis.legend(fontsize=7)


def log(columns: Dict[str, Any], name: str) -> Any:
    """Draws the columns of a simulation's log over the time, and returns the figure."""
    panels = [("energy [kJ/mol]", {"total": "total_kj_mol", "potential": "potential_kj_mol"}),
              ("temperature [K]", {"temperature": "temperature_k"}),
              ("relative bond error", {"largest": "max_rel_bond_error", "rms": "rms_rel_bond_error"})]
    if np.isfinite(np.asarray(columns["pressure_bar"], float)).any():
        panels.append(("pressure [bar]", {"pressure": "pressure_bar"}))
    figure, axes = _figure(len(panels))
    for axis, (label, curves) in zip(axes, panels):
        for title, column in curves.items():
            axis.plot(columns["time_ps"], columns[column], label=title, linewidth=1)
        if label == "relative bond error" and (np.asarray(columns["max_rel_bond_error"]) > 0).any():
            axis.set_yscale("log")
        axis.set(xlabel="time [ps]", ylabel=label)
        if len(curves) > 1:
            axis.legend(fontsize=7)
    figure.suptitle(name)
    return figure


def chart(tables: Dict[str, Any]) -> Any:
    """Draws the tables of taut.chart, a panel each, and returns the figure."""
    panels = {"work": ("curve", "rms_rel_bond_error", "ns_per_bond_step"),
              "drift": ("curve", "drift_kj_mol_ns_dof", "ns_per_bond_step"),
              "order": ("method", "dt_fs", "rms_distance_nm"),
              "length": ("method", "bonds", "ns_per_bond_step")}
    words = {"rms_rel_bond_error": "bond error, rms relative",
             "ns_per_bond_step": "constraint time [ns a bond and step]",
             "drift_kj_mol_ns_dof": "energy drift, absolute [kJ/mol/ns/dof]", "dt_fs": "step [fs]",
             "rms_distance_nm": "distance from the exact run [nm]", "bonds": "bonds of a chain"}
    there = [panel for panel in panels if panel in tables]
    figure, axes = _figure(len(there))
    for axis, panel in zip(np.atleast_1d(axes), there):
        by, x, y = panels[panel]
        _curves(axis, tables[panel], by, x, y)
        axis.set(xlabel=words[x], ylabel=words[y])
    return figure


def stability(tables: Dict[str, Any]) -> Any:
    """Draws the largest stable steps, and the plane of gains if there is one, and returns the figure."""
    figure, axes = _figure(2 if "plane" in tables else 1)
    axes = np.atleast_1d(axes)
    steps = tables["steps"]
    axes[0].barh(list(steps["method"]), np.array(steps["largest_stable_fs"], float))
    axes[0].set(xlabel="largest stable step [fs]")
    if "plane" in tables:
        plane, limits = tables["plane"], tables["limits"]
        of = np.array(plane["damping"]) == "discrete"
        ah, bh = np.array(plane["alpha_h"], float)[of], np.array(plane["beta_h"], float)[of]
        survived = np.array(plane["steps_survived"], float)[of]
        points = axes[1].scatter(ah, bh, c=survived, s=60)
        figure.colorbar(points, label="steps survived")
        edge = np.array(limits["damping"]) == "discrete"
        axes[1].plot(np.array(limits["alpha_h"], float)[edge], np.array(limits["limit_beta_h"], float)[edge], "k--")
        axes[1].set(xscale="log", xlabel="αh", ylabel="βh", title="Baumgarte, discrete damping")
    return figure


def calibration(found: Dict[str, Any]) -> Any:
    """Draws how the error of a bond falls from step to step, and returns the figure."""
    figure, axis = _figure(1)
    courses = found["courses"]
    for name in ("reference", "baumgarte"):
        axis.semilogy(courses["step"], courses[name], "o-", label=name, markersize=4)
    axis.set(xlabel="step", ylabel="bond error after each step, rms σ/d²")
    axis.legend()
    return figure


def crosscheck(found: Dict[str, Any]) -> Any:
    """Draws the distance between taut's and OpenMM's runs over time, and returns the figure."""
    figure, axis = _figure(1)
    _curves(axis, found["samples"], "run", "t_ps", "apart_nm")
    axis.set(xlabel="time [ps]", ylabel="distance from OpenMM's run [nm]")
    return figure
