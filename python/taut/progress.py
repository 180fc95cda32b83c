"""Lines that show on a terminal or in a notebook how far a run or a study has come."""

from __future__ import annotations

import sys
import time
from typing import Any

REFRESH_SECONDS = 0.25


def _duration(seconds: float) -> str:
    """Writes a duration as m:ss or h:mm:ss."""
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{seconds:02}" if hours else f"{minutes}:{seconds:02}"


def _rewrite_line(text: str) -> None:
    sys.stderr.write(f"\r{text:<78}")
    sys.stderr.flush()


class StudyProgress:
    """Shows how many trials of a study are done. It prints nothing where standard error is a file or a pipe."""

    def __init__(self) -> None:
        self.shown = sys.stderr.isatty() or "ipykernel" in sys.modules

    def __call__(self, *what: Any) -> None:
        """Shows a text, or "n of m trials" for two numbers."""
        if self.shown:
            _rewrite_line(what[0] if len(what) == 1 else f"{what[0]} of {what[1]} trials")

    def done(self) -> None:
        """Clears the line."""
        if self.shown:
            _rewrite_line("")
            sys.stderr.write("\r")


class RunProgress:
    """Shows a bar with the speed of a run and the time that is left, on standard error.

    first   number of steps taken before the run
    steps   number of steps of the run
    dt_fs   length of a step [fs]
    """

    def __init__(self, first: int, steps: int, dt_fs: float) -> None:
        self.first, self.steps, self.dt_fs = first, steps, dt_fs
        self.begun = self.shown = time.monotonic()

    def text(self, taken: int, seconds: float) -> str:
        """Returns the line for this number of steps taken in this time [s]."""
        share = taken / self.steps
        filled = int(20 * share)
        line = f"[{'#' * filled}{' ' * (20 - filled)}] {100 * share:3.0f} %  {taken} of {self.steps} steps"
        if taken and seconds > 0:
            ns_per_day = taken * self.dt_fs * 1e-6 * 86400 / seconds
            line += f"  {ns_per_day:.4g} ns/day  {_duration(seconds * (self.steps - taken) / taken)} left"
        return line

    def __call__(self, step: int) -> None:
        """Shows the bar at this step, if the last time is long enough ago."""
        now = time.monotonic()
        if now - self.shown >= REFRESH_SECONDS:
            self.shown = now
            _rewrite_line(self.text(step - self.first, now - self.begun))

    def end(self, step: int) -> None:
        """Shows the bar a last time, and ends the line."""
        _rewrite_line(self.text(step - self.first, time.monotonic() - self.begun))
        sys.stderr.write("\n")


class MinimiseProgress:
    """Shows a minimisation's moves, energy and largest force on standard error."""

    def __init__(self) -> None:
        self.shown = 0.0

    def __call__(self, moves: int, energy: float, force: float) -> None:
        now = time.monotonic()
        if now - self.shown >= REFRESH_SECONDS:
            self.shown = now
            _rewrite_line(f"{moves} moves  {energy:.8g} kJ/mol  largest force {force:.4g} kJ/mol/nm")

    def end(self) -> None:
        """Ends the line, if there is one."""
        if self.shown:
            sys.stderr.write("\n")
