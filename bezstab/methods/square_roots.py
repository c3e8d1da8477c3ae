"""Coefficients with square roots, such as (16 - sqrt(6))/36, read from text and reckoned exactly. Nothing is executed.

sum        [+-] product { +- product }
product    factor { * factor | / factor }
factor     number | sqrt ( sum ) | ( sum )         the root of a sum that is rational
number     7, 0.5, 1e-3                            exact

Such numbers are sums of rationals times roots of products of different primes, as 1/2 + 2 sqrt(2) - sqrt(2 * 3), and so
is whatever follows from them by adding, multiplying and dividing. What must be exactly one is so, therefore: the
rational numbers that stand for the roots come in at the end, each root with the same one everywhere.
"""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from math import prod

from bezstab.errors import InputError, shown
from bezstab.methods.algebraic_numbers import decimal_root
from bezstab.rationals import DECIMAL, LONGEST, rational, within_float64

Primes = frozenset[int]
"""Different primes, for the root of their product; none for a rational number."""

RATIONAL: Primes = frozenset()

SQUARE_ROOT = "sqrt"

LARGEST_ROOT = 10**8  # numerator times denominator of what a root is taken of: so that its primes are found at once
MOST_ROOTS = 16  # in one number: four independent ones in all their products
DEEPEST = 20  # parentheses within each other

WORD = re.compile(rf"\s*(?:(?P<number>{DECIMAL.removeprefix('[-+]?')})|(?P<sign>{SQUARE_ROOT}\b|[-+*/()]))", re.ASCII)
EXPECTED = "a number such as -0.5, 175/108 or (16 - sqrt(6))/36"


@dataclass(frozen=True)
class RootSum:
    """A sum of rational numbers other than 0, each times the root of a product of different primes; empty for zero."""

    terms: Mapping[Primes, Fraction]

    @property
    def irrational(self) -> bool:
        """Whether a root is left in it."""
        return any(primes for primes in self.terms)

    def __add__(self, other: "RootSum") -> "RootSum":
        return _summed([*self.terms.items(), *other.terms.items()])

    def __sub__(self, other: "RootSum") -> "RootSum":
        return self + other.times(Fraction(-1))

    def __mul__(self, other: "RootSum") -> "RootSum":
        # sqrt(2 * 3) sqrt(3 * 5) = 3 sqrt(2 * 5)
        return _summed(
            [
                (first ^ second, a * b * prod(first & second))
                for first, a in self.terms.items()
                for second, b in other.terms.items()
            ]
        )

    def times(self, factor: Fraction) -> "RootSum":
        """Return the sum times a rational number."""
        return _summed([(primes, c * factor) for primes, c in self.terms.items()])

    def inverse(self) -> "RootSum":
        """Return one over the sum; ZeroDivisionError if it is zero.

        With a prime p in one of its roots it is a + b sqrt(p), and in the denominator of

            1 / (a + b sqrt(p)) = (a - b sqrt(p)) / (a^2 - p b^2)

        p is in no root: one prime less.
        """
        p = next((p for primes in self.terms for p in primes), None)
        if p is None:
            return _rational_sum(1 / self.terms.get(RATIONAL, Fraction(0)))
        conjugate = RootSum({primes: -c if p in primes else c for primes, c in self.terms.items()})
        return conjugate * (self * conjugate).inverse()

    def in_decimals(self) -> Fraction:
        """Return the rational number that stands for it: each root is good to 40 decimals."""
        return sum((c * _decimal_square_root(prod(primes)) for primes, c in self.terms.items()), Fraction(0))


def root_sum(text: str) -> RootSum:
    """Return the number that a text says; InputError unless it is one, real, and within float64's range."""
    try:
        value = _Reader(text).whole()
    except ZeroDivisionError:
        raise InputError(f"{shown(text)} divides by zero") from None
    within_float64(value.in_decimals(), shown(text))
    return value


