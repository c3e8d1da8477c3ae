"""Logs of somebody else's simulator: columns of numbers from delimited text, and the step between its rows.

A log is text: one row for each sample, cells separated by commas, semicolons, tabs or blanks, a line with names above
or none. Nothing in it is executed.
"""

import csv
import math
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from pathlib import Path
from typing import BinaryIO

import numpy as np

from bezstab.errors import InputError
from bezstab.stability import FloatArray

LARGEST = 200_000_000
"""Bytes: minutes to read. A pole needs some hundred rows."""

COMMENTS = ("#", "%")
"""What lines begin with that are no data; the last of them above the data may hold the names, as numpy writes it."""

TIMES = {"t", "time", "times", "zeit", "sec", "secs", "seconds", "timestamp", "stamp", "clock", "elapsed"}
"""Words that name a time column."""

WHICH_TIME = {"sim", "simulation", "simulated", "world", "wall", "real", "ros", "header", "physics", "game", "total"}
"""Words that may stand beside them: sim_time, header.stamp."""

UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9}
"""Of times, in s, as the name of a column has them: time [ms], t_ms."""

COUNTERS = ("step", "steps", "index", "k", "i", "n", "frame", "row")
"""Names of columns that count rows: no error decays in them."""

DIPS = 3
"""Times that a column of absolute values comes down, at least: fewer may be chance."""

DIPPED = 0.5
"""Times the larger neighbour: so far down it comes in half of its dips, as |cos| does where it is sampled anywhere."""

UNEVEN = 0.01
"""Of the step: by more than that, and the rounding of the times, no sample may be early or late."""


@dataclass(frozen=True)
class Log:
    """Columns of numbers by name; `values` has shape (rows, columns), a missing number is nan.

    `name` is what messages call the log. A log without names has columns "1", "2" and so on.
    """

    name: str
    columns: tuple[str, ...]
    values: FloatArray

    def number_of(self, column: str) -> int:
        """Return the place of a column, given by its name or by its number from 1; InputError if there is none."""
        if self.columns.count(column) == 1:
            return self.columns.index(column)
        if column in self.columns:
            raise InputError(f"{self.name}: {self.columns.count(column)} columns are called {column!r}: give a number")
        if column.isascii() and column.isdigit() and 1 <= int(column) <= len(self.columns):
            return int(column) - 1
        listed = ", ".join(self.columns)
        raise InputError(f"{self.name}: no column {column[:50]!r} (columns: {listed}; or 1 to {len(self.columns)})")


def read_log(path: Path) -> Log:
    """Return the log in a file; InputError, with the path and the line, for what cannot be read as one."""
    try:
        with path.open("rb") as file:
            return log_from(file, str(path))
    except OSError as error:
        raise InputError(f"log {path}: {error.strerror}") from None


def log_from(file: BinaryIO, name: str) -> Log:
    """Return the log that an open file holds, called `name` in messages; InputError as `read_log`."""
    content = file.read(LARGEST + 1)
    if len(content) > LARGEST:
        raise InputError(f"log {name}: more than {LARGEST // 10**6} MB: give the some hundred rows after the kick")
    try:
        return parse_log(content.decode("utf-8-sig"), f"log {name}")
    except UnicodeDecodeError:
        raise InputError(f"log {name}: is not text (UTF-8)") from None


def parse_log(text: str, name: str) -> Log:
    """Return the log that a text holds; InputError, naming the line, for cells that are no numbers and ragged rows."""
    lines = [(number, line.strip(" ")) for number, line in enumerate(text.splitlines(), start=1) if line.strip()]
    comments = [line for _, line in lines if line.startswith(COMMENTS)]
    filled = [(number, line) for number, line in lines if not line.startswith(COMMENTS)]
    if not filled:
        raise InputError(f"{name}: is empty")
    sample = filled[min(1, len(filled) - 1)][1]  # the first line may hold names, the last be cut off
    delimiter = next((each for each in (";", "\t", ",") if each in sample.strip()), None)
    (_, first), *others = rows = [(number, _cells(line, delimiter)) for number, line in filled]
    of_comment = _cells(comments[-1].lstrip("".join(COMMENTS)).strip(), delimiter) if comments else []
    names = of_comment if len(of_comment) == len(first) else [str(k) for k in range(1, len(first) + 1)]
    if None in map(_number, first):
        names, rows = first, others
    if not rows:
        raise InputError(f"{name}: has names, but no rows of numbers")
    values = []
    for number, cells in rows:
        if len(cells) != len(first):
            raise InputError(f"{name}, line {number}: {len(cells)} cells, expected {len(first)} as above")
        values.append([_number(cell) for cell in cells])
        if None in values[-1]:
            raise InputError(f"{name}, line {number}: {cells[values[-1].index(None)][:50]!r} is not a number")
    return Log(name, tuple(cell.strip() for cell in names), np.array(values, float))


