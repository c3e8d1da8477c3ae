"""Numbers such as (16 - sqrt(6))/36, and equations such as x1 = x0 + v0 + 1/2 a0, read from text. Nothing is executed.

A text is an expression of Python's, which parses it, of these words only:

    number          7, 0.5, 1e-3
    quantity        x1, v0, a[-1]      position, velocity, acceleration at a numbered step
                    vh, vh[0]          a helper, of this step and of the one before
    + - * / ( )     1/2 a0 and 2 (x1 - x0) are products, too
    sqrt            of a fraction
    acceleration    of two sums: alone on the right of an equation

A text's value is a sum of numbers times quantities, and each number one of sympy's, exact: what must be exactly one is
so. The rational numbers that stand for the roots come in at the end, each root with the same one everywhere.
"""

import ast
import re
from collections.abc import Mapping
from fractions import Fraction

import sympy as sp

from bezstab.errors import InputError, shown
from bezstab.methods.algebraic_numbers import decimal_root
from bezstab.methods.orders import defect, left_over
from bezstab.methods.polynomials import divided
from bezstab.methods.schur import recursion_verdict
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import STATE, Assignment, Combination, Equation, Evaluation, Quantity
from bezstab.rationals import ONE, ZERO, rational, within_float64

NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,4})?"
NAME = r"[A-Za-z_]\w*(?:\[\s*-?\d{1,2}\s*\])?"
WORD = re.compile(rf"({NUMBER})|({NAME})|([-+*/(),])", re.ASCII)
QUANTITY = re.compile(r"([A-Za-z_]\w*?)(\d+)?(?:\[\s*(-?\d{1,2})\s*\])?", re.ASCII)
FUNCTIONS = "acceleration", "sqrt"
EXPECTED = "expected a number such as (16 - sqrt(6))/36 or, in an equation, a sum such as x0 + 1/2 (v0 - a[-1])"

MOST_EQUATIONS = 60  # some 20 stages
LONGEST = 2000  # characters of one text
LONGEST_NAME = 30  # characters of a quantity's name
LARGEST_ROOT = 10**8  # numerator times denominator of what a root is taken of: so that its squares are found at once
MOST_TERMS = 40  # of a number, one for each root

Sum = dict[Quantity | None, sp.Expr]
"""Numbers by what they multiply; None for one that stands alone."""


def exact_number(text: str) -> Fraction:
    """Return the number that a text says, roots good to 40 decimals.

    InputError unless it is one, real, and within float64's range.
    """
    try:
        value = _number(_parsed(text))
    except InputError as error:
        raise InputError(f"{shown(text)}: {error}") from None
    return within_float64(_in_decimals(value), shown(text))


def recipe(equations: Mapping[str, str]) -> SecondOrder:
    """Return the scheme of equations given as text, result by right-hand side; h = 1.

    InputError, naming the equation, for what is not linear, and what `SecondOrder` and `check_motion` refuse.
    """
    if len(equations) > MOST_EQUATIONS:
        raise InputError(f"{len(equations)} equations: expected at most {MOST_EQUATIONS}")
    scheme = SecondOrder(tuple(_equation(result, text) for result, text in equations.items()))
    check_motion(scheme)
    return scheme


def check_motion(scheme: SecondOrder) -> None:
    """Raise InputError unless the equations determine x1 and v1, and are consistent and zero-stable.

    Consistent: a free motion x0 + v0 t is followed exactly and an acceleration acts in full. Zero-stable: without
    feedback z = 1 is a double root, all others lie inside the unit circle or are simple on it.
    """
    free = scheme.table[:, :1, :1].ravel().tolist()
    if not free or not free[-1]:  # else without feedback, or with little, a step has no solution or many
        raise InputError("the equations do not determine x1 and v1")
    reduced, rest = divided(free, (ONE, Fraction(-2), ONE))
    if any(rest) or not any(reduced):
        raise InputError("inconsistent: a free motion x0 + v0 t is not followed exactly")
    if any(any(defect(scheme.table, degree)) for degree in (1, 2)):
        raise InputError("inconsistent: an acceleration does not act in full, or feedback not as feedback")
    if sum(reduced) == 0 or recursion_verdict(reduced) == "diverges":
        raise InputError("zero-unstable: without feedback a root lies outside the unit circle, or repeats on it")
    if any(any(of_velocity) for power in (0, 1) for _, of_velocity in [left_over(scheme, power)]):
        raise InputError("inconsistent: v1 is not the velocity of x1")


