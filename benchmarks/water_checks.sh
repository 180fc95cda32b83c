#!/usr/bin/env bash
# Does a liquid of rigid waters keep its temperature and its energy? (216 TIP3P, Lennard-Jones switched from 0.75 nm)
#     benchmarks/water_checks.sh langevin 60  > benchmarks/results/water_langevin.csv
#     benchmarks/water_checks.sh drift    100 > benchmarks/results/water_drift.csv
# langevin: at 298.15 K, 5/ps. drift: without thermostat, newton at 1 fs, then methods and tolerances at 2 fs (Hess
# found 0.0 % in double precision with converged constraints, −2.2 % for SHAKE at 1e-4 in single). One at a time.
set -euo pipefail
what=${1:?langevin or drift} picoseconds=${2:-100}
check=$(dirname "$0")/../build/water_checks
"$check" header
case $what in
  langevin)
    for dt in 2 1 0.5; do
      for method in newton rattle baumgarte; do
        "$check" water "$picoseconds" $dt $method forcefield.switch_nm=0.75 run.thermostat=langevin run.friction_per_ps=5
      done
    done ;;
  drift)
    "$check" water "$picoseconds" 1 newton forcefield.switch_nm=0.75
    for method in "newton" "settle" "feedforward" "baumgarte" "lincs" "lincs method.order=8 method.iterations=2" \
                  "shake method.tolerance=1e-4" "rattle method.tolerance=1e-4" "rattle method.tolerance=1e-6"; do
      # shellcheck disable=SC2086
      "$check" water "$picoseconds" 2 $method forcefield.switch_nm=0.75 || echo "water,$method,2,failed"
    done
    # a conductor's reaction field, whose force ends at zero at the cutoff: what is left is the step's
    "$check" water "$picoseconds" 1 newton forcefield.switch_nm=0.75 forcefield.rf_dielectric=1e9
    for method in newton settle feedforward baumgarte; do
      "$check" water "$picoseconds" 2 $method forcefield.switch_nm=0.75 forcefield.rf_dielectric=1e9
    done ;;
esac
