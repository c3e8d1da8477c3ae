"""Rows for a narrow terminal: a block of lines for each, heading and value, below a sentence; and text that wraps."""

import textwrap
from collections.abc import Sequence

from bezstab.show.columns import MISSING, Column, Row, shown_width, visible

LEAST_ROOM = 20  # characters for a value, however narrow the terminal: below that every word stands alone
GAP = "  "
"""Between a heading and its value, as between the columns of a table."""


def wrapped(text: str, width: int) -> str:
    """Return a text whose lines, broken between words, are at most `width` characters long, if its words are."""
    return "\n".join(
        textwrap.fill(line, width=max(width, LEAST_ROOM), break_long_words=False, break_on_hyphens=False)
        for line in text.split("\n")
    )


def fits(table: str, width: int) -> bool:
    """Return whether every line of a table has at most `width` character cells."""
    return all(shown_width(line) <= width for line in table.split("\n"))


def block(row: Row, columns: Sequence[Column], width: int, sentence: str = "") -> str:
    """Return the row as a line for each column that has a value, its heading in front, below the sentence.

    A value that is longer than its line goes on below itself. KeyError if the row lacks the key of a column.
    """
    cells = [(column.heading, column.cell(row)) for column in columns]
    present = [(heading, text) for heading, text in cells if text not in (MISSING, "")]
    longest = max((shown_width(heading) for heading, _ in present), default=0)
    room = max(width - longest - len(GAP), LEAST_ROOM)
    lines: list[str] = []
    for heading, text in present:
        first, *more = wrapped(text, room).split("\n")
        lines.append(heading + " " * (longest - shown_width(heading)) + GAP + first)
        lines += [" " * (longest + len(GAP)) + line for line in more]
    return "\n".join([wrapped(visible(sentence), width), "", *lines] if sentence else lines)