def _equation(result: str, text: str) -> Equation:
    try:
        quantity = _quantity(result.strip())
        match _parsed(text):
            case ast.Call(ast.Name("acceleration"), [position, velocity]):
                return Evaluation(quantity, _combination(position), _combination(velocity))
            case value:
                return Assignment(quantity, _combination(value))
    except InputError as error:
        raise InputError(f"{shown(result)} = {shown(text)}: {error}") from None


def _parsed(text: str) -> ast.expr:
    """Return the tree of a text, its numbers as strings, each product with a *, - as a sign alone."""
    if len(text) > LONGEST:
        raise InputError(f"{len(text)} characters, expected at most {LONGEST}")
    if re.sub(rf"{WORD.pattern}|\s", "", text, flags=re.ASCII):
        raise InputError("expected numbers, names, + - * / and parentheses")
    code, before = "", "+"
    for number, name, mark in WORD.findall(text):
        times = "*" if (name or mark == "(") and before not in "+-*/(," else " "
        code += times + (f"({number!r})" if number else name or mark.replace("-", "+-"))
        before = "+" if name in FUNCTIONS else name or number or mark
    try:
        return ast.parse(code.strip(), mode="eval").body
    except (SyntaxError, RecursionError, MemoryError):
        raise InputError(EXPECTED) from None


def _combination(tree: ast.expr) -> Combination:
    """Return a sum of numbers times quantities; none is zero."""
    terms = {quantity: number for quantity, number in _sum(tree).items() if number != 0}
    if None in terms:
        raise InputError(EXPECTED)
    return tuple((_in_decimals(number), quantity) for quantity, number in terms.items() if quantity)


def _number(tree: ast.expr) -> sp.Expr:
    terms = _sum(tree)
    if terms.keys() != {None}:
        raise InputError(EXPECTED)
    return terms[None]


def _sum(tree: ast.expr) -> Sum:
    """Return the value of a tree."""
    total: Sum
    match tree:
        case ast.Constant(str(number)):
            total = {None: sp.Rational(rational(number))}
        case ast.Name() | ast.Subscript():
            total = {_quantity(ast.unparse(tree)): sp.S.One}
        case ast.Call(ast.Name("sqrt"), [of]):
            total = {None: _root(_number(of))}
        case ast.UnaryOp(ast.UAdd(), operand):
            total = _sum(operand)
        case ast.UnaryOp(ast.USub(), operand):
            total = _times(_sum(operand), sp.S.NegativeOne)
        case ast.BinOp(left, ast.Add(), right):
            total = _sum(left)
            for quantity, number in _sum(right).items():
                total[quantity] = total.get(quantity, sp.S.Zero) + number
        case ast.BinOp(left, ast.Mult(), right):
            total, other = _sum(left), _sum(right)
            total = _times(other, total[None]) if total.keys() == {None} else _times(total, _number(right))
        case ast.BinOp(left, ast.Div(), right):
            divisor = _number(right)
            if not divisor.is_Rational or divisor == 0:
                raise InputError("expected to divide by a fraction other than 0, as in sqrt(2)/2")
            total = _times(_sum(left), 1 / divisor)
        case _:
            raise InputError(EXPECTED)
    return total


def _times(terms: Sum, factor: sp.Expr) -> Sum:
    products = {quantity: sp.expand(number * factor) for quantity, number in terms.items()}
    if any(len(number.args) > MOST_TERMS for number in products.values()):
        raise InputError(f"expected numbers of at most {MOST_TERMS} roots")
    return products


def _root(of: sp.Expr) -> sp.Expr:
    if not of.is_Rational or of < 0 or of.p * of.q > LARGEST_ROOT:
        raise InputError(f"a root is taken of a fraction p/q from 0, p q at most {LARGEST_ROOT:g}")
    return sp.sqrt(of)


def _quantity(word: str) -> Quantity:
    """Return the quantity that a word names."""
    named = QUANTITY.fullmatch(word)
    if not named or word in FUNCTIONS or len(word) > LONGEST_NAME:
        raise InputError(f"{shown(word)}: expected a quantity such as x0, v1 or a helper's name")
    name, number, index = named.groups()
    if name not in STATE:
        return Quantity(f"{name}{number or ''}", int(index or 1))
    if (number is None) == (index is None):
        raise InputError(f"{shown(word)}: expected one step with it, such as {name}0, {name}1 or {name}[-1]")
    return Quantity(name, int(index or number))


def _in_decimals(number: sp.Expr) -> Fraction:
    """Return the rational number that stands for a sum of roots: each is good to 40 decimals."""
    roots = number.atoms(sp.Pow)
    return Fraction(str(number.xreplace({root: sp.Rational(_decimal_root(int(root.base))) for root in roots})))


def _decimal_root(number: int) -> Fraction:
    return decimal_root(lambda x: x * x - number, ZERO, Fraction(number))
