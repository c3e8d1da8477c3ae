"""Lists of exact numbers, written as a line."""

from fractions import Fraction


def fractions(text: str) -> tuple[Fraction, ...]:
    """Return the numbers of a line like '1 -4/3 1/3'."""
    return tuple(Fraction(entry) for entry in text.split())
