"""Values as tables show them, on one line."""

import unicodedata
from collections.abc import Callable, Mapping, Sequence
from typing import Any

Value = str | float | int | Sequence[float | None] | Sequence[Sequence[str]] | None
Row = Mapping[str, Any]
"""A value by key."""

MISSING = "-"


def visible(text: str) -> str:
    """Return the text on one line, without what would command a terminal: a line's end is \\n, the escape \\x1b."""
    return "".join(
        character.encode("unicode_escape").decode()
        if unicodedata.category(character) in ("Cc", "Zl", "Zp")
        else character
        for character in text
    )


Form = str | Callable[[Any], str]
"""Of a value: a format, or what makes its text."""


def formatted(value: Value, form: Form = "") -> str:
    """Return a value in a form, by default six digits, minus zero as zero; a dash for None and for an empty text.

    Truth is yes or no; a format of its own is what it is called in place of no. That of a list is of its parts.
    """
    if value is None or value == "":
        return MISSING
    if callable(form):
        return form(value)
    if form and isinstance(value, list | tuple):
        return ", ".join(formatted(each, form) for each in value)
    if isinstance(value, bool):
        return "yes" if value else form or "no"
    if isinstance(value, float):
        return format(value + 0.0, form or ".6g")  # minus zero becomes zero
    return format(value, form)
