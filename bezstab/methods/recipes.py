"""Second-order schemes as text: `x1 = "x0 + v0 + 1/2 a0"`, a linear grammar of sums. Nothing is executed.

equation       quantity = sum   |   quantity = acceleration(sum, sum)
sum            [+-] product { +- product }
product        [numbers [*]] quantity   |   [numbers [*]] ( sum )   |   quantity / number
numbers        number { * number | / number }
number         1/2, 0.5, 3, sqrt(2)                    exact, square roots to 40 digits
quantity       x1, v0, a[-1]                           position, velocity, acceleration at a numbered step
               vh, vh[0]                               a helper, of this step and of the one before
"""

import re
from collections.abc import Mapping
from typing import NoReturn

from bezstab.errors import InputError
from bezstab.methods.second_order import MOST_EQUATIONS, SecondOrder
from bezstab.methods.square_roots import SQUARE_ROOT, RootSum, root_sum
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

PLAIN_NUMBER = r"\d+(?:\.\d*)?(?:/\d+)?"
NUMBER = rf"(?P<number>{PLAIN_NUMBER}|{SQUARE_ROOT}\s*\(\s*{PLAIN_NUMBER}\s*\))"
NAME = r"(?P<name>[A-Za-z_]\w*)(?P<index>\[\s*-?\d{1,3}\s*\])?"
SIGN = r"(?P<sign>[-+*/(),])"
EXPONENT = re.compile(r"\s*\d+(?:\.\d*)?[eE][-+]?\d+", re.ASCII)
TOKEN = re.compile(rf"\s*(?:{NUMBER}|{NAME}|{SIGN})", re.ASCII)
NUMBERED = re.compile(rf"([{POSITION}{VELOCITY}{ACCELERATION}])(\d+)", re.ASCII)
PLAIN = re.compile(r"\w+(?:\[-?\d+\])?", re.ASCII)  # what is shown as it is of a result
FUNCTION = "acceleration"
LONGEST = 2000  # characters of one equation
LONGEST_NAME = 30  # characters of a quantity's name
SHOWN = 40  # characters shown of what was given
DEEPEST = 20  # parentheses within each other
PLUS_ONE, MINUS_ONE, NOTHING = root_sum("1"), root_sum("-1"), root_sum("0")


def recipe(equations: Mapping[str, str]) -> SecondOrder:
    """Return the scheme of equations given as text, result by right-hand side; h = 1.

    InputError, naming the equation and the word, for what is not linear, and what `SecondOrder` refuses.
    """
    if len(equations) > MOST_EQUATIONS:
        raise InputError(f"{len(equations)} equations: expected at most {MOST_EQUATIONS}")
    return SecondOrder(tuple(_equation(result, text) for result, text in equations.items()))


def _equation(result: str, text: str) -> Equation:
    left = _Reader(result, result)
    quantity = left.quantity()
    left.expect_end()
    right = _Reader(result, text)
    if right.take(FUNCTION):
        right.expect("(")
        position = right.sum()
        right.expect(",")
        velocity = right.sum()
        right.expect(")")
        right.expect_end()
        return Evaluation(quantity, position, velocity)
    value = right.sum()
    right.expect_end()
    return Assignment(quantity, value)


