"""Rows of results, typed columns that show them, and both as text, Markdown, CSV or JSON."""

import csv
import io
import json
import math
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

Value = str | float | int | Sequence[float] | Sequence[Sequence[str]] | None
Row = Mapping[str, Any]
"""A value by key, each of the kind that its `Field` says."""

Format = Literal["text", "json", "csv", "markdown"]

MISSING = "-"


@dataclass(frozen=True)
class Column:
    """What a table shows of each row: the heading above it, and the text made of a row."""

    heading: str
    text: Callable[[Row], str]

    def cell(self, row: Row) -> str:
        """Return the text on one line, infinite and missing numbers as a dash."""
        return visible(self.text(finite(row)))


def visible(text: str) -> str:
    """Return the text on one line, without what would command a terminal: a line's end is \\n, the escape \\x1b."""
    return "".join(
        character.encode("unicode_escape").decode()
        if unicodedata.category(character) in ("Cc", "Zl", "Zp")
        else character
        for character in text
    )


def column(heading: str, key: str, form: str = "") -> Column:
    """Return the column that shows row[key] in a format such as '.6f'; what is missing or empty is a dash."""
    return Column(heading, lambda row: formatted(row[key], form))


def formatted(value: Value, form: str = "") -> str:
    """Return a value in a format, minus zero as zero; a dash for None and for an empty text.

    Truth is yes or no; a format of its own is what it is called in place of no.
    """
    if value is None or value == "":
        return MISSING
    if isinstance(value, bool):
        return "yes" if value else form or "no"
    if isinstance(value, float):
        value += 0.0  # minus zero becomes zero
    return format(value, form)


def render(rows: Sequence[Row], columns: Sequence[Column], form: Format) -> str:
    """Return the rows in the given form: every key for json and csv, the chosen columns for text and markdown.

    What is infinite or not a number is missing: null, an empty cell, a dash. So is, in json and csv, a key that only
    other rows have: every row has the same. KeyError if a row lacks the key of a chosen column.
    """
    if form in ("json", "csv"):
        finite_rows = [finite(row) for row in rows]
        nothing = dict.fromkeys(key for row in finite_rows for key in row)
        full_rows = [{**nothing, **row} for row in finite_rows]
        if form == "csv":
            return _comma_separated(full_rows, list(nothing))
        return json.dumps(full_rows, indent=2, allow_nan=False)
    headings = [column.heading for column in columns]
    lines = [headings, *([column.cell(row) for column in columns] for row in rows)]
    return _markdown(lines) if form == "markdown" else _aligned(lines)


def finite(row: Row) -> Row:
    """Return the row with None for every value that is infinite or not a number."""
    return {key: None if isinstance(value, float) and not math.isfinite(value) else value for key, value in row.items()}


def _comma_separated(rows: Sequence[Row], keys: Sequence[str]) -> str:
    text = io.StringIO()
    writer = csv.DictWriter(text, keys, lineterminator="\n")
    writer.writeheader()
    writer.writerows({key: _in_one_cell(value) for key, value in row.items()} for row in rows)
    return text.getvalue().rstrip("\n")


def _in_one_cell(value: Value) -> Value:
    """Return a value as one cell of a table; a list as JSON has it."""
    return json.dumps(value) if isinstance(value, list) else value


def _aligned(lines: Sequence[Sequence[str]]) -> str:
    return "\n".join("  ".join(line).rstrip() for line in _padded(lines))


def _markdown(lines: Sequence[Sequence[str]]) -> str:
    padded = _padded([[cell.replace("|", "\\|") for cell in line] for line in lines])
    rule = ["-" * shown_width(cell) for cell in padded[0]]
    return "\n".join(f"| {' | '.join(line)} |" for line in (padded[0], rule, *padded[1:]))


def _padded(lines: Sequence[Sequence[str]]) -> list[list[str]]:
    """Return the cells filled up with spaces to the width of their column."""
    widths = [max(map(shown_width, column)) for column in zip(*lines, strict=True)]
    return [
        [cell + " " * (width - shown_width(cell)) for cell, width in zip(line, widths, strict=True)] for line in lines
    ]


def shown_width(text: str) -> int:
    """Return the number of character cells; the hat of alpha-hat is a combining character and takes none."""
    return sum(not unicodedata.combining(character) for character in text)
