"""Determinants of matrices of polynomials, against sympy's, and the bound on their work."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.polys.matrices import DomainMatrix

from bezstab.errors import InputError
from bezstab.methods.plane_polynomials import (
    MOST_PRODUCTS,
    MOST_TOGETHER,
    Matrix,
    Terms,
    Work,
    determinant,
    product,
    total,
)
from tests.reference.rationals import rationals

F = Fraction

TERMS = st.dictionaries(
    st.tuples(st.integers(-2, 2), st.integers(0, 1), st.integers(0, 1)),
    rationals(-3, 3, max_denominator=4).filter(bool),
    max_size=2,
)
MATRICES = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(TERMS, min_size=n, max_size=n), min_size=n, max_size=n)
)


def value(terms: Terms, point: tuple[Fraction, Fraction, Fraction]) -> Fraction:
    z, a, b = point
    return sum((c * z**k * a**i * b**j for (k, i, j), c in terms.items()), F(0))


POINTS = [(F(2), F(3), F(5)), (F(-1, 2), F(7), F(1, 3)), (F(3, 2), F(-2, 5), F(-11))]


def assert_is_determinant(found: Terms, rows: Matrix) -> None:
    """Compare with the determinant of numbers at three points."""
    for point in POINTS:
        numbers = [[sp.QQ(*value(terms, point).as_integer_ratio()) for terms in row] for row in rows]
        expected = DomainMatrix(numbers, (len(rows), len(rows)), sp.QQ).det()
        assert sp.QQ(*value(found, point).as_integer_ratio()) == expected


@settings(deadline=None, max_examples=30)
@given(MATRICES)
def test_a_determinant_has_the_values_of_those_of_numbers(rows: Matrix) -> None:
    assert_is_determinant(determinant(rows), rows)


@settings(deadline=None, max_examples=30)
@given(MATRICES)
def test_a_matrix_with_simple_rows_is_eliminated_to_the_same_determinant(rows: Matrix) -> None:
    for number, row in enumerate(rows):
        row[number] = {(number, 0, 0): F(2)}
    assert_is_determinant(determinant(rows), rows)


@settings(deadline=None, max_examples=30)
@given(TERMS, TERMS)
def test_sums_and_products_are_those_of_polynomials(first: Terms, second: Terms) -> None:
    for point in POINTS:
        one, other = value(first, point), value(second, point)
        assert value(total(first, second), point) == one + other
        assert value(product(first, second, Work()), point) == one * other
    assert all(total(first, second).values())


def test_a_singular_matrix_has_the_determinant_without_terms() -> None:
    one: Terms = {(0, 0, 0): F(1)}
    z: Terms = {(1, 0, 0): F(1)}
    assert determinant([[one, one], [one, one]]) == {}
    assert determinant([[{}, z], [{}, one]]) == {}
    assert determinant([]) == one


def test_the_sign_follows_the_permutation() -> None:
    one: Terms = {(0, 0, 0): F(1)}
    assert determinant([[{}, one], [one, {}]]) == {(0, 0, 0): -1}
    assert determinant([[{}, one, {}], [{}, {}, one], [one, {}, {}]]) == one


def test_too_many_rows_that_wait_for_each_other_are_refused() -> None:
    n = MOST_TOGETHER + 1
    full: Matrix = [[{(0, 0, 0): F(i * j + 1), (0, 1, 0): F(1)} for j in range(n)] for i in range(n)]
    with pytest.raises(InputError, match=f"{n} equations wait for each other: expected at most {MOST_TOGETHER}"):
        determinant(full)


def test_work_is_bounded() -> None:
    long: Terms = {(k, i, 0): F(1) for k in range(100) for i in range(30)}
    work = Work()
    with pytest.raises(InputError, match="too long for their determinant"):
        product(long, long, work)
    assert len(long) ** 2 > MOST_PRODUCTS
