#!/usr/bin/env bash
# The pictures of systems/worlds, benchmarks/results/worlds/NAME.svg, and the figures they are drawn from: a minute.
#   benchmarks/worlds.sh [build folder, default build]
set -euo pipefail
cd "$(dirname "$0")/.."
"${1:-build}/worlds" benchmarks/results/worlds
cd benchmarks/results/worlds
for name in knee planted_foot fold double_pendulum flow; do gnuplot "../../worlds/$name.gp"; done
