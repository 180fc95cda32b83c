#!/usr/bin/env bash
# Builds the site, build/site/docs/index.html, with Sphinx and MyST from PyPI in build/docs-venv. Needs the Python
# module, which ./setup builds: its docstrings are the reference.
set -euo pipefail
cd "$(dirname "$0")/.."

[[ -e build/python/taut ]] || { echo "docs/make.sh: build/python/taut is missing; run ./setup first" >&2; exit 2; }
venv=build/docs-venv
if [[ ! -x $venv/bin/sphinx-build ]]; then
  /usr/bin/python3 -m venv --system-site-packages "$venv"
  "$venv/bin/pip" -q install sphinx myst-parser furo
fi
rm -rf build/site build/site.cache  # a cached page would hide its warnings
PYTHONPATH=build/python "$venv/bin/python" -m sphinx -q -W --keep-going -d build/site.cache -c docs . build/site
# The front page of a folder of pages.
printf '<meta http-equiv="refresh" content="0; url=docs/index.html">\n' > build/site/index.html
# The laboratory, where emscripten is.
if command -v em++ >/dev/null; then
  docs/lab/make.sh
  cp -r build/lab build/site/docs/lab/page
else
  echo "docs/make.sh: em++ is missing (emscripten): the site is without its laboratory" >&2
fi
echo "docs/make.sh: build/site/index.html"
