#!/usr/bin/env python3
"""Draws courses.svg: how an error dies under Baumgarte's gains and RATTLE's sweeps, and what holds a bond at all.

    PYTHONPATH=build/python constraints/courses.py

Left: each bond of 216 waters is stretched at random along itself, by 1e-4, in a copy of a run that has settled; the rms
difference of σ/d² to the run itself. Right: rms bond errors of the Kremer–Grest melt at 5 fs.
"""
import pathlib

import matplotlib.pyplot as plt
import numpy as np
import taut

STRETCH = 1e-4
BARE = taut.Baumgarte(gains="numbers", alpha_per_ps=0, beta_per_ps=0)
DECAYS = {  # label, method, colour, and where the label stands
    "αh 0.1, (βh)² 2": (taut.Baumgarte(gains="numbers", alpha_per_ps=50, beta_per_ps=1000 / 2**0.5), "#e08a8a", (14, 4e-5)),
    "αh 0.3, (βh)² 2.5: the default": (taut.Baumgarte(), "#d62728", (12, 9e-6)),
    "RATTLE, one sweep": (taut.Rattle(sweeps=1), "#000000", (16.3, 1.1e-6)),
    "roots 0.6, 0": (taut.Baumgarte(gains="rattle", reduction=0.6), "#1f77b4", (19.3, 1.6e-8)),
    "a pair of modulus 0.6": (taut.Baumgarte(gains="swept", reduction=0.6), "#2ca02c", (7.4, 1.5e-8)),
    "dead-beat": (taut.Baumgarte(gains="dead-beat"), "#9467bd", (2.3, 2.6e-8)),
}
HOLDERS = {
    "springs (penalty)": ("penalty", "#8c564b", 1.5),
    "acceleration constraint alone": (BARE, "#7f7f7f", 1.5),
    "law for r·a + |v|²": (taut.Baumgarte(damping="implicit"), "#e377c2", 1.5),
    "law of differences": ("baumgarte", "#d62728", 4),
    "RATTLE to 1e-10": ("rattle", "#000000", 0.1),
}


def with_positions(checkpoint, before, after):
    """A checkpoint with other positions: they lie in it as in memory, and it has a sum (FNV-1a) of its body."""
    begin, end = checkpoint.index(b"dbodyZ") + 10, checkpoint.rindex(b"hchecksum")
    body, checksum = checkpoint[begin:end].replace(before.tobytes(), after.tobytes()), 0xCBF29CE484222325
    for byte in body:
        checksum = (checksum ^ byte) * 0x100000001B3 % 2**64
    return checkpoint[:begin] + body + b"hchecksum\x1b" + checksum.to_bytes(8, "big") + checkpoint[end + 18:]


def decay(method, steps=24):
    run = taut.Simulation("water", method=method, dt_fs=2)
    run.run(50)
    x, (i, j), weight = np.array(run.positions), run.bonds.T, 1 / run.masses[:, None]
    pull = STRETCH * np.random.default_rng(1).normal(size=(len(i), 1)) * (x[j] - x[i]) / (weight[i] + weight[j])
    moved = x.copy()
    np.add.at(moved, i, -pull * weight[i])
    np.add.at(moved, j, pull * weight[j])
    other = taut.Simulation.resume(with_positions(run.checkpoint(), x, moved))
    course = []
    for _ in range(steps):
        sigma, sigma_there = (((r.positions[j] - r.positions[i]) ** 2).sum(1) / 2 for r in (run, other))
        course.append(np.sqrt(np.mean(((sigma_there - sigma) / ((x[j] - x[i]) ** 2).sum(1)) ** 2)))
        run.step()
        other.step()
    return course


def hold(method):
    run = taut.Simulation("melt", method=method, dt_fs=5)
    run.run(4000, every=40)
    return run.log["time_ps"], run.log["rms_rel_bond_error"]


def main():
    plt.rcParams.update({"font.size": 8, "svg.fonttype": "none", "axes.spines.top": False, "axes.spines.right": False})
    figure, (left, right) = plt.subplots(1, 2, figsize=(7.6, 3.2), layout="constrained")
    for label, (method, colour, place) in DECAYS.items():
        left.semilogy(decay(method), color=colour, lw=1.2, ls="--" if "RATTLE" in label else "-")
        left.text(*place, label, color=colour)
    left.set(xlabel="steps of 2 fs", ylabel="injected error of σ/d², rms", xlim=(0, 24), ylim=(1e-8, 2e-4))
    for label, (method, colour, up) in HOLDERS.items():
        t, error = hold(method)
        right.semilogy(t, error, color=colour, lw=1.2)
        right.text(20, error[-1] * up, label, color=colour, ha="right")
    right.set(xlabel="time [ps]", ylabel="relative bond error, rms", xlim=(0, 20), ylim=(1e-12, 1))
    figure.savefig(pathlib.Path(__file__).with_name("courses.svg"))


if __name__ == "__main__":
    main()
