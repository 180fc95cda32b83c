#!/usr/bin/env python3
"""Runs a program of Google Benchmark five times over, rows interleaved, and writes medians with the machine above them.

    benchmarks/medians.py BUILD PROGRAM COLUMNS COUNTERS [arguments of the benchmark]

COLUMNS names the parts of a row's name, and COUNTERS the counters to keep, with commas. The table goes to
benchmarks/results/PROGRAM.csv, "_bench" left out.
"""
import collections
import json
import pathlib
import re
import statistics
import subprocess
import sys



def measure(build, program, columns, counters, arguments):
    """Yields a row for each benchmark: the first `columns` parts of its name, and medians of its counters."""
    report = json.loads(subprocess.run(
        [f"{build}/{program}", "--benchmark_repetitions=5", "--benchmark_enable_random_interleaving=true",
         "--benchmark_min_time=0.05", "--benchmark_format=json", *arguments],
        check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout)
    rows = collections.defaultdict(list)
    for run in report["benchmarks"]:
        if run["run_type"] == "iteration" and counters[0] in run:
            rows[tuple(run["run_name"].split("/")[:columns])].append(run)
    for name, runs in rows.items():
        yield name, [statistics.median(run[counter] for run in runs) for counter in counters]


def main():
    build, program, columns, counters, *arguments = sys.argv[1:]
    columns, counters = columns.split(","), counters.split(",")
    cache = pathlib.Path(build, "CMakeCache.txt").read_text()
    value = lambda key: re.search(rf"^{key}:\w+=(.*)$", cache, re.M).group(1)
    compiler = subprocess.run([value("CMAKE_CXX_COMPILER"), "--version"], capture_output=True, text=True).stdout
    machine = pathlib.Path("/proc/cpuinfo").read_text()
    cpu = re.search(r"^model name\s*: (.*)$", machine, re.M)
    lines = [f"# compiler: {compiler.splitlines()[0]}",
             f"# flags: {value('CMAKE_CXX_FLAGS')} {value('CMAKE_CXX_FLAGS_' + value('CMAKE_BUILD_TYPE').upper())}",
             f"# cpu: {cpu.group(1) if cpu else '?'}, {'AVX-512' if 'avx512f' in machine else 'AVX2 or less'}",
             ",".join(columns + counters)]
    for name, values in measure(build, program, len(columns), counters, arguments):
        lines.append(",".join([*name, *(f"{one:.4g}" for one in values)]))
    table = pathlib.Path("benchmarks") / "results" / f"{program.removesuffix('_bench')}.csv"
    table.write_text("\n".join(lines) + "\n")
    print(f"{table} written")


if __name__ == "__main__":
    main()
