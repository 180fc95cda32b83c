"""How runners start an engine's program, and end it."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import tempfile
from pathlib import Path
from typing import List

from shared import EngineStopped

LARGEST_FILE = 2**28  # bytes


def run_program(arguments: List[str], folder: Path, typed: str = "", **environment: str) -> "subprocess.CompletedProcess[str]":
    """A program's exit status and what it says. If the wait is cut short, it and all that it started are ended; so is a
    program that writes without end, which has failed."""
    limit = (resource.RLIMIT_FSIZE, (LARGEST_FILE, LARGEST_FILE))
    with tempfile.TemporaryFile("w+") as said, subprocess.Popen(
            arguments, cwd=folder, env={**os.environ, "OMP_NUM_THREADS": "1", **environment}, text=True, stdout=said,
            stdin=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True,
            preexec_fn=lambda: resource.setrlimit(*limit)) as program:
        try:
            err = program.communicate(typed)[1]
        except BaseException:
            os.killpg(program.pid, signal.SIGKILL)
            raise
        said.seek(0)
        out = said.read()
    if program.returncode == -signal.SIGXFSZ:
        raise EngineStopped(f"it writes without end: {' '.join(out[-300:].split())}")
    return subprocess.CompletedProcess(arguments, program.returncode, out, err)
