"""Draws a picture for each system of the study: the drift against the step, and against what a nanosecond costs."""
import subprocess

from cases import HERE, SYSTEMS
from judge import LARGEST_DRIFT_KT, kt, mean_and_error, of, whole

COLOURS = {"penalty": "#999999", "baumgarte": "#d62728", "baumgarte dead-beat": "#ff9896",
           "baumgarte implicit": "#e377c2", "baumgarte lagged": "#c49c94", "feedforward": "#1f77b4", "shake 1e-4": "#bcbd22",
           "newton": "#000000", "lincs": "#2ca02c", "lincs strict": "#98df8a", "settle": "#9467bd",
           "settle and lincs": "#17becf"}


def cost_at(costs, system, method, step):
    """Processor seconds a nanosecond: the time of a step is taken to change linearly between the steps that were timed."""
    timed = sorted((s, cost[0] * s) for (name, m, s), cost in costs.items() if (name, m) == (system, method))
    if not timed:
        return None
    (s0, u0), (s1, u1) = timed[0], timed[-1]
    return (u0 + (u1 - u0) * (step - s0) / (s1 - s0) if s1 > s0 else u0) / step


def points_of(judge, costs, system, method):
    """(step, cost, drift, error) in kT/ns/dof; a drift below its error is drawn at its error."""
    for step, runs in sorted(judge.table[system].get(method, {}).items()):
        if whole(runs):
            drift, error = mean_and_error([v / kt(system) for v in of(runs, "drift")])
            yield step, cost_at(costs, system, method, step), max(abs(drift), error), error


def draw(judge, costs):
    (HERE / "pictures").mkdir(exist_ok=True)
    for system in judge.systems:
        blocks, lines = "", []
        for n, (method, colour) in enumerate(COLOURS.items()):
            points = list(points_of(judge, costs, system, method))
            if points:
                blocks += f"$d{n} << EOD\n" + "".join(f"{s} {c or 'NaN'} {d} {e}\n" for s, c, d, e in points) + "EOD\n"
                lines.append((n, method, colour))
        panels = [(1, "step [fs]")]
        if any(name == system for name, _, _ in costs):
            panels.append((2, "processor seconds a nanosecond, one thread"))
        plots = ""
        for column, label in panels:
            last = column == panels[-1][0]
            plots += f"set xlabel '{label}'\n" + ("set key outside right\n" if last else "unset key\n") + "plot " + ", \\\n ".join(
                f"$d{n} using {column}:3 with linespoints lw 1.5 pt 7 ps 0.5 lc rgb '{colour}' title '{method}'"
                for n, method, colour in lines) + "\n"
        wide = 380 * len(panels) + 200
        script = (f"set terminal svg size {wide},420 font 'sans,11' background 'white'\nset output '{system}.svg'\n{blocks}"
                  f"set multiplot layout 1,{len(panels)} title '{SYSTEMS[system].title}'\nset logscale xy\nset grid\n"
                  "set ylabel 'energy drift, absolute [kT/ns/degree of freedom]'\nset format y '10^{%T}'\n"
                  f"set arrow from graph 0, first {LARGEST_DRIFT_KT} to graph 1, first {LARGEST_DRIFT_KT} nohead dt 2\n"
                  f"{plots}unset multiplot\n")
        subprocess.run(["gnuplot"], input=script, text=True, check=True, cwd=HERE / "pictures")
