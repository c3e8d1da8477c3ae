"""Processor times that an earlier sweep measured, so that a figure of them can be drawn the same again."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from bezstab.errors import InputError
from bezstab.evidence.accuracy_costs import Run
from bezstab.files import read_json

OTHER_RUNS = 0.1  # of the evaluations: on another processor Newton's method may take another iteration, not so many


@dataclass(frozen=True)
class RecordedRun:
    """What one run took: evaluations, and its processor time (s) as of `Run`."""

    evaluations: float
    seconds: float
    seconds_min: float
    seconds_max: float


RecordedTimes = Mapping[tuple[str, float], RecordedRun]
"""By method and step (s)."""


def read_times(path: Path, methods: Sequence[str], step_sizes: Sequence[float]) -> RecordedTimes:
    """Return what a file says of runs, among them those of these methods with each of these steps (s).

    The file has the rows of a sweep as `tradeoff` prints them with --format json. InputError, in one line, where it
    cannot be read, or a run is missing.
    """

    def parsed(rows: Any) -> RecordedTimes:
        recorded = _recorded(rows)
        for name, h in ((name, h) for name in methods for h in step_sizes):
            if (name, h) not in recorded:
                raise InputError(f"no run of {name} with h = {h:g} s")
        return recorded

    return read_json("times", path, parsed)


def _recorded(rows: Any) -> RecordedTimes:
    recorded: dict[tuple[str, float], RecordedRun] = {}
    try:
        for row in rows:
            numbers = [float(row[key]) for key in ("run_evaluations", "seconds", "seconds_min", "seconds_max")]
            if not all(0 < number < math.inf for number in numbers):
                raise ValueError
            recorded[row["method"], float(row["h"])] = RecordedRun(*numbers)
    except (KeyError, TypeError, ValueError, OverflowError):
        raise InputError("expected the rows that tradeoff prints with --format json") from None
    return recorded


def with_recorded_times(runs: Sequence[Run], recorded: RecordedTimes) -> list[Run]:
    """Return the runs with the processor times recorded of them; InputError where those are of other runs."""
    timed: list[Run] = []
    for run in runs:
        then = recorded[run.method.name, run.h]
        if abs(then.evaluations - run.evaluations) > OTHER_RUNS * run.evaluations:
            raise InputError(
                f"the recorded times are of other runs: {run.method.name} with h = {run.h:g} s took "
                f"{then.evaluations:g} evaluations, not {run.evaluations}"
            )
        timed.append(replace(run, seconds=then.seconds, seconds_min=then.seconds_min, seconds_max=then.seconds_max))
    return timed
