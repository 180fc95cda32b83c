#!/usr/bin/env bash
# The whole study: all rows that data/ does not have yet, the times of a step, the tables of README.md and the pictures.
# It takes a night on two cores. A study that was stopped or killed is resumed by the same command.
#     docs/study/make.sh [arguments of study.py]
#     docs/study/make.sh --short     # a few runs with another seed, compared with the data: two minutes
# PYTHON names a Python with OpenMM, ParmEd and h5py (pip install openmm parmed h5py), GMX GROMACS's gmx.
set -euo pipefail
cd "$(dirname "$0")"
python=${PYTHON:-python3}
if [[ ${1:-} == --short ]]; then shift; exec "$python" study.py --short "$@"; fi
"$python" study.py "$@"
"$python" transport.py
"$python" torsions.py
"$python" outsiders.py
"$python" times.py
"$python" judge.py
