#!/usr/bin/env python3
"""Do the tests notice? Breaks the lines that a change touched, one place at a time, and runs the tests that should fail.

    python3 tests/mutate.py --tests 'Box|Observables' [--targets taut] [--since HEAD] [--at-most 40] [FILE ...]

The lines are those of C++ and Python outside of tests that `git diff` shows since a commit; HEAD: what is not committed
yet. An operator, a sign, a number or a comparison becomes another, or a statement goes. Each mutant is built and tested
in the build folder: --tests is for ctest -R, whose programs are built, and what --targets names besides, such as the
command or the module that these tests call. Files are put back after each, and git's index is locked meanwhile, lest a
mutant be committed. Prints what each came to, and ends with 1 if one survived: write the test that kills it, or see that
it changes no result. It is run by hand, since a mutant takes as long as a build.
"""
import argparse
import collections
import contextlib
import json
import pathlib
import random
import re
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
SECONDS = 600  # a test that takes longer has noticed: it hangs
# What is put in the place of what; the first that matches at a place counts.
CHANGES = [(re.compile(pattern), to) for pattern, to in (
    (r" \+ ", " - "), (r" - ", " + "), (r" \* ", " / "), (r" / ", " * "), (r" \+= ", " -= "), (r" -= ", " += "),
    (r" <= ", " < "), (r" >= ", " > "), (r" < ", " <= "), (r" > ", " >= "), (r" == ", " != "), (r" != ", " == "),
    (r" && ", " || "), (r" \|\| ", " && "), (r"\band\b", "or"), (r"\bor\b", "and"), (r"\bnot ", ""), (r"(?<=\()!", ""),
    (r"\btrue\b", "false"), (r"\bfalse\b", "true"), (r"\bTrue\b", "False"), (r"\bFalse\b", "True"),
    (r"\bmin\b", "max"), (r"\bmax\b", "min"), (r"\bbreak;", "continue;"), (r"\+\+", "--"),
    (r"(?<![\w.])\d+(\.\d+)?(?![\w.])", lambda m: str((float if "." in m[0] else int)(m[0]) + 1)),
)]
STATEMENT = re.compile(r"\s*(?!return\b|using\b|auto\b|const\b|import\b|from\b)[\w.>\-\[\]:() ]+( [-+*/]?= .*|\(.*\));?\s*$")
APART = re.compile(r'"(\\.|[^"\\])*"|\'(\\.|[^\'\\])*\'|//.*|#.*')  # words of messages, comments, includes


def touched(since, files):
    """The lines that the change added: (file, number from 0)."""
    diff = subprocess.run(["git", "diff", "-U0", since, "--", *(files or ["*.cpp", "*.hpp", "*.py", ":!tests", ":!*/tests/*"])],
                          cwd=ROOT, capture_output=True, text=True, check=True).stdout
    file = None
    for line in diff.splitlines():
        if line.startswith("+++ "):
            file = line[6:] if line.startswith("+++ b/") else None
        elif file and (hunk := re.match(r"@@ \S+ \+(\d+)(?:,(\d+))? @@", line)):
            first, count = int(hunk[1]), int(hunk[2] or 1)
            yield from ((file, number - 1) for number in range(first, first + count))


def mutants_of(line):
    """The line with one thing changed, each in turn."""
    spared = [m.span() for m in APART.finditer(line)]
    taken = set()
    for pattern, to in CHANGES:
        for m in pattern.finditer(line):
            if m.start() in taken or any(a <= m.start() < b for a, b in spared):
                continue
            taken.add(m.start())
            yield line[:m.start()] + (to(m) if callable(to) else to) + line[m.end():]
    if STATEMENT.match(line) and not line.lstrip().startswith(("//", "#")):
        yield re.match(r"\s*", line)[0] + ("pass" if not line.rstrip().endswith(";") else "")


@contextlib.contextmanager
def locked_index():
    lock = ROOT / run("git", "rev-parse", "--git-path", "index.lock").stdout.strip()
    lock.touch(exist_ok=False)
    try:
        yield
    finally:
        lock.unlink()


def run(*command, timeout=None):
    try:
        return subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return subprocess.CompletedProcess(command, 1, "a test hangs")


def programs(asked):
    """The targets that the tests are in."""
    shown = run("ctest", "--test-dir", asked.build, "-R", asked.tests, "--show-only=json-v1").stdout
    commands = {test["command"][0] for test in json.loads(shown)["tests"]}
    return sorted(pathlib.Path(command).name for command in commands if str(ROOT / asked.build) in command)


def verdict(asked):
    if asked.targets and run("ninja", "-C", asked.build, *asked.targets).returncode:
        return "does not compile"
    done = run("ctest", "--test-dir", asked.build, "-R", asked.tests, "--stop-on-failure", "--no-tests=error", timeout=SECONDS)
    failed = re.search(r"- (\S+) \((?!Not Run)\w+", done.stdout)
    return f"killed by {failed[1] if failed else done.stdout.strip().splitlines()[-1]}" if done.returncode else "SURVIVED"


def count_verdicts(asked, mutants):
    counts = collections.Counter()
    for file, number, changed in mutants:
        path, text = ROOT / file, (ROOT / file).read_text()
        lines = text.splitlines()
        before, lines[number] = lines[number], changed
        try:
            path.write_text("\n".join(lines) + "\n")
            result = verdict(asked)
        finally:
            path.write_text(text)
        counts[result.split(" by ")[0]] += 1
        print(f"{result}\n  {file}:{number + 1}\n  - {before.strip()}\n  + {changed.strip()}", flush=True)
    return counts


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # the file is put back
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*")
    parser.add_argument("--since", default="HEAD")
    parser.add_argument("--targets", nargs="+", default=[])
    parser.add_argument("--tests", required=True)
    parser.add_argument("--build", default="build")
    parser.add_argument("--at-most", type=int, default=40, help="so many mutants, chosen at random")
    asked = parser.parse_intermixed_args()
    asked.targets += programs(asked)
    mutants = [(file, number, changed) for file, number in touched(asked.since, asked.files)
               for changed in mutants_of((ROOT / file).read_text().splitlines()[number])]
    if len(mutants) > asked.at_most:
        mutants = sorted(random.Random(1).sample(mutants, asked.at_most))
    if (whole := verdict(asked)) != "SURVIVED":
        sys.exit(f"without any mutant: {whole}")
    with locked_index():
        counts = count_verdicts(asked, mutants)
    run("ninja", "-C", asked.build, *asked.targets)
    print(", ".join(f"{count} {result}" for result, count in sorted(counts.items())) or "no line was touched")
    return 1 if counts["SURVIVED"] else 0


if __name__ == "__main__":
    sys.exit(main())
