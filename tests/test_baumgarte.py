from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from bezstab.baumgarte import dimensionless, gains

positive = st.fractions(Fraction(1, 10**6), 10**6)


@given(positive, positive, positive)
def test_paper_equation_16(alpha: Fraction, beta: Fraction, h: Fraction) -> None:
    assert dimensionless(alpha, beta, h) == (2 * alpha * h, beta**2 * h**2)


def test_gains_are_the_coefficients_of_equation_6() -> None:
    assert gains(0.5, 0.25, 0.5) == (1.0, 1.0)


def test_the_taylor_rule_is_the_point_two_two() -> None:
    h = Fraction(1, 1000)
    assert dimensionless(1 / h, Fraction(0), h)[0] == 2
    assert round(float(dimensionless(1 / h, Fraction(2**0.5) / h, h)[1]), 12) == 2
