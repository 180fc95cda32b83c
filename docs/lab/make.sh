#!/usr/bin/env bash
# Builds the laboratory, build/lab/index.html, with emscripten (Debian: emscripten); options are cmake's. It opens from
# its folder, without a server. docs/make.sh puts it on the site.
set -euo pipefail
cd "$(dirname "$0")/../.."

command -v em++ >/dev/null || { echo "docs/lab/make.sh: em++ is missing; apt install emscripten" >&2; exit 3; }
emcmake cmake -S docs/lab -B build/lab-engine -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" >/dev/null
cmake --build build/lab-engine
mkdir -p build/lab
cp docs/lab/*.{html,css,js} build/lab-engine/taut_lab.js build/lab
# A page that opens from its folder can read scripts alone, so that the module comes in one: compressed, in letters.
python3 - build/lab-engine/taut_lab.wasm >build/lab/taut_module.js <<'PYTHON'
import base64, gzip, pathlib, sys
packed = base64.b64encode(gzip.compress(pathlib.Path(sys.argv[1]).read_bytes(), 9, mtime=0)).decode()
print(f'const TAUT_MODULE = "{packed}";\nif (typeof module !== "undefined") module.exports = TAUT_MODULE;')
PYTHON
python3 - systems/{pendulum,double_pendulum,water_cluster,water_cluster.start}.toml \
  systems/worlds/{planted_foot,fold}.toml docs/lab/scenes/*.toml >build/lab/scenes.js <<'PYTHON'
import json, pathlib, sys
files = {path.name: path.read_text() for path in map(pathlib.Path, sys.argv[1:])}
print("const LAB_FILES = " + json.dumps(files) + ";\nif (typeof module !== 'undefined') module.exports = LAB_FILES;")
PYTHON
echo "docs/lab/make.sh: build/lab/index.html"
