"""Draws a picture for each system of the study: the drift against the step, and against what a nanosecond costs."""
import subprocess

from cases import HERE, SYSTEMS
from judge import LARGEST_DRIFT_KT, cost_at, kt, mean_and_error, of, whole

COLOURS = {"penalty": "#999999", "baumgarte": "#d62728", "baumgarte dead-beat": "#ff9896",
           "baumgarte implicit": "#e377c2", "baumgarte lagged": "#c49c94", "feedforward": "#1f77b4", "shake 1e-4": "#bcbd22",
           "newton": "#000000", "lincs": "#2ca02c", "lincs strict": "#98df8a", "settle": "#9467bd",
           "settle and lincs": "#17becf"}


def points_of(judge, times, system, method):
    """(step, cost, drift [kT/ns/dof]); a drift below its error is drawn at its error."""
    for step, runs in sorted(judge.table[system].get(method, {}).items()):
        if whole(runs):
            drift, error = mean_and_error([v / kt(system) for v in of(runs, "drift")])
            cost = cost_at(times, system, method, step)
            yield step, cost and cost[0], max(abs(drift), error)


def panel(column, label, tics, lines, place):
    """One of a picture's panels, between the shares `place` of its width."""
    plots = ", \\\n ".join(f"$d{n} using {column}:3 with linespoints lw 1.5 pt 7 ps 0.5 lc rgb '{colour}' title '{method}'"
                          for n, method, colour in lines)
    return (f"set lmargin at screen {place[0]}\nset rmargin at screen {place[1]}\nset xlabel '{label}'\n"
            f"set xtics ({', '.join(f'{tic:g}' for tic in tics)})\nplot {plots}\n")


def draw(judge, times):
    (HERE / "pictures").mkdir(exist_ok=True)
    for system in judge.systems:
        blocks, lines = "", []
        for n, (method, colour) in enumerate(COLOURS.items()):
            points = list(points_of(judge, times, system, method))
            if points:
                blocks += f"$d{n} << EOD\n" + "".join(f"{s} {c or 'NaN'} {d}\n" for s, c, d in points) + "EOD\n"
                lines.append((n, method, colour))
        timed = any(name == system for name, _ in times)
        wide, right = (920, 0.42) if timed else (600, 0.66)
        steps = sorted({step for steps in judge.table[system].values() for step in steps})
        script = (f"set terminal svg size {wide},400 font 'sans,11' background 'white'\nset output '{system}.svg'\n{blocks}"
                  "set multiplot\nset tmargin at screen 0.9\nset bmargin at screen 0.15\nset logscale xy\nset grid\n"
                  "set autoscale xfix\nset offsets graph 0.03, graph 0.03, 0, 0\n"
                  f"set arrow from graph 0, first {LARGEST_DRIFT_KT} to graph 1, first {LARGEST_DRIFT_KT} nohead dt 2\n"
                  f"set title '{SYSTEMS[system].title}'\nset ylabel 'energy drift, absolute [kT/ns/degree of freedom]'\n"
                  f"set format y '10^{{%T}}'\n{'unset key' if timed else 'set key at screen 0.99, 0.88 Left reverse'}\n"
                  + panel(1, "step [fs]", steps, lines, (0.08 if timed else 0.13, right)))
        if timed:
            script += ("unset ylabel\nunset title\nset format y ''\nset key at screen 0.99, 0.88 Left reverse\n"
                       + panel(2, "processor seconds a nanosecond, one thread",
                               [digit * 10 ** power for power in range(5) for digit in (1, 2, 3, 5)], lines, (0.45, 0.76)))
        subprocess.run(["gnuplot"], input=script + "unset multiplot\n", text=True, check=True, cwd=HERE / "pictures")
