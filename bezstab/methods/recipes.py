"""Numbers such as (16 - sqrt(6))/36, and equations such as x1 = x0 + v0 + 1/2 a0, read from text. Nothing is executed.

equation   quantity = sum   |   quantity = acceleration ( sum , sum )
sum        [+-] product { +- product }
product    factor { [*] factor | / factor }              without * only before a quantity, a root or a parenthesis
factor     number | sqrt ( sum ) | ( sum ) | quantity    the root of a sum that is rational
number     7, 0.5, 1e-3
quantity   x1, v0, a[-1]                                 position, velocity, acceleration at a numbered step
           vh, vh[0]                                     a helper, of this step and of the one before

Each sum is one of sympy's, exact: what must be exactly one is so. The rational numbers that stand for the roots come in
at the end, each root with the same one everywhere.
"""

import re
from collections.abc import Mapping
from fractions import Fraction

import sympy as sp

from bezstab.errors import InputError, shown
from bezstab.methods.algebraic_numbers import decimal_root
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import (
    ACCELERATION,
    POSITION,
    VELOCITY,
    Assignment,
    Combination,
    Equation,
    Evaluation,
    Quantity,
)
from bezstab.rationals import ZERO, rational, within_float64

NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,4})?"
NAME = r"[A-Za-z_]\w*(?:\[\s*-?\d{1,3}\s*\])?"
WORD = re.compile(rf"{NUMBER}|{NAME}|[-+*/(),]", re.ASCII)
QUANTITY = re.compile(r"([A-Za-z_]\w*?)(\d+)?(?:\[(.+)\])?", re.ASCII)
FUNCTION = "acceleration"
SQUARE_ROOT = "sqrt"

MOST_EQUATIONS = 60  # some 20 stages
LONGEST = 2000  # characters of one text
LONGEST_NAME = 30  # characters of a quantity's name
DEEPEST = 20  # parentheses within each other
LARGEST_ROOT = 10**8  # numerator times denominator of what a root is taken of: so that its squares are found at once
MOST_ROOTS = 4  # terms of a divisor: sympy takes the roots of no more out of it
MOST_PRODUCTS = 1000  # that two sums are multiplied out to


def exact_number(text: str) -> Fraction:
    """Return the number that a text says, roots good to 40 decimals.

    InputError unless it is one, real, and within float64's range.
    """
    reader = _Reader(text)
    value = reader.sum()
    if reader.words or reader.quantities:
        raise InputError(f"{shown(text)}: expected a number such as -0.5, 175/108 or (16 - sqrt(6))/36")
    return within_float64(_in_decimals(value), shown(text))


def recipe(equations: Mapping[str, str]) -> SecondOrder:
    """Return the scheme of equations given as text, result by right-hand side; h = 1.

    InputError, naming the equation and the word, for what is not linear, and what `SecondOrder` and its `check_motion`
    refuse.
    """
    if len(equations) > MOST_EQUATIONS:
        raise InputError(f"{len(equations)} equations: expected at most {MOST_EQUATIONS}")
    scheme = SecondOrder(tuple(_equation(result, text) for result, text in equations.items()))
    scheme.check_motion()
    return scheme


def _equation(result: str, text: str) -> Equation:
    try:
        left = _Reader(result)
        quantity = left.quantity()
        left.expect_end()
        right = _Reader(text)
        if right.take(FUNCTION):
            right.expect("(")
            position = right.combination()
            right.expect(",")
            velocity = right.combination()
            right.expect(")")
            right.expect_end()
            return Evaluation(quantity, position, velocity)
        value = right.combination()
        right.expect_end()
        return Assignment(quantity, value)
    except InputError as error:
        raise InputError(f"{shown(result)} = {error}") from None


