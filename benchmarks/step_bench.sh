#!/usr/bin/env bash
# What a step and its parts cost: benchmarks/results/step.csv, ns an atom and step by the clock.
#   benchmarks/step_bench.sh [build folder, default build] [arguments of the benchmark, such as --benchmark_filter=...]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build}
shift || true
benchmarks/medians.py "$build" step_bench part,scene,precision,threads ns_per_atom_step \
  --benchmark_filter='^(step/|(forces|lists|bonds|bonded|kicks)/(water1728|chain|decane|melt|dipeptide)/)' "$@"
