"""Logs of somebody else's simulator: a CSV whose first line names its columns, separated by commas, semicolons or tabs.

Nothing in a log is executed.
"""

import re
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from bezstab.errors import InputError
from bezstab.stability.arrays import FloatArray

TIMES = re.compile(r"t(ime)?(\W+s\W*)?", re.IGNORECASE)
"""What a column of times in s is called: t, Time, time [s]. Every other column holds an error."""

LATE = 0.25
"""Of the time between two rows: by no more may one be early or late, as 240 Hz are to a ms; more is a row left out."""

OTHER = 0.01
"""Of that time: by no more may it be another than was said."""


@dataclass(frozen=True)
class Log:
    """The errors in a log by their columns' names, shape (rows,) each, and the time between rows in s, if it says so.

    `name` is what messages call the log.
    """

    name: str
    errors: dict[str, FloatArray]
    row_step: float | None

    def column(self, name: str) -> FloatArray:
        """Return the errors in a column; InputError if there is none of that name."""
        if name not in self.errors:
            raise InputError(f"log {self.name}: no column {name[:50]!r} (columns: {', '.join(self.errors)})")
        return self.errors[name]


def read_log(file: BinaryIO, row_step: float | None = None) -> Log:
    """Return what a log holds; InputError, with the line, for what is no such CSV in UTF-8.

    InputError, too, if its times are uneven, or another than `row_step` (s) apart where that is given. The first line
    may begin with #, as numpy writes it. Beside semicolons and tabs a number may have a decimal comma.
    """
    name = str(getattr(file, "name", "<stdin>"))
    try:
        first, *lines = file.read().decode("utf-8-sig").splitlines() or [""]
    except UnicodeDecodeError:
        raise InputError(f"log {name}: is not text (UTF-8)") from None
    delimiter = next((each for each in ";\t" if each in first), ",")
    names = [each.strip(' "') for each in first.lstrip("# ").split(delimiter)]
    if len(set(names) - {""}) < len(names) or any(_number(each) is not None for each in names):
        raise InputError(f"log {name}, line 1: {first[:50]!r}: expected a name for each column")
    rows = []
    for number, line in enumerate(lines, start=2):
        row = [_number(cell) for cell in line.split(delimiter)]
        if line.strip():
            if len(row) != len(names) or None in row:
                raise InputError(f"log {name}, line {number}: {line[:50]!r}: expected a number for each column")
            rows.append(row)
    columns = dict(zip(names, np.array(rows, float).reshape(-1, len(names)).T, strict=True))
    times = [columns.pop(each) for each in names if TIMES.fullmatch(each)]
    if not (rows and columns):
        raise InputError(f"log {name}: expected rows of numbers, and a column that is not of times")
    own_step = _row_step(times[0], name) if times else None
    if own_step and row_step and abs(own_step - row_step) > OTHER * row_step:
        raise InputError(f"log {name}: rows every {own_step:g} s, expected every {row_step:g} s")
    return Log(name, columns, own_step)


def _number(cell: str) -> float | None:
    try:
        return float(cell.replace(",", "."))
    except ValueError:
        return None


def _row_step(t: FloatArray, name: str) -> float:
    """Return the time between two rows, in the unit of the times t, shape (rows,)."""
    step = float(t[-1] - t[0]) / max(len(t) - 1, 1)
    late = np.abs(t - np.linspace(t[0], t[-1], len(t)))
    if not (step > 0 and late.max() <= LATE * step):  # not a number included
        raise InputError(f"log {name}: its times do not rise by equal steps: log every step of one size")
    return step
