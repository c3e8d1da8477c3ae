"""alpha, beta and h against alpha_hat and beta_hat: paper Eqs 6 and 16, both ways."""

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.units import (
    alpha_and_beta,
    feedback_gains,
    from_dimensionless,
    from_feedback_gains,
    to_dimensionless,
)

positive = st.builds(Fraction, st.integers(1, 10**6), st.integers(1, 10**6))
anything = st.builds(Fraction, st.integers(-(10**6), 10**6), st.integers(1, 10**6))


@given(positive, positive, positive)
def test_paper_equation_16(alpha: Fraction, beta: Fraction, h: Fraction) -> None:
    assert to_dimensionless(alpha, beta, h) == (2 * alpha * h, beta**2 * h**2)


@given(anything, anything, positive)
def test_exact_gains_come_back_exactly(alpha_hat: Fraction, beta_hat: Fraction, h: Fraction) -> None:
    assert from_feedback_gains(*feedback_gains(alpha_hat, beta_hat, h), h) == (alpha_hat, beta_hat)


@pytest.mark.parametrize("beta_hat", [-0.1, -1e-300, math.nan])
def test_a_negative_beta_hat_has_gains_but_no_beta(beta_hat: float) -> None:
    with pytest.raises(InputError, match="expected 0 or more"):
        from_dimensionless(np.array([0.5, 0.5]), np.array([0.1, beta_hat]), 0.01)
    assert feedback_gains(0.5, -0.25, 0.5) == (1.0, -1.0)


def test_alpha_and_beta_of_one_point_are_what_was_typed() -> None:
    exactly = to_dimensionless(Fraction(1, 3), Fraction(30), Fraction(1, 240))
    assert alpha_and_beta(*exactly, Fraction(1, 240)) == (1 / 3, 30)
    for back in (alpha_and_beta, from_dimensionless):
        assert back(float(exactly[0]), float(exactly[1]), 1 / 240) == pytest.approx((1 / 3, 30), rel=1e-15)
    assert alpha_and_beta(0.1, -0.1, 0.002)[1] is None
