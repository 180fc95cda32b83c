#!/usr/bin/env bash
# packaging/wheels.sh FOLDER [PYTHON...]: wheels and an sdist in FOLDER, for the interpreters named, or for those of
# 3.10 to 3.14 that are here (on the PATH, or pyenv's). Each is built and tried in a bare Debian 12, which needs root and
# debootstrap: tests/portability/wheel says how.
set -euo pipefail
cd "$(dirname "$0")/.."
(($#)) || { echo "usage: packaging/wheels.sh FOLDER [PYTHON...]" >&2; exit 2; }
folder=$1
shift
pythons=("$@")
if ((${#pythons[@]} == 0)); then
  for minor in 10 11 12 13 14; do
    found=$(ls -d ~/.pyenv/versions/3.$minor.*/bin/python3 2>/dev/null | tail -1)
    [[ $found ]] || found=$(command -v python3.$minor) || { echo "wheels.sh: no Python 3.$minor here, left out" >&2; continue; }
    pythons+=("$found")
  done
fi
exec tests/portability/wheel "$folder" "${pythons[@]}"
