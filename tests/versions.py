"""Checks that all files name one version, that of CMakeLists.txt, and that the change log names the checkpoints'.

python3 tests/versions.py
"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Where a version stands: a file, and the line that has it.
PLACES = {
    "CMakeLists.txt": r"^project\(taut VERSION ([\d.]+)",
    "pyproject.toml": r'^version = "([\d.]+)"',
    "CITATION.cff": r'^version: "([\d.]+)"',
    "CHANGELOG.md": r"^## ([\d.]+)",  # the first is the newest
    "codemeta.json": r'"version": "([\d.]+)"',
    ".zenodo.json": r'"version": "([\d.]+)"',
    "packaging/conda/recipe.yaml": r'^  version: "([\d.]+)"',
    "packaging/spack/package.py": r'^    version\("([\d.]+)"',
    "packaging/debian/changelog": r"^taut \(([\d.]+)-",
    "packaging/Containerfile": r'^LABEL .*version="([\d.]+)"',
    "docs/install.md": r"find_package\(taut ([\d.]+)",
}


def find(file, pattern):
    match = re.search(pattern, (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE)
    return match.group(1) if match else "none"


def main():
    versions = {file: find(file, pattern) for file, pattern in PLACES.items()}
    wanted = versions["CMakeLists.txt"]
    wrong = [f"{file}: {version}, CMakeLists.txt has {wanted}" for file, version in versions.items() if version != wanted]
    checkpoint = find("simulation/checkpoint.cpp", r"kVersion = (\d+)")
    newest = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").split("\n## ")[1]
    if f"version {checkpoint}" not in newest:
        wrong.append(f"CHANGELOG.md: {wanted} does not say that checkpoints are of version {checkpoint}")
    made = subprocess.run([sys.executable, ROOT / "packaging/metadata.py", "--check"], capture_output=True, text=True)
    if made.returncode:
        wrong.append(made.stdout.strip())
    print("\n".join(wrong) or f"{len(versions)} files name version {wanted}")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
