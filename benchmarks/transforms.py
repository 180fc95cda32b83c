#!/usr/bin/env python3
"""Times the Fourier transforms of a step with PME beside those of libraries: FFTW's, ducc0's and scipy's pocketfft.

    benchmarks/transforms.py [--build build] [--repeats 200]

Of 1728 and 5832 waters in mixed precision, on one thread: the step and the transforms in it as taut has them, from
step_bench; and transforms of the same grid, real to complex and back in single precision, by each library (apt install
libfftw3-single3, pip install ducc0 scipy), the least of the repeats. FFTW plans by its estimate, or by the times that it
measures (its plans then differ from run to run, and so do the last bits of what they give). The last column is the
difference to taut's, in parts of the step.
"""

import ctypes, json, subprocess, time

import ducc0
import numpy as np
import scipy.fft

import machine

GRIDS = {1728: 32, 5832: 48}  # waters: points along each edge
FFTW_PLANS = {"FFTW, estimated": 1 << 6, "FFTW, timed": 1 << 5}  # FFTW_ESTIMATE, FFTW_PATIENT


def by_taut(build, part, waters):
    """Returns the µs that step_bench measures for this part of a step."""
    out = subprocess.run([build / "step_bench", f"--benchmark_filter=^{part}/pme{waters}/mixed/1/", "--benchmark_min_time=0.2",
                          "--benchmark_repetitions=3", "--benchmark_format=json"],
                         check=True, capture_output=True, text=True).stdout
    runs = [run for run in json.loads(out)["benchmarks"] if run["run_type"] == "iteration"]
    return min(1e-3 * run["ns_per_atom_step"] for run in runs) * 3 * waters


def aligned(shape, kind):
    """Returns an array at a multiple of a cache line, which FFTW's SIMD asks for."""
    count = int(np.prod(shape)) * np.dtype(kind).itemsize
    room = np.zeros(count + 64, np.uint8)
    start = -room.ctypes.data % 64
    return room[start:start + count].view(kind).reshape(shape)


def by_fftw(flags, grid, waves, back):
    """Plans transforms from grid to waves and from waves to back; returns a function that does both."""
    fftw = ctypes.CDLL("libfftw3f.so.3")
    pointer = lambda array: array.ctypes.data_as(ctypes.c_void_p)
    plan = {}
    for name, from_, to in (("r2c", grid, waves), ("c2r", waves, back)):
        make = getattr(fftw, f"fftwf_plan_dft_{name}_3d")
        make.restype = ctypes.c_void_p
        plan[name] = make(*grid.shape, pointer(from_), pointer(to), flags)
    fftw.fftwf_execute.argtypes = [ctypes.c_void_p]
    return lambda: (fftw.fftwf_execute(plan["r2c"]), fftw.fftwf_execute(plan["c2r"]))


def ways(points, rng):
    """Returns each library's transform there and back, and checks that they have the same waves and come back."""
    grid, back = aligned((points,) * 3, np.float32), aligned((points,) * 3, np.float32)
    waves = aligned((points, points, points // 2 + 1), np.complex64)
    found = {name: by_fftw(flags, grid, waves, back) for name, flags in FFTW_PLANS.items()}  # it writes on them to plan
    grid[:] = rng.normal(size=grid.shape)

    def ducc0_there_and_back():
        ducc0.fft.r2c(grid, axes=(0, 1, 2), out=waves, nthreads=1)
        ducc0.fft.c2r(waves, axes=(0, 1, 2), lastsize=points, forward=False, out=back, nthreads=1)

    def pocketfft_there_and_back():
        back[:] = scipy.fft.irfftn(scipy.fft.rfftn(grid, workers=1), s=grid.shape, workers=1) * points**3

    found |= {"ducc0": ducc0_there_and_back, "pocketfft": pocketfft_there_and_back}
    for name, transform in found.items():
        back[:] = 0
        transform()
        assert np.allclose(back, grid * points**3, atol=1e-4 * points**3), f"{name} does not come back to its grid"
    return found


def main():
    parser = machine.argument_parser(__doc__)
    parser.add_argument("--repeats", type=int, default=200)
    options = parser.parse_args()
    rng = np.random.default_rng(1)
    print(f"# {machine.describe()}; FFTW's libfftw3f, ducc0 {ducc0.__version__}, scipy {scipy.__version__}; µs")
    print(f"{'waters':>7} {'points':>7} {'step':>8}  {'transform':15} {'there, back':>12} {'of the step':>12}")
    for waters, points in GRIDS.items():
        step, ours = (by_taut(options.build, part, waters) for part in ("step", "transforms"))
        least = {"taut": ours}
        for name, transform in ways(points, rng).items():
            least[name] = float("inf")
            for _ in range(options.repeats):
                start = time.perf_counter()
                transform()
                least[name] = min(least[name], 1e6 * (time.perf_counter() - start))
        for name, us in least.items():
            print(f"{waters:7} {points:6}³ {step:8.0f}  {name:15} {us:12.0f} {100 * (us - ours) / step:+11.1f} %")


if __name__ == "__main__":
    main()
