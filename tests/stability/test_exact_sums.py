import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.stability.exact_sums import feedback_roots


@given(st.floats(1e-6, 1e6), st.floats(-1e-12, 1e-12))
@settings(deadline=None)
def test_next_to_the_parabola_both_mu_keep_their_digits(alpha_hat: float, off: float) -> None:
    beta_hat = alpha_hat**2 / 4 * (1 + off)
    found = feedback_roots(np.array([alpha_hat]), np.array([beta_hat]))
    with mpmath.workdps(50):
        p, q = mpmath.mpf(alpha_hat), mpmath.mpf(beta_hat)
        root = mpmath.sqrt(p * p / 4 - q)
        for mu in found:
            error = min(abs(mu[0] - (-p / 2 + sign * root)) for sign in (1, -1))
            assert error <= 4 * 2.0**-52 * alpha_hat


@pytest.mark.parametrize("point", [(1e300, 1e300), (3e307, -1e305), (1e290, 1e307), (-2e281, 4e280), (1e-300, -1e300)])
def test_beyond_1e280_the_roots_are_as_exact_as_elsewhere(point: tuple[float, float]) -> None:
    found = feedback_roots(np.array(point[:1]), np.array(point[1:]))
    with mpmath.workdps(700):
        half, q = mpmath.mpf(point[0]) / 2, mpmath.mpf(point[1])
        root = mpmath.sqrt(half * half - q)
        for mu, other in zip(found, found[::-1], strict=True):
            errors = [abs(mu[0] - exact) / abs(exact) for exact in (-half + root, -half - root)]
            assert min(errors) <= 4 * 2.0**-52
            assert mu[0] != other[0]
