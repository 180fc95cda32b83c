#!/usr/bin/env bash
# Renews benchmarks/HISTORY.md: speeds, drifts, conformance and sizes, a row a run in results/history.csv, drawn in
# results/history.svg. Some minutes of an idle machine; needs ./setup --tests and python3-matplotlib.
#   benchmarks/page.sh           measures and writes
#   benchmarks/page.sh --draw    writes the page again from the rows that are there
set -euo pipefail
cd "$(dirname "$0")/.."
PYTHONPATH=build/python exec /usr/bin/python3 benchmarks/page.py "$@"
