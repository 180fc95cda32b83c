#!/bin/sh
# Makes fix taut a package of a LAMMPS source tree, by links to this one: add_to_lammps.sh FOLDER. Then, in FOLDER:
#     cmake -S cmake -B build -D PKG_TAUT=on -D TAUT_ENGINE=.../taut/build
set -eu
here=$(cd "$(dirname "$0")" && pwd)
lists=${1:?the folder of the LAMMPS source}/cmake/CMakeLists.txt
for line in '^set(STANDARD_PACKAGES$' '^foreach(PKG_WITH_INCL CORESHELL '; do
  grep -q "$line" "$lists" || { echo "$lists has no line like $line: add TAUT by hand" >&2; exit 2; }
done
mkdir -p "$1/src/TAUT"
for file in "$here"/../*.cpp "$here"/fix_taut.h; do
  case $file in */main.cpp | */plugin.cpp) ;; *) ln -sf "$file" "$1/src/TAUT/" ;; esac
done
ln -sf "$here/TAUT.cmake" "$1/cmake/Modules/Packages/"
grep -q 'INCL TAUT ' "$lists" ||
  sed -i -e 's/^set(STANDARD_PACKAGES$/&\n  TAUT/' \
    -e 's/^foreach(PKG_WITH_INCL CORESHELL /foreach(PKG_WITH_INCL TAUT CORESHELL /' "$lists"
