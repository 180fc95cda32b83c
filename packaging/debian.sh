#!/usr/bin/env bash
# packaging/debian.sh FOLDER: the Debian package of what is committed here, built by dpkg-buildpackage, in FOLDER.
set -euo pipefail
(($# == 1)) || { echo "usage: packaging/debian.sh FOLDER" >&2; exit 2; }
mkdir -p "$1"
into=$(cd "$1" && pwd)
cd "$(dirname "$0")/.."
version=$(sed -n '1s/^taut (\(.*\)-.*/\1/p' packaging/debian/changelog)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
git archive --prefix="taut-$version/" HEAD | tee >(gzip -n >"$scratch/taut_$version.orig.tar.gz") | tar -x -C "$scratch"
cp -r packaging/debian "$scratch/taut-$version"
cd "$scratch/taut-$version"
dpkg-buildpackage -us -uc
mv ../*.deb ../*.dsc ../*.tar.* ../*.changes "$into"
