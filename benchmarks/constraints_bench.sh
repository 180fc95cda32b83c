#!/usr/bin/env bash
# What a bond costs: benchmarks/results/constraints.csv.
#   benchmarks/constraints_bench.sh [build folder, default build] [arguments of the benchmark, such as --benchmark_filter=...]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build}
shift || true
benchmarks/medians.py "$build" constraints_bench method,system,form,threads ns_per_unit,residual,iterations "$@"
