"""Determinants of matrices of polynomials, against those of numbers at single points."""

from fractions import Fraction

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement

from bezstab.methods.determinants import RING, Matrix, determinant, in_field
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


@settings(deadline=None, max_examples=40)
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