class _Reader:
    """The words of one text, taken from left to right; each method returns what the words ahead say."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.words: list[str] = []
        self.depth = 0
        place, end = 0, len(text.rstrip())
        while place < end <= LONGEST:
            word = WORD.match(text, place)
            if word is None:
                break
            self.words.append(word.group().strip())
            place = word.end()
        if place < end:
            raise self.mistake()

    def mistake(self) -> InputError:
        """Return the error of a text that says no number."""
        return InputError(f"{shown(self.text)}: expected {EXPECTED}")

    def take(self, *words: str) -> str:
        """Return the next word if it is one of these, and go past it; else ''."""
        return self.words.pop(0) if self.words and self.words[0] in words else ""

    def whole(self) -> RootSum:
        """Return the number that all the words say."""
        value = self.sum()
        if self.words:
            raise self.mistake()
        return value

    def sum(self) -> RootSum:
        """Return a sum of products."""
        negative = self.take("+", "-") == "-"
        total = self.product().times(Fraction(-1 if negative else 1))
        while sign := self.take("+", "-"):
            total = total + self.product() if sign == "+" else total - self.product()
        return total

    def product(self) -> RootSum:
        """Return a product of factors, or a quotient, taken from left to right."""
        value = self.factor()
        while sign := self.take("*", "/"):
            factor = self.factor()
            value = value * (factor if sign == "*" else factor.inverse())
        return value

    def factor(self) -> RootSum:
        """Return a number, the root of one, or what parentheses hold."""
        is_root = bool(self.take(SQUARE_ROOT))
        if self.take("("):
            self.depth += 1
            if self.depth > DEEPEST:
                raise InputError(f"{shown(self.text)}: expected at most {DEEPEST} parentheses within each other")
            inner = self.sum()
            if not self.take(")"):
                raise self.mistake()
            self.depth -= 1
            return self.root(inner) if is_root else inner
        if is_root or not self.words or self.words[0][0] not in ".0123456789":
            raise self.mistake()
        return _rational_sum(rational(self.words.pop(0)))

    def root(self, of: RootSum) -> RootSum:
        """Return the root of a rational number: sqrt(n / d) = sqrt(n d) / d."""
        number = of.terms.get(RATIONAL, Fraction(0))
        if of.irrational or number < 0 or number.numerator * number.denominator > LARGEST_ROOT:
            what = f"a fraction p/q from 0, p q at most {LARGEST_ROOT:g}"
            raise InputError(f"{shown(self.text)}: a root is taken of {what}")
        whole, primes = _square_part(number.numerator * number.denominator)
        return _summed([(primes, Fraction(whole, number.denominator))])


def _summed(terms: Iterable[tuple[Primes, Fraction]]) -> RootSum:
    """Return the sum of rational numbers, each times the root of a product of primes."""
    total: dict[Primes, Fraction] = {}
    for primes, c in terms:
        total[primes] = total.get(primes, Fraction(0)) + c
    left = {primes: c for primes, c in total.items() if c}
    if len(left) > MOST_ROOTS:
        raise InputError(f"{len(left)} different roots in one number: expected at most {MOST_ROOTS}")
    return RootSum(left)


def _rational_sum(value: Fraction) -> RootSum:
    return _summed([(RATIONAL, value)])


@cache
def _square_part(number: int) -> tuple[int, Primes]:
    """Return k and different primes whose product is d, of a whole number k^2 d from 0: 72 is 6^2 * 2."""
    if number == 0:
        return 0, RATIONAL
    whole, primes, left, p = 1, set[int](), number, 2
    while p * p <= left:
        if left % (p * p) == 0:
            whole, left = whole * p, left // (p * p)
        elif left % p == 0:
            primes.add(p)
            left //= p
        else:
            p += 1
    return whole, frozenset(primes | {left} - {1})


@cache
def _decimal_square_root(number: int) -> Fraction:
    """Return the root of a whole number from 1, to 40 decimals; that of 1 exactly."""
    return decimal_root(lambda x: x * x - number, Fraction(0), Fraction(number + 1))
