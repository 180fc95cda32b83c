"""Checks that every file that a comment or a page names exists, every heading that a page links to and every test that
a page cites as `Suite.Name`.

python3 tests/named_files.py
"""

import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COMMENT = {"hpp": "//", "cpp": "//", "py": "#", "sh": "#", "toml": "#", "cmake": "#", "txt": "#", "md": ""}
NAME = re.compile(r"(?<![\w/.$*<>-])((?:[\w.-]+/)*[\w-]+\.(?:hpp|cpp|py|sh|md|cmake))(?![\w*/])")
LINK = re.compile(r"\]\((?!https?:)([^)#\s]*)(?:#([^)\s]+))?\)")
HEADING = re.compile(r"#+\s+(.*)")
CITED = re.compile(r"`(?:\w+/)?([A-Z][A-Za-z0-9]*\.[A-Z][A-Za-z0-9]*)(?:/\*)?`")
TEST = re.compile(r"^ *(?:TYPED_)?TEST(?:_P|_F)?\((\w+),\s*(\w+)\)", re.MULTILINE)
REGISTERED = re.compile(r"\bNAME ([A-Z]\w*\.\w+)")  # by ctest alone
EXAMPLES = {"mine.hpp", "mine.cpp"}  # of a reader's own


def files():
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [f for f in folders if not f.startswith((".", "__", "build" if folder == ROOT else "."))]
        if not folder.startswith((os.path.join(ROOT, "shared"), os.path.join(ROOT, "tests", "data"))):
            yield from (os.path.relpath(os.path.join(folder, name), ROOT) for name in names)


def anchor(heading):
    """Returns the name that GitHub, and the site, give to a heading."""
    text = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading.strip()).lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(page):
    """Returns the names of all headings of a page, but for lines that look like one inside a fence."""
    names, fenced = set(), False
    with open(page, encoding="utf-8") as lines:
        for line in lines:
            fenced ^= line.startswith("```")
            found = None if fenced else HEADING.match(line)
            if found:
                names.add(anchor(found.group(1)))
    return names


def broken_links(file, text):
    """Returns the links in a line of a page whose file or heading does not exist."""
    for path, heading in LINK.findall(text):
        target = os.path.join(ROOT, os.path.dirname(file), path) if path else os.path.join(ROOT, file)
        if not os.path.exists(target):
            yield path
        elif heading and target.endswith(".md") and heading not in anchors(target):
            yield f"{path}#{heading}"


def cited_tests(there):
    """Returns the names that a page may cite: those of googletest's tests and of what ctest alone runs."""
    names = set()
    for file in there:
        pattern = TEST if file.endswith("_test.cpp") else REGISTERED if file.endswith("CMakeLists.txt") else None
        if pattern:
            with open(os.path.join(ROOT, file), encoding="utf-8") as text:
                names.update(n if isinstance(n, str) else ".".join(n) for n in pattern.findall(text.read()))
    return names


def main():
    there = sorted(files())
    tails = {"/".join(parts[k:]) for parts in (f.split("/") for f in there) for k in range(len(parts))}
    tests = cited_tests(there)
    missing = []
    for file in there:
        mark = COMMENT.get(file.rsplit(".", 1)[-1])
        if mark is None:
            continue
        with open(os.path.join(ROOT, file), encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                text = line.partition(mark)[2] if mark else line
                names = [n for n in NAME.findall(text) if n.lstrip("./") not in tails | EXAMPLES]
                names = [n for n in names if not os.path.basename(n).split(".")[0].isupper()]  # NAME.csv
                if not mark:
                    names += broken_links(file, text)
                    names += [n for n in CITED.findall(text) if n not in tests]
                missing += [f"{file}:{number}: {name} is not there" for name in names]
    print("\n".join(missing) or f"{len(there)} files, every name and link leads to one, every cited test is there")
    return bool(missing)


if __name__ == "__main__":
    sys.exit(main())
