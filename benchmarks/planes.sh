#!/usr/bin/env bash
# Baumgarte over its gains on water and DNA at 2 and 4 fs, each damping, beside newton's drift in as many steps:
#     benchmarks/planes.sh [FOLDER [NAME ...]]
# Four αh by five βh of the part that lives; what is kept is plane.csv and plane.png. TAUT names the command, if it is
# not build/taut; STEPS other steps.
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-benchmarks/results/planes}
shift || true
export OMP_NUM_THREADS=1
dna="--openmm tests/data/dna-hbonds.system.xml.gz tests/data/dna-hbonds.state.xml.gz"
declare -A scenes=(
  [water_2fs]="water --dt-fs 2" [water_4fs]="water --dt-fs 4"
  [dna_2fs]="$dna --dt-fs 2 --set run.velocities=draw run.temperature_k=300"
  [dna_4fs]="$dna --dt-fs 4 --set run.velocities=draw run.temperature_k=300")
names=("$@")
[ ${#names[@]} -gt 0 ] || names=("${!scenes[@]}")
for name in "${names[@]}"; do
  # shellcheck disable=SC2086
  "${TAUT:-build/taut}" stability ${scenes[$name]} --steps "${STEPS:-2000}" --methods baumgarte \
    --alpha-h 0.03 0.1 0.3 1 --beta-h 1 1.2 1.4 1.6 1.8 --out "$out/$name" --overwrite
  find "$out/$name" -type f ! -name plane.csv ! -name plane.png -delete
done
