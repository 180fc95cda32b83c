#!/usr/bin/env bash
# Baumgarte over its gains on liquids, each damping, 3000 steps a point: benchmarks/planes.sh [FOLDER]. About ten minutes.
# TAUT names the command, if it is not build/taut.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-benchmarks/results/planes}
export OMP_NUM_THREADS=1
for run in "water 1" "water 2" "decane 2" "decane 4"; do
  read -r scene dt <<<"$run"
  "${TAUT:-build/taut}" stability "$scene" --dt-fs "$dt" --steps 3000 --methods baumgarte --out "$out/${scene}_${dt}fs" --overwrite
done