class _Reader:
    """The words of one text, read from left to right."""

    def __init__(self, result: str, text: str) -> None:
        self.result = result
        self.words: list[re.Match[str]] = []
        self.place = 0
        self.depth = 0
        if len(text) > LONGEST:
            raise InputError(f"{self._equation()}: {len(text)} characters, expected at most {LONGEST}")
        end = len(text.rstrip())
        position = 0
        while position < end:
            exponent = EXPONENT.match(text, position)
            if exponent:
                self._refuse(repr(exponent.group().strip()[:SHOWN]), "a number like 1/2 or 0.5, without exponent")
            word = TOKEN.match(text, position)
            if word is None:
                self._refuse(repr(text[position:].strip()[0]), "a sum of numbers times quantities")
            self.words.append(word)
            position = word.end()

    def _equation(self) -> str:
        """Return how the equation is called in messages: one short line, whatever stands on its left."""
        plain = PLAIN.fullmatch(self.result) and len(self.result) <= SHOWN
        return f"{self.result if plain else repr(self.result[:SHOWN])} = ..."

    def _refuse(self, found: str, expected: str) -> NoReturn:
        raise InputError(f"{self._equation()}: found {found}, expected {expected}")

    def _next(self) -> str:
        """Return the next word, '' at the end."""
        return self.words[self.place].group().strip() if self.place < len(self.words) else ""

    def _shown(self) -> str:
        return repr(self._next()[:SHOWN]) if self._next() else "the end"

    def take(self, word: str) -> bool:
        """Return whether the next word is this one, and go past it if so."""
        if self._next() != word:
            return False
        self.place += 1
        return True

    def expect(self, word: str) -> None:
        """Go past a word that must be there."""
        if not self.take(word):
            self._refuse(self._shown(), repr(word))

    def expect_end(self) -> None:
        """Refuse what stands after the end."""
        if self._next():
            self._refuse(self._shown(), "+, - or the end")

    def sum(self) -> Combination:
        """Return a sum of products, equal quantities added up."""
        return tuple((number.in_decimals(), quantity) for quantity, number in self._terms().items())

    def _terms(self) -> dict[Quantity, RootSum]:
        """Return the numbers of a sum by their quantities; none is zero."""
        total: dict[Quantity, RootSum] = {}
        sign = MINUS_ONE if self.take("-") else PLUS_ONE
        if sign == PLUS_ONE:
            self.take("+")
        while True:
            for quantity, number in self.product().items():
                total[quantity] = total.get(quantity, NOTHING) + sign * number
            if self.take("+"):
                sign = PLUS_ONE
            elif self.take("-"):
                sign = MINUS_ONE
            else:
                return {quantity: number for quantity, number in total.items() if number != NOTHING}

    def product(self) -> dict[Quantity, RootSum]:
        """Return numbers times a quantity or times a sum in parentheses."""
        factor = self._numbers() if self._is_number() else PLUS_ONE
        if self.take("("):
            self.depth += 1
            if self.depth > DEEPEST:
                self._refuse("'('", f"at most {DEEPEST} parentheses within each other")
            inner = self._terms()
            self.expect(")")
            self.depth -= 1
        else:
            inner = {self.quantity(): PLUS_ONE}
        while self.take("/"):
            factor = factor * self._divisor()
        return {quantity: factor * number for quantity, number in inner.items()}

    def _numbers(self) -> RootSum:
        """Return the product of numbers that the next words are, and go past the * after it."""
        value = self._number()
        while True:
            if self.take("/"):
                value = value * self._divisor()
            elif self.take("*") and self._is_number():
                value = value * self._number()
            else:
                return value

    def _divisor(self) -> RootSum:
        """Return one over the number that the next word is."""
        shown = self._shown()
        divisor = self._number() if self._is_number() else NOTHING
        if divisor == NOTHING:
            self._refuse(shown, "a number other than 0 to divide by")
        return divisor.inverse()

    def _is_number(self) -> bool:
        return self.place < len(self.words) and self.words[self.place].group("number") is not None

    def _number(self) -> RootSum:
        """Return the number that the next word is, and go past it."""
        try:
            value = root_sum(self._next())
        except InputError:
            self._refuse(self._shown(), "a number like 1/2 or 0.5")
        self.place += 1
        return value

    def quantity(self) -> Quantity:
        """Return the quantity that the next word names."""
        word = self.words[self.place] if self.place < len(self.words) else None
        if word is None or not word.group("name"):
            self._refuse(self._shown(), "a quantity such as x0, v1 or a helper's name")
        name, index = word.group("name"), word.group("index")
        if len(name) > LONGEST_NAME:
            self._refuse(self._shown(), f"a name of at most {LONGEST_NAME} characters")
        self.place += 1
        numbered = NUMBERED.fullmatch(name)
        if name == FUNCTION:
            self._refuse(f"{FUNCTION!r}", f"a sum: {FUNCTION}(position, velocity) stands alone on the right")
        if numbered and index is None:
            return Quantity(numbered.group(1), int(numbered.group(2)))
        if name in (POSITION, VELOCITY, ACCELERATION):
            if index is None:
                self._refuse(f"{name!r}", f"a step with it, such as {name}0, {name}1 or {name}[-1]")
            return Quantity(name, int(index[1:-1]))
        if numbered:
            self._refuse(f"{word.group().strip()!r}", f"{numbered.group(1)}{index}")
        return Quantity(name, 1 if index is None else int(index[1:-1]))
