"""Answers as text: tables, lines below a sentence, Markdown; rows as CSV or JSON; and text that wraps."""

import csv
import io
import json
import textwrap
import unicodedata
from collections.abc import Sequence
from typing import Literal

from bezstab.show.cells import MISSING, Row, visible

Format = Literal["text", "json", "csv", "markdown"]

LEAST_ROOM = 20  # characters for a value, however narrow the terminal: below that every word stands alone
GAP = "  "
"""Between a heading and its value, and between the columns of a table."""


def for_programs(rows: Sequence[Row], form: Format) -> str:
    """Return every key of the rows as JSON, or else as CSV; a key that only other rows have is null, or an empty cell.

    A list is one cell of CSV, as JSON has it.
    """
    nothing = dict.fromkeys(key for row in rows for key in row)
    whole = [{**nothing, **row} for row in rows]
    if form == "json":
        return json.dumps(whole, indent=2, allow_nan=False)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(nothing)
    for row in whole:
        writer.writerow(json.dumps(value) if isinstance(value, list) else value for value in row.values())
    return text.getvalue().rstrip("\n")


def table(lines: Sequence[Sequence[str]], form: Format) -> str:
    """Return lines of cells, the first the headings, with each cell as wide as its column."""
    if form == "markdown":
        lines = [[cell.replace("|", "\\|") for cell in line] for line in lines]
    widths = [max(map(shown_width, cells)) for cells in zip(*lines, strict=True)]
    padded = [[_filled_up(cell, width) for cell, width in zip(line, widths, strict=True)] for line in lines]
    if form == "markdown":
        rule = ["-" * width for width in widths]
        return "\n".join(f"| {' | '.join(line)} |" for line in (padded[0], rule, *padded[1:]))
    return "\n".join(GAP.join(line).rstrip() for line in padded)


def _filled_up(text: str, width: int) -> str:
    return text + " " * (width - shown_width(text))


def shown_width(text: str) -> int:
    """Return the number of character cells of the longest line; the hat of alpha-hat combines and takes none."""
    return max(sum(not unicodedata.combining(character) for character in line) for line in text.split("\n"))


def wrapped(text: str, width: int) -> str:
    """Return a text whose lines, broken between words, are at most `width` characters long, if its words are."""
    return "\n".join(
        textwrap.fill(line, width=max(width, LEAST_ROOM), break_long_words=False, break_on_hyphens=False)
        for line in text.split("\n")
    )


def lines_below(sentence: str, values: Sequence[tuple[str, str]], width: int) -> str:
    """Return a line for each value that there is, its heading in front, below a sentence, if any."""
    present = [(heading, text) for heading, text in values if text not in (MISSING, "")]
    indent = max((shown_width(heading) for heading, _ in present), default=0) + len(GAP)
    lines = []  # a value that is longer than its line goes on below itself
    for heading, text in present:
        value = wrapped(text, width - indent).replace("\n", "\n" + " " * indent)
        lines.append(_filled_up(heading, indent) + value)
    return "\n\n".join(filter(None, [wrapped(visible(sentence), width), "\n".join(lines)]))
