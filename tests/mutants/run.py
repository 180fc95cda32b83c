#!/usr/bin/env python3
"""Do the tests notice? Breaks the code on purpose, one line at a time, and runs the tests that should fail.

    python3 tests/mutants/run.py [--list FILE] [--check] [PATTERN]

PATTERN, a regular expression, chooses mutants by "file: before  →  after". Works in a git worktree of HEAD in a
temporary folder ($TMPDIR), with a build folder of its own; tests/mutants/list.txt says how mutants are written.
Ends with 1 unless every mutant is noticed, or is said to change nothing. --check only looks whether each one's line
stands in its file, once: run it after an edit of a listed line. It is no test, since no fault of the code fails it.
"""
import argparse, collections, pathlib, re, shutil, signal, subprocess, sys, tempfile, time

HERE = pathlib.Path(__file__).resolve().parent
FAST = {"ccache": "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "mold": "-DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=mold"}
SECONDS = 600  # a test that takes longer has noticed: it hangs


def read(path):
    """Mutants as dicts: file, tests, before, after, reason (of one that changes nothing)."""
    mutants, file, tests = [], None, None
    for number, line in enumerate(path.read_text().splitlines(), 1):
        mark, text = line[:2], line[2:].strip()
        if not line.strip() or line.startswith("#"):
            continue
        if mark == "- ":
            mutants.append(dict(file=file, tests=tests, before=text, after="", reason=""))
        elif mark in ("+ ", "+", "= ") and mutants:
            mutants[-1]["reason" if mark == "= " else "after"] = text
        elif re.fullmatch(r"\S+:( \S+)+", line):
            file, tests = line.split(":", 1)[0], line.split(":", 1)[1].split()
        else:
            sys.exit(f"{path}:{number}: expected 'file: tests', '- before', '+ after' or '= reason'")
    return mutants


def name_of(mutant):
    return "{file}: {before}  →  {after}".format(**mutant)


def run(command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **options)


def build(tree, tests):
    targets = ["taut-lammps" if test.startswith("Lammps.") else "taut" if "." in test else test for test in tests]
    return run(["nice", "-n19", "ninja", "-C", tree / "build", "-j1", *targets]).returncode == 0


def failure(tree, test):
    """Which test fails; nothing if none does."""
    command = [tree / "build/tests" / test, "--gtest_brief=1", "--gtest_fail_fast"]
    if "." in test:  # one of ctest's own
        command = ["ctest", "--test-dir", tree / "build", "-R", re.escape(test)]
    try:
        done = run(["nice", "-n19", *command], timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return f"{test}, which hangs"
    failed = re.search(r"\[  FAILED  \] (\S+?),? ", done.stdout)
    return done.returncode and (failed.group(1) if failed else test)


def misplaced(tree, mutant):
    path = tree / mutant["file"]
    found = path.read_text().count(mutant["before"]) if path.is_file() else 0
    return {0: "not found", 1: ""}.get(found, "found twice")


def verdict(tree, mutant):
    path = tree / mutant["file"]
    if wrong := misplaced(tree, mutant):
        return wrong
    text = path.read_text()
    try:
        path.write_text(text.replace(mutant["before"], mutant["after"]))
        if not build(tree, mutant["tests"]):
            return "did not compile"
        failed = next(filter(None, (failure(tree, test) for test in mutant["tests"])), None)
        return f"killed by {failed}" if failed else "equivalent" if mutant["reason"] else "SURVIVED"
    finally:
        path.write_text(text)


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the worktree is taken down
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pattern", nargs="?", default="")
    parser.add_argument("--list", type=pathlib.Path, default=HERE / "list.txt")
    parser.add_argument("--check", action="store_true")
    asked = parser.parse_args()
    mutants = [m for m in read(asked.list) if re.search(asked.pattern, name_of(m))]
    if asked.check:
        wrong = [f"{misplaced(HERE.parents[1], m)}: {name_of(m)}" for m in mutants if misplaced(HERE.parents[1], m)]
        sys.exit("\n".join(wrong) if wrong else 0)
    counts = collections.Counter()
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        tree = pathlib.Path(folder) / "tree"
        git = ["git", "-C", HERE, "worktree"]
        try:
            if run([*git, "add", "--detach", tree, "HEAD"]).returncode:
                sys.exit("no worktree could be made")
            options = ["-DTAUT_TESTS_APART=ON", *map(FAST.get, filter(shutil.which, FAST))]
            run(["cmake", "--preset", "release", "-G", "Ninja", *options], cwd=tree)
            tests = sorted({test for m in mutants for test in m["tests"]})
            if not build(tree, tests) or any(failure(tree, test) for test in tests):
                sys.exit("without any mutant the tree does not build, or a test fails")
            for number, mutant in enumerate(mutants, 1):
                start = time.time()
                result = verdict(tree, mutant)
                counts.update([result.split(" by ")[0]])
                seconds = f"{number:3}/{len(mutants)} {time.time() - start:4.0f} s"
                print(f"{seconds}  {result:50} {name_of(mutant)}", flush=True)
        finally:
            run([*git, "remove", "--force", tree])
    print(", ".join(f"{count} {result}" for result, count in sorted(counts.items())))
    return 1 if set(counts) - {"killed", "equivalent"} else 0


if __name__ == "__main__":
    sys.exit(main())
