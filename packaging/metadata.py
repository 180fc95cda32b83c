"""Writes codemeta.json, which archives of software read, and .zenodo.json, from CITATION.cff.

python3 packaging/metadata.py            writes both
python3 packaging/metadata.py --check    says whether they are as it would write them
"""

import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def citation():
    """Returns CITATION.cff as a table: it has keys, texts of one line or folded, and lists of words or names."""
    table, key = {}, None
    for line in (ROOT / "CITATION.cff").read_text(encoding="utf-8").splitlines():
        if match := re.fullmatch(r"([\w-]+): *(.*)", line):
            key, value = match.groups()
            table[key] = value.strip('"') if value not in ("", ">-") else ([] if value == "" else "")
        elif isinstance(table[key], list):
            table[key].append(line.strip().removeprefix("- ").removeprefix("name: "))
        else:
            table[key] = f"{table[key]} {line.strip()}".strip()
    return table


def made():
    """Returns both files' text by name."""
    c = citation()
    codemeta = {
        "@context": "https://w3id.org/codemeta/3.0", "@type": "SoftwareSourceCode", "name": "taut",
        "description": c["abstract"], "version": c["version"],
        **({"dateModified": c["date-released"]} if "date-released" in c else {}),  # released versions have a day
        "license": f"https://spdx.org/licenses/{c['license']}", "keywords": c["keywords"],
        "author": [{"@type": "Organization", "name": name} for name in c["authors"]],
        "programmingLanguage": ["C++", "Python"], "operatingSystem": "Linux", "developmentStatus": "active",
    }
    zenodo = {
        "title": c["title"], "description": c["abstract"], "upload_type": "software", "version": c["version"],
        "license": c["license"], "creators": [{"name": name} for name in c["authors"]], "keywords": c["keywords"],
    }
    return {name: json.dumps(what, indent=2, ensure_ascii=False) + "\n"
            for name, what in (("codemeta.json", codemeta), (".zenodo.json", zenodo))}


def main():
    stale = []
    for name, text in made().items():
        file = ROOT / name
        if "--check" not in sys.argv:
            file.write_text(text, encoding="utf-8")
        elif not file.exists() or file.read_text(encoding="utf-8") != text:
            stale.append(name)
    if stale:
        print(f"{', '.join(stale)}: not what CITATION.cff says; run python3 packaging/metadata.py")
    return bool(stale)


if __name__ == "__main__":
    sys.exit(main())
