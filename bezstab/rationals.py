"""Exact numbers: what a text or a float says, as a rational, within the range of float64."""

import re
from fractions import Fraction

from bezstab.errors import InputError


def within_float64(value: Fraction, said: str) -> Fraction:
    """Return a number that is zero or in float64's normal range; else InputError, with what is said of it."""
    if value and not Fraction("1e-307") < abs(value) < Fraction("1e308"):
        raise InputError(f"{said} is outside the range of float64 (1e-307 to 1e308)")
    return value


def rational(text: str) -> Fraction:
    """Return the exact value of a decimal ('-0.5', '1e-3') or a fraction ('6/11').

    InputError unless it is finite and, if not zero, within float64's normal range, so that no exponent is absurd.
    """
    number = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,4})?"
    if not re.fullmatch(rf"{number}|[-+]?\d+/0*[1-9]\d*", text.strip(), re.ASCII) or len(text) > 1000:
        raise InputError(f"{text[:50]!r} is not a finite decimal or fraction")
    return within_float64(Fraction(text.strip()), repr(text))


def exact(value: float) -> Fraction:
    """Return the rational that a float shows when printed: 0.1 is 1/10, not the binary fraction next to it."""
    return Fraction(repr(value))