class _Reader:
    """The words of one text, taken from left to right; each method returns what the words ahead say."""

    def __init__(self, text: str) -> None:
        if len(text) > LONGEST:
            raise InputError(f"{shown(text)}: {len(text)} characters, expected at most {LONGEST}")
        self.text = text
        self.words = WORD.findall(text)
        self.quantities: dict[sp.Symbol, Quantity] = {}
        self.depth = 0
        if re.sub(r"\s", "", "".join(self.words)) != re.sub(r"\s", "", text):
            raise InputError(f"{shown(text)}: expected numbers, names, + - * / and parentheses")

    def mistake(self, expected: str) -> InputError:
        """Return the error that something else was expected than the next word."""
        found = shown(self.words[0]) if self.words else "the end"
        return InputError(f"{shown(self.text)}: found {found}, expected {expected}")

    def take(self, *words: str) -> str:
        """Return the next word if it is one of these, and go past it; else ''."""
        return self.words.pop(0) if self.words and self.words[0] in words else ""

    def expect(self, word: str) -> None:
        """Go past a word that must be there."""
        if not self.take(word):
            raise self.mistake(repr(word))

    def expect_end(self) -> None:
        """Refuse what stands after the end."""
        if self.words:
            raise self.mistake("+, - or the end")

    def combination(self) -> Combination:
        """Return a sum of numbers times quantities; none is zero."""
        value = sp.expand(self.sum())
        coefficients: dict[sp.Symbol, sp.Expr] = {}
        for term in sp.Add.make_args(value) if value else ():
            symbol = next(iter(term.free_symbols), sp.S.One)
            number = term / symbol
            if symbol == 1 or number.free_symbols:
                raise InputError(f"{shown(self.text)}: expected a sum of numbers times quantities")
            coefficients[symbol] = coefficients.get(symbol, 0) + number
        return tuple(
            (_in_decimals(coefficients[symbol]), quantity)
            for symbol, quantity in self.quantities.items()
            if symbol in coefficients
        )

    def sum(self) -> sp.Expr:
        """Return a sum of products."""
        products = [-self.product() if self.take("+", "-") == "-" else self.product()]
        while sign := self.take("+", "-"):
            products.append(self.product() if sign == "+" else -self.product())
        return sp.Add(*products)  # at once: one after another, sums of a hundred would take seconds

    def product(self) -> sp.Expr:
        """Return a product of factors, or a quotient, taken from left to right, multiplied out."""
        value = self.factor()
        while True:
            if self.take("/"):
                factor = self.inverse(self.factor())
            elif self.take("*") or (self.words and re.match(r"[A-Za-z_(]", self.words[0])):
                factor = self.factor()
            else:
                return value
            if len(sp.Add.make_args(value)) * len(sp.Add.make_args(factor)) > MOST_PRODUCTS:
                raise InputError(f"{shown(self.text)}: expected products of fewer sums")
            value = sp.expand(value * factor)

    def factor(self) -> sp.Expr:
        """Return a number, the root of one, what parentheses hold, or a quantity."""
        is_root = self.take(SQUARE_ROOT)
        if is_root or self.words[:1] == ["("]:
            self.expect("(")
            self.depth += 1
            if self.depth > DEEPEST:
                raise InputError(f"{shown(self.text)}: expected at most {DEEPEST} parentheses within each other")
            inner = self.sum()
            self.expect(")")
            self.depth -= 1
            return self.root(inner) if is_root else inner
        if self.words and re.fullmatch(NUMBER, self.words[0]):
            return sp.Rational(rational(self.words.pop(0)))
        quantity = self.quantity()
        symbol = sp.Symbol(str(quantity))
        self.quantities[symbol] = quantity
        return symbol

    def root(self, of: sp.Expr) -> sp.Expr:
        """Return the root of a rational number."""
        if not of.is_Rational or of < 0 or of.p * of.q > LARGEST_ROOT:
            what = f"a fraction p/q from 0, p q at most {LARGEST_ROOT:g}"
            raise InputError(f"{shown(self.text)}: a root is taken of {what}")
        return sp.sqrt(of)

    def inverse(self, of: sp.Expr) -> sp.Expr:
        """Return one over a number, its roots in the numerator."""
        if of == 0 or of.free_symbols or len(sp.Add.make_args(of)) > MOST_ROOTS:
            what = f"a number other than 0, of at most {MOST_ROOTS} terms"
            raise InputError(f"{shown(self.text)}: expected to divide by {what}")
        return sp.expand(sp.radsimp(1 / of, max_terms=MOST_ROOTS))

    def quantity(self) -> Quantity:
        """Return the quantity that the next word names."""
        word = self.words[0] if self.words else ""
        named = QUANTITY.fullmatch(word)
        if named is None or word in (FUNCTION, SQUARE_ROOT):
            raise self.mistake("a quantity such as x0, v1 or a helper's name")
        name, number, index = named.groups()
        if name in (POSITION, VELOCITY, ACCELERATION):
            if (number is None) == (index is None):
                raise self.mistake(f"one step with it, such as {name}0, {name}1 or {name}[-1]")
        else:
            name, number = f"{name}{number or ''}", "1"
        if len(self.words.pop(0)) > LONGEST_NAME:
            raise InputError(f"{shown(self.text)}: expected names of at most {LONGEST_NAME} characters")
        return Quantity(name, int(index or number))


def _in_decimals(number: sp.Expr) -> Fraction:
    """Return the rational number that stands for a sum of roots: each is good to 40 decimals."""
    value = number.xreplace({root: sp.Rational(_decimal_root(int(root.base))) for root in number.atoms(sp.Pow)})
    return Fraction(int(value.p), int(value.q))


def _decimal_root(number: int) -> Fraction:
    """Return the root of a whole number, to 40 decimals."""
    return decimal_root(lambda x: x * x - number, ZERO, Fraction(number))