def _cells(line: str, delimiter: str | None) -> list[str]:
    """Return the cells of a line, which blanks separate where no delimiter is given."""
    if delimiter is None:
        return line.split()
    return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True))


def _number(cell: str) -> float | None:
    """Return the number of a cell, with a decimal point or a decimal comma; nan where it is empty, None for text."""
    try:
        return float(cell.replace(",", ".")) if cell.strip() else math.nan
    except ValueError:
        return None


def time_column(log: Log, chosen: str | None = None) -> int | None:
    """Return the place of the time column: the chosen one, else one that is called so; None if there is none.

    In a log without names the first of several columns is taken if it rises by equal steps, but for their rounding.
    InputError if the chosen column is not there.
    """
    if chosen is not None:
        return log.number_of(chosen)
    for place, column in enumerate(log.columns):
        if _names_time(column):
            return place
    unnamed = log.columns == tuple(str(k) for k in range(1, len(log.columns) + 1))
    if unnamed and len(log.columns) > 1 and len(log.values) > 2:
        with suppress(InputError):
            row_step(log, 0)
            return 0
    return None


def error_columns(log: Log, chosen: Sequence[str], time: int | None) -> list[int]:
    """Return the places of the chosen columns, else of all but those that hold times or count rows.

    InputError for a column that is not there, and where none is left.
    """
    if chosen:
        return [log.number_of(column) for column in chosen]
    left = [
        place
        for place, column in enumerate(log.columns)
        if not (place == time or _plain(column) in COUNTERS or _names_time(column))
    ]
    if not left:
        raise InputError(f"{log.name}: no column holds an error (columns: {', '.join(log.columns)})")
    return left


def _plain(column: str) -> str:
    """Return a column's name without its unit: 'Time [s]' is time."""
    return re.split(r"[\s(\[/]", column.strip().casefold(), maxsplit=1)[0]


def _words(column: str) -> list[str]:
    """Return the words of a column's name: 'simTime_ms' is sim, time, ms."""
    return [word.casefold() for word in re.findall(r"[^\W_]+", re.sub(r"(?<=[a-z])(?=[A-Z])", " ", column))]


def _names_time(column: str) -> bool:
    """Return whether a column is called a time: by its first word, or by all of them."""
    words = set(_words(column))
    return _plain(column) in TIMES or bool(words & TIMES and words <= TIMES | WHICH_TIME | UNITS.keys())


def row_step(log: Log, time: int | None) -> float | None:
    """Return the time between two rows in s; the name of the time column may say another unit (UNITS).

    None without a time column. InputError, naming the row, where times are missing, do not rise, or are uneven by more
    than their own rounding.
    """
    if time is None:
        return None
    t = log.values[:, time]
    if len(t) < 2 or not np.isfinite(t).all():
        raise InputError(f"{log.name}: column {log.columns[time]} has no time in every row, or one row only")
    step = float(t[-1] - t[0]) / (len(t) - 1)
    if not step > 0:
        raise InputError(f"{log.name}: the times in column {log.columns[time]} do not rise")
    late = np.abs(t - (t[0] + step * np.arange(len(t))))
    # A time that was rounded to the last of its decimals is off by half of it, and so are the ends of the mean step. A
    # place that is no small part of the step is no rounding of it: then a row that is left out would pass as well.
    place = decimal_place(t)
    allowed = UNEVEN * step + (place if place < step / 2 else 0.0)
    if late.max() > allowed:
        row = int(np.argmax(late))
        raise InputError(
            f"{log.name}: uneven times: row {row + 1} is {late[row]:.3g} off the mean step of {step:.6g}; "
            "a pole is per step, so log every step of one size"
        )
    return step * next((UNITS[word] for word in _words(log.columns[time])[1:] if word in UNITS), 1.0)


def looks_absolute(values: FloatArray) -> bool:
    """Return whether a column may hold absolute values or norms: never negative, and it comes down to zero repeatedly.

    A signed error that oscillates about zero does not stay above it, and one about another value does not come down.
    """
    c = values[np.isfinite(values)]
    if len(c) < 3 or c.min() < 0:
        return False
    low = (c[1:-1] < c[:-2]) & (c[1:-1] < c[2:])
    beside = np.maximum(c[:-2], c[2:])[low]
    return bool(low.sum() >= DIPS and np.median(c[1:-1][low] / beside) < DIPPED)


def decimal_place(values: FloatArray) -> float:
    """Return the value of the last decimal that any of these numbers shows, such as 1e-6; 0 without a number.

    The numbers of a log that was written with a fixed number of decimals are multiples of it. Zero shows none.
    """
    shown = [Decimal(repr(value)).normalize() for value in values[np.isfinite(values) & (values != 0)].tolist()]
    return 10.0 ** min(int(each.as_tuple().exponent) for each in shown) if shown else 0.0
