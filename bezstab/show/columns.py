"""Columns: what is printed of an answer, each a typed function of it. Text, CSV, JSON and pages of keys follow."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Generic, SupportsFloat, TypeVar

from bezstab.show.fields import Form, Row, Value, formatted, visible

Answer = TypeVar("Answer")


@dataclass(frozen=True)
class Column(Generic[Answer]):
    """One value of an answer: its heading in text, its key in CSV and JSON, how it is found, its unit and meaning.

    `form` is a format, or a function from the value to its text. A `brief` column is printed without --all; one that
    tells answers `apart` is printed where there are several.
    """

    heading: str
    key: str
    value: Callable[[Answer], Value]
    meaning: str
    unit: str = ""
    form: Form = ""
    brief: bool = False
    apart: bool = False

    def text(self, answer: Answer) -> str:
        """Return what a table shows of an answer, on one line; a dash where there is no value."""
        return visible(formatted(self.value(answer), self.form))


def in_seconds(steps: int | None, h: SupportsFloat) -> float | None:
    """Return how long so many steps of h (s) take; None where there are none."""
    return None if steps is None else steps * float(h)


def row_of(columns: Sequence[Column[Answer]], answer: Answer) -> Row:
    """Return the values of an answer by key."""
    return {column.key: column.value(answer) for column in columns}


def page_of_keys(columns: Sequence[Column[Answer]]) -> str:
    """Return the table of keys, units and meanings as Markdown, for the page of a command."""
    lines = ["| key | unit | meaning |", "|---|---|---|"]
    return "\n".join([*lines, *(f"| `{each.key}` | {each.unit} | {each.meaning} |" for each in columns)])
