"""What a cell of a table shows of a value, on one line."""

import math
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from typing import Any

Value = str | float | int | Sequence[float | None] | Sequence[Sequence[str]] | None
Row = Mapping[str, Any]
"""A value by key."""

MISSING = "-"
MOST_FIXED = 1e6  # a modulus from here on is shown with an exponent


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


def pole_words(pole: complex) -> str:
    """Return a pole and its conjugate, or a real one: 0.762694 ± 0.142074i."""
    form = ".6f" if max(abs(pole.real), pole.imag) < MOST_FIXED else ".6e"
    is_pair = round(pole.imag / max(1, abs(pole.real)), 6) != 0
    return f"{pole.real:{form}} ± {pole.imag:{form}}i" if is_pair else f"{pole.real:{form}}"


def modulus_words(modulus: float) -> str:
    """Return |z|: six decimals, or an exponent where it is huge."""
    return formatted(modulus, ".6e" if abs(modulus) >= MOST_FIXED else ".6f")


def up_to(form: str, without: str) -> Callable[[float], str]:
    """Return the form of a number that is infinite where there is no limit."""
    return lambda number: without if math.isinf(number) else formatted(number, form)


def between(form: str, without: str) -> Callable[[Sequence[float]], str]:
    """Return the form of a pair of ends: 0.2 to 1.65."""
    end = up_to(form, without)
    return lambda ends: f"{end(ends[0])} to {end(ends[1])}"
