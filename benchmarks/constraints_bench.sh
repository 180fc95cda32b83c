#!/usr/bin/env bash
# Runs constraints_bench five times over, rows interleaved, and writes benchmarks/results/constraints.csv:
# medians, with the machine in the first lines. Arguments go to the benchmark (--benchmark_filter=...).
#   benchmarks/constraints_bench.sh [build folder, default build] [arguments]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build}
shift || true
raw=$(mktemp)
trap 'rm -f "$raw"' EXIT
"$build/constraints_bench" --benchmark_repetitions=5 --benchmark_enable_random_interleaving=true \
  --benchmark_min_time=0.05 --benchmark_format=json "$@" >"$raw" 2>/dev/null
mkdir -p benchmarks/results
python3 - "$raw" "$build" >benchmarks/results/constraints.csv <<'PYTHON'
import collections, json, re, statistics, subprocess, sys

raw, build = sys.argv[1:]
cache = open(f"{build}/CMakeCache.txt").read()
value = lambda key: re.search(rf"^{key}:\w+=(.*)$", cache, re.M).group(1)
compiler = subprocess.run([value("CMAKE_CXX_COMPILER"), "--version"], capture_output=True, text=True).stdout
cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
simd = "AVX-512" if "avx512f" in open("/proc/cpuinfo").read() else "AVX2 or less"
kind = value("CMAKE_BUILD_TYPE").upper()
print("# compiler:", compiler.splitlines()[0])
print("# flags:", value("CMAKE_CXX_FLAGS"), value(f"CMAKE_CXX_FLAGS_{kind}"))
print(f"# cpu: {cpu}, {simd}")
print("method,system,form,threads,ns_per_unit,residual,iterations")
rows = collections.defaultdict(list)
for run in json.load(open(raw))["benchmarks"]:
    if run["run_type"] == "iteration" and "ns_per_unit" in run:
        rows[run["run_name"].removesuffix("/manual_time")].append(run)
for name, runs in rows.items():
    median = lambda key: statistics.median(run[key] for run in runs)
    print(name.replace("/", ",") + f",{median('ns_per_unit'):.3g},{median('residual'):.2g},{median('iterations'):.3g}")
PYTHON
echo "benchmarks/results/constraints.csv written"
