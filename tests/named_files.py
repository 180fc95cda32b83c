"""Every file of the project that a comment or a README names is there: python3 tests/named_files.py"""

import os
import re
import sys

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
COMMENT = {"hpp": "//", "cpp": "//", "py": "#", "sh": "#", "gp": "#", "toml": "#", "cmake": "#", "txt": "#", "md": ""}
NAME = re.compile(r"(?<![\w/.$*<>-])((?:[\w.-]+/)*[\w-]+\.(?:hpp|cpp|py|sh|gp|md|cmake|ipynb))(?![\w*/])")
LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)")
EXAMPLES = {"mine.hpp", "mine.cpp"}  # of a reader's own


def files():
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [f for f in folders if not f.startswith((".", "__", "build" if folder == ROOT else "."))]
        if not folder.startswith((os.path.join(ROOT, "shared"), os.path.join(ROOT, "tests", "data"))):
            yield from (os.path.relpath(os.path.join(folder, name), ROOT) for name in names)


def main():
    there = sorted(files())
    tails = {"/".join(parts[k:]) for parts in (f.split("/") for f in there) for k in range(len(parts))}
    missing = []
    for file in there:
        mark = COMMENT.get(file.rsplit(".", 1)[-1])
        if mark is None:
            continue
        with open(os.path.join(ROOT, file), encoding="utf-8") as lines:
            for number, line in enumerate(lines, 1):
                text = line.partition(mark)[2] if mark else line
                names = [n for n in NAME.findall(text) if n.lstrip("./") not in tails | EXAMPLES]
                names = [n for n in names if not os.path.basename(n).split(".")[0].isupper()]  # NAME.gp
                if not mark:
                    names += [n for n in LINK.findall(text)
                              if not os.path.exists(os.path.join(ROOT, os.path.dirname(file), n))]
                missing += [f"{file}:{number}: {name} is not there" for name in names]
    print("\n".join(missing) or f"{len(there)} files, every name is of one that is there")
    return bool(missing)


if __name__ == "__main__":
    sys.exit(main())
