"""A drive's gains on an inertia are a point; how it grows is held by tests/drives."""

from fractions import Fraction

import pytest

from bezstab.engines.drives import Drive
from bezstab.errors import InputError

H = Fraction(1, 240)


def test_gains_are_a_point_and_a_point_is_gains() -> None:
    drive = Drive(Fraction(1000), Fraction(20), Fraction(1, 10))
    alpha_hat, beta_hat = drive.point(H)
    assert (alpha_hat, beta_hat) == (20 * H * 10, 1000 * H**2 * 10)
    assert drive.gains(float(alpha_hat), float(beta_hat), float(H)) == pytest.approx((1000, 20))


def test_an_inertia_is_above_zero() -> None:
    with pytest.raises(InputError, match="inertia"):
        Drive(Fraction(1), Fraction(1), Fraction(0))
