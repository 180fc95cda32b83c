#!/usr/bin/env python3
"""Measures how much longer a step with PME would take with a transform that is not under the GPL in place of FFTW.

    benchmarks/free_transform.py [--build build] [--repeats 200]

Of 1728 and 5832 waters in mixed precision, on one thread: the step and the transforms in it as taut has them, by FFTW,
from step_bench; and transforms of the same grid, real to complex and back in single precision, by ducc0 and by scipy's
pocketfft (pip install ducc0 scipy), the least of the repeats. The last column is the difference to FFTW, in parts of
the step.
"""

import argparse, json, pathlib, subprocess, time

import ducc0
import numpy as np
import scipy.fft

import machine

GRIDS = {1728: 32, 5832: 48}  # waters: points along each edge


def by_taut(build, part, waters):
    """Returns the µs that step_bench measures for this part of a step."""
    out = subprocess.run([build / "step_bench", f"--benchmark_filter=^{part}/pme{waters}/mixed/1/", "--benchmark_min_time=0.2",
                          "--benchmark_repetitions=3", "--benchmark_format=json"],
                         check=True, capture_output=True, text=True).stdout
    runs = [run for run in json.loads(out)["benchmarks"] if run["run_type"] == "iteration"]
    return min(1e-3 * run["ns_per_atom_step"] for run in runs) * 3 * waters


def ways(points, rng):
    """Returns each library's transform there and back, and checks that they have the same waves and come back."""
    grid = rng.normal(size=(points,) * 3).astype(np.float32)
    waves, back = np.empty((points, points, points // 2 + 1), np.complex64), np.empty_like(grid)

    def ducc0_there_and_back():
        ducc0.fft.r2c(grid, axes=(0, 1, 2), out=waves, nthreads=1)
        ducc0.fft.c2r(waves, axes=(0, 1, 2), lastsize=points, forward=False, out=back, nthreads=1)

    def pocketfft_there_and_back():
        scipy.fft.irfftn(scipy.fft.rfftn(grid, workers=1), s=grid.shape, workers=1)

    ducc0_there_and_back()
    assert np.allclose(back, grid * points**3, atol=1e-4 * points**3), "ducc0 does not come back to its grid"
    assert np.allclose(waves, scipy.fft.rfftn(grid), atol=1e-4 * np.abs(waves).max()), "ducc0 has other waves"
    return {"ducc0": ducc0_there_and_back, "pocketfft": pocketfft_there_and_back}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=pathlib.Path(__file__).parent.parent / "build")
    parser.add_argument("--repeats", type=int, default=200)
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    print(f"# {machine.describe()}; ducc0 {ducc0.__version__}, scipy {scipy.__version__}; µs")
    print(f"{'waters':>7} {'points':>7} {'step':>8}  {'transform':10} {'there, back':>12} {'of the step':>12}")
    for waters, points in GRIDS.items():
        step, ours = (by_taut(options.build, part, waters) for part in ("step", "transforms"))
        least = {"FFTW": ours}
        for name, transform in ways(points, rng).items():
            least[name] = float("inf")
            for _ in range(options.repeats):
                start = time.perf_counter()
                transform()
                least[name] = min(least[name], 1e6 * (time.perf_counter() - start))
        for name, us in least.items():
            print(f"{waters:7} {points:6}³ {step:8.0f}  {name:10} {us:12.0f} {100 * (us - ours) / step:+11.1f} %")


if __name__ == "__main__":
    main()
