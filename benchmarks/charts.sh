#!/usr/bin/env bash
# Makes the picture of benchmarks/README.md, with all tables and pictures in FOLDER: benchmarks/charts.sh [FOLDER] [--quick]
# One thread: figures are per core. TAUT names the command, if it is not build/taut.
set -euo pipefail
cd "$(dirname "$0")/.."
out=out/charts
if (($#)) && [[ $1 != --* ]]; then out=$1; shift; fi
long=(--drift-steps 10000)
first=(--steps 4 --drift-steps 2000)
if [[ " $* " == *" --quick "* ]]; then long=() first=(); fi
export OMP_NUM_THREADS=1
"${TAUT:-build/taut}" chart freely_jointed "${first[@]}" --out "$out/chart" --overwrite "$@"
"${TAUT:-build/taut}" chart water "${long[@]}" --out "$out/water" --overwrite "$@"
"${TAUT:-build/taut}" stability freely_jointed --hard --out "$out/stability" --overwrite "$@"
if ((${#long[@]})); then cp "$out/chart/work.png" benchmarks/results/charts/chart/; fi  # which README.md shows
