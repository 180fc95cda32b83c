#!/usr/bin/env bash
# What `taut calibrate` predicts and measures on every scene with bonds, at 0.5, 1, 2 and 4 fs, of RATTLE with two
# sweeps (SWEEPS: others): benchmarks/calibrate.sh [SCENE ...] > calibrate.csv
# Reductions of an error a step, predicted and measured: of a stretch's σ and its σ̇, of a rate's σ. Where they are more
# than a twentieth apart, why. TAUT names the command, if it is not build/taut.
set -euo pipefail
cd "$(dirname "$0")/.."
export OMP_NUM_THREADS=1
scenes=("$@")
((${#scenes[@]})) || scenes=(water spce decane chain ring melt freely_jointed trimer double_pendulum diatomic pendulum water_cluster)
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
echo "scene,dt_fs,sweeps,copies,damping,stretch,measured,its_rate,measured,rate,measured,floor,measured,why_apart"
for scene in "${scenes[@]}"; do
  for dt in 0.5 1 2 4; do
    for sweeps in ${SWEEPS:-2}; do
      for how in "mean centred" "slowest discrete"; do
        read -r copies damping <<<"$how"
        if ! "${TAUT:-build/taut}" calibrate "$scene" --dt-fs "$dt" --sweeps "$sweeps" --copies "$copies" \
          --damping "$damping" --json "$folder/c.json" --overwrite >"$folder/said" 2>&1; then
          echo "$scene,$dt,$sweeps,$copies,$damping,,,,,,,,,\"$(head -1 "$folder/said")\""
          continue
        fi
        python3 - "$folder/c.json" <<'END'
import json, sys
c = json.load(open(sys.argv[1]))
keys = ["reduction_predicted", "reduction_measured", "reduction_predicted_rate", "reduction_measured_rate",
        "reduction_predicted_after_rate", "reduction_measured_after_rate", "floor_predicted", "floor_measured"]
row = [c["scene"], f"{c['dt_fs']:g}", c["sweeps"], c["copies"], c["method"]["damping"]]
print(",".join(map(str, row + [f"{c[k]:.4g}" for k in keys] + ['"' + c["disagreement"] + '"'])))
END
      done
    done
  done
done
