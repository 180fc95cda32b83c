#!/usr/bin/env bash
# Baumgarte over its gains on liquids and DNA, each damping, 3000 steps a point:
#     benchmarks/planes.sh [FOLDER [NAME ...]]
# About twelve minutes on an idle core. TAUT names the command, if it is not build/taut; STEPS other steps.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-benchmarks/results/planes}
shift || true
export OMP_NUM_THREADS=1
dna="tests/data/dna-hbonds"
declare -A scenes=(
  [water_1fs]="water --dt-fs 1" [water_2fs]="water --dt-fs 2"
  [decane_2fs]="decane --dt-fs 2" [decane_4fs]="decane --dt-fs 4"
  [dna_2fs]="--openmm $dna.system.xml $dna.state.xml --dt-fs 2 --set run.velocities=draw run.temperature_k=300")
names=("$@")
[ ${#names[@]} -gt 0 ] || names=("${!scenes[@]}")
for name in "${names[@]}"; do
  # shellcheck disable=SC2086
  "${TAUT:-build/taut}" stability ${scenes[$name]} --steps "${STEPS:-3000}" --methods baumgarte \
    --out "$out/$name" --overwrite
done
