from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from bezstab.step_sequences.positive_polynomials import positivity

ZERO, ONE, THIRD = Fraction(0), Fraction(1), Fraction(1, 3)


@given(st.lists(st.integers(-9, 9), min_size=1, max_size=5))
def test_it_is_what_values_say(polynomial: list[int]) -> None:
    """A polynomial of small whole numbers that is not positive is so at one of many places, or nearly."""
    found = positivity([list(map(Fraction, polynomial))], ZERO, ONE)
    least = np.polynomial.Polynomial(polynomial)(np.linspace(0, 1, 2001)).min()
    assert least > 0 if found is True else least < 1e-4  # between places it falls by 100 (1/4000)^2 / 2 at most
    if isinstance(found, Fraction):
        assert 0 <= found <= 1
        assert sum(c * found**k for k, c in enumerate(polynomial)) <= 0


def test_a_narrow_dip_is_found_and_what_only_touches_zero_is_left_open() -> None:
    depth = Fraction(1, 10**16)  # (s - 1/3)^2 - 10^-16 is negative only near one third
    found = positivity([[THIRD**2 - depth, -2 * THIRD, ONE]], ZERO, ONE)
    assert isinstance(found, Fraction)
    assert (found - THIRD) ** 2 <= depth
    assert positivity([[THIRD**2 + depth, -2 * THIRD, ONE]], ZERO, ONE) is True
    assert positivity([[THIRD**2, -2 * THIRD, ONE]], ZERO, ONE) is False
