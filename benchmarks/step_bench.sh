#!/usr/bin/env bash
# Runs step_bench's own parts five times over, rows interleaved, and writes the medians to benchmarks/results/step.csv.
#   benchmarks/step_bench.sh [build folder, default build] [arguments of the benchmark, such as --benchmark_filter=...]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build}
shift || true
raw=$(mktemp)
trap 'rm -f "$raw"' EXIT
"$build/step_bench" --benchmark_filter='^(step/|(forces|lists|bonds|bonded|plain_bonded|kicks)/(water1728|chain|decane|melt)/)' --benchmark_repetitions=5 \
  --benchmark_enable_random_interleaving=true --benchmark_min_time=0.05 --benchmark_format=json "$@" >"$raw" 2>/dev/null
python3 - "$raw" >benchmarks/results/step.csv <<'PYTHON'
import collections, json, statistics, sys

cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "?")
print(f"# cpu: {cpu}; ns an atom and step by the clock, medians")
print("part,scene,precision,threads,ns_per_atom_step")
rows = collections.defaultdict(list)
for run in json.load(open(sys.argv[1]))["benchmarks"]:
    if run["run_type"] == "iteration":
        rows[tuple(run["name"].split("/")[:4])].append(run["ns_per_atom_step"])
for name, values in rows.items():
    print(",".join(name) + f",{statistics.median(values):.4g}")
PYTHON
echo "benchmarks/results/step.csv written"
