#!/usr/bin/env bash
# Energy drift of methods on one scene, several seeds each:
#     benchmarks/drift.sh SCENE PICOSECONDS "DT_FS ..." "SEED ..." [taut run arguments ...] > drift.csv
# One row a run: drift in kJ/mol/ns/degree of freedom, bond errors relative. `failed` where the run did.
set -euo pipefail
scene=$1 picoseconds=$2 steps_fs=$3 seeds=$4
shift 4
taut=${TAUT:-$(dirname "$0")/../build/taut}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
methods=("newton" "feedforward" "baumgarte" "baumgarte --set method.gains=dead-beat"
         "baumgarte --set method.damping=centred" "baumgarte --set method.damping=centred --set method.gains=dead-beat"
         "baumgarte --set method.damping=implicit" "baumgarte --set method.damping=implicit --set method.gains=dead-beat")
value() { sed -n "s/^ *\"$1\": \(.*[^,]\),*$/\1/p" "$out/summary.json"; }

echo "scene,dt_fs,seed,method,drift,rms_rel_bond_error,max_rel_bond_error,temperature_k,us_per_step"
for dt in $steps_fs; do
  steps=$(awk "BEGIN { printf \"%d\", $picoseconds * 1000 / $dt }")
  for seed in $seeds; do
    for method in "${methods[@]}"; do
      name=${method// --set method./ }
      rm -rf "$out"
      # shellcheck disable=SC2086
      if "$taut" run "$scene" --method $method --steps "$steps" --dt-fs "$dt" --set run.seed="$seed" \
          --set run.log_every=10 "$@" --out "$out" >/dev/null 2>&1; then
        echo "$scene,$dt,$seed,$name,$(value energy_drift_kj_mol_ns_dof),$(value rms_rel_bond_error),$(value max_rel_bond_error),$(value temperature_k),$(value us_per_step)"
      else
        echo "$scene,$dt,$seed,$name,failed,,,,"
      fi
    done
  done
done
