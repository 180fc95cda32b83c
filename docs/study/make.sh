#!/usr/bin/env bash
# The whole study: all runs that data/runs.csv does not have yet, the time of a step, the tables of README.md and the
# pictures. It takes a night on two cores. A study that was stopped is resumed by the same command.
#     docs/study/make.sh [arguments of study.py]
#     docs/study/make.sh --short     # a few runs of a tenth of the length, compared with the data: a minute
set -euo pipefail
cd "$(dirname "$0")"
if [[ ${1:-} == --short ]]; then exec ./study.py --short; fi
./study.py "$@"
./study.py --time
./judge.py
