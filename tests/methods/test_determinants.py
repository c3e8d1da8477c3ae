"""Determinants of matrices of polynomials, against those of numbers at single points."""

from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement

from bezstab.errors import InputError
from bezstab.methods.determinants import MOST_TOGETHER, RING, RING_ALPHA, Matrix, characteristic, determinant, in_field
from tests.reference.rationals import rationals

F = Fraction


def polynomial(terms: dict[tuple[int, int, int], Fraction]) -> PolyElement:
    return RING.from_dict({powers: in_field(c) for powers, c in terms.items()})


POLYNOMIALS = st.dictionaries(
    st.tuples(st.integers(0, 3), st.integers(0, 1), st.integers(0, 1)),
    rationals(-3, 3, max_denominator=4).filter(bool),
    max_size=2,
).map(polynomial)
MATRICES = st.integers(1, 4).flatmap(
    lambda n: st.lists(st.lists(POLYNOMIALS, min_size=n, max_size=n), min_size=n, max_size=n)
)
POINTS = [(F(2), F(3), F(5)), (F(-1, 2), F(7), F(1, 3)), (F(3, 2), F(-2, 5), F(-11))]


@settings(deadline=None, max_examples=60)
@given(MATRICES, st.booleans())
def test_a_determinant_has_the_values_of_those_of_numbers(rows: Matrix, simple: bool) -> None:
    """Whether or not there are numbers times powers of z on the diagonal, whose rows are eliminated."""
    if simple:
        for number, row in enumerate(rows):
            row[number] = polynomial({(number, 0, 0): F(2)})
    found = determinant(rows)
    for point in POINTS:
        at_point = [in_field(x) for x in point]
        numbers = [[entry.evaluate(list(zip(RING.gens, at_point, strict=True))) for entry in row] for row in rows]
        expected = DomainMatrix(numbers, (len(rows), len(rows)), sp.QQ).det()
        assert found.evaluate(list(zip(RING.gens, at_point, strict=True))) == expected


def test_a_singular_matrix_has_the_determinant_zero() -> None:
    assert determinant([[RING.one, RING.one], [RING.one, RING.one]]) == 0
    assert determinant([]) == 1


def test_too_many_rows_that_wait_for_each_other_are_refused() -> None:
    n = MOST_TOGETHER + 1
    full = [[RING_ALPHA + i * j for j in range(n)] for i in range(n)]
    with pytest.raises(InputError, match=f"{n} equations wait for each other: expected at most {MOST_TOGETHER}"):
        determinant(full)


def test_the_characteristic_polynomial_of_a_companion_matrix() -> None:
    assert characteristic([[F(1, 2), F(-1, 3)], [F(1), F(0)]]) == [1, F(-1, 2), F(1, 3)]
