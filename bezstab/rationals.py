"""Exact numbers: what a text or a float says, as a rational, within the range of float64; exact bisection."""

import re
from collections.abc import Callable, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from fractions import Fraction
from math import lcm

from bezstab.errors import InputError, shown

ONE, ZERO = Fraction(1), Fraction(0)

# Within float64's normal range, with room for the rounding of its ends.
SMALLEST = Fraction("1e-307")
LARGEST = Fraction("1e308")

DECIMAL = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,4})?"  # four digits of exponent: enough to be out of range
QUOTIENT = r"[-+]?\d+/0*[1-9]\d*"
LONGEST = 1000  # characters: beyond any number somebody means, far below what takes time to read


def exact(value: float) -> Fraction:
    """Return the rational that a float shows when printed: 0.1 is 1/10, not the binary fraction next to it.

    What a user typed as a decimal of up to 15 digits comes back as typed; what was computed becomes the shortest
    decimal that rounds to it. No unit is changed. ValueError for nan and the infinities, which show no number.
    """
    return Fraction(repr(float(value)))


def rational(text: str) -> Fraction:
    """Return the exact value of a decimal ('-0.5', '1e-3') or a fraction ('6/11').

    InputError unless it is finite and, if not zero, within float64's normal range, so that no exponent is absurd.
    """
    if len(text) > LONGEST or not re.fullmatch(f"{DECIMAL}|{QUOTIENT}", text.strip(), re.ASCII):
        raise InputError(f"{shown(text)} is not a finite decimal or fraction")
    return within_float64(Fraction(text.strip()), shown(text))


def within_float64(value: Fraction, name: str) -> Fraction:
    """Return a number that is zero or in float64's normal range (1e-307 to 1e308 in size).

    InputError for any other, which begins with `name`, what the number is called.
    """
    if value != 0 and not SMALLEST <= abs(value) <= LARGEST:
        raise InputError(f"{name} is outside the range of float64 (1e-307 to 1e308)")
    return value


def whole_multiples(numbers: Sequence[Fraction]) -> tuple[list[int], int]:
    """Return the least multiples of rational numbers that are whole, and the factor: their products are fast."""
    scale = lcm(*(number.denominator for number in numbers))
    return [number.numerator * (scale // number.denominator) for number in numbers], scale


def bisected_integers(holds: Callable[[int], bool], before: int, after: int) -> tuple[int, int]:
    """Return neighbours: at the first, `before` or above it, the condition fails; at the second it holds.

    That it fails at `before` and holds at `after` > `before` is taken for granted: neither is asked. So the roots of
    polynomials are enclosed exactly, on a grid of as many digits as asked for.
    """
    while after - before > 1:
        middle = (before + after) // 2
        before, after = (before, middle) if holds(middle) else (middle, after)
    return before, after


def rounded_down(value: float, digits: int) -> str:
    """Return a positive number to so many digits, not above it: what is safe up to the number is safe up to these."""
    return _rounded(value, digits, ROUND_FLOOR)


def rounded_up(value: float, digits: int) -> str:
    """Return a positive number to so many digits, not below it: what is safe from the number on is safe from these."""
    return _rounded(value, digits, ROUND_CEILING)


def _rounded(value: float, digits: int, rounding: str) -> str:
    return f"{float(Context(prec=digits, rounding=rounding).create_decimal_from_float(value)):.{digits}g}"


def typed_number(number: Fraction) -> str:
    """Return a number as somebody would type it: a decimal where that is short and exact, else a fraction.

    Of a fraction that is longer than a float, as those are that were computed, the decimal that float64 reads as it.
    """
    decimal = f"{float(number):.12g}"
    if Fraction(decimal) == number:
        return decimal
    return min(str(number), repr(float(number)), key=len)
