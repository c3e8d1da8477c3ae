"""A drive's gains on an inertia, applied in the ways that engines have: where each begins to explode."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.engines.drives import DRIVE_METHODS, Drive
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.stability.closed_loop import spectral_radius, verdict
from tests.reference.drive_steps import DRIVE_STEPS
from tests.reference.engine_steps import matrix

H = Fraction(1, 240)
LIMITS: dict[str, Callable[[Fraction], Fraction]] = {  # of beta_hat, at an alpha_hat: shared facts about drives
    "SYM": lambda a: 4 - 2 * a,
    "imex-euler": lambda a: 4 + 2 * a,
    "stable-pd": lambda a: (4 + 2 * a) / 3,
}


def test_gains_are_a_point_and_a_point_is_gains() -> None:
    drive = Drive(Fraction(1000), Fraction(20), Fraction(1, 10))
    alpha_hat, beta_hat = drive.point(H)
    assert (alpha_hat, beta_hat) == (20 * H * 10, 1000 * H**2 * 10)
    assert drive.gains(float(alpha_hat), float(beta_hat), float(H)) == pytest.approx((1000, 20))


@pytest.mark.parametrize("method", LIMITS)
@pytest.mark.parametrize("alpha_hat", ["1/10", "1", "3/2"])
def test_each_way_of_applying_a_drive_has_its_proven_limit(method: str, alpha_hat: str) -> None:
    a = Fraction(alpha_hat)
    limit = LIMITS[method](a)
    sliver = Fraction(1, 10**9)
    assert verdict(lookup(method), a, limit - sliver) == "converges"
    assert verdict(lookup(method), a, limit + sliver) == "diverges"


@pytest.mark.parametrize("method", DRIVE_METHODS)
@settings(max_examples=20, deadline=None)
@given(kp=st.floats(1, 5e4), kd=st.floats(0.1, 100))
def test_a_simulated_drive_grows_as_the_pole_says(method: str, kp: float, kd: float) -> None:
    inertia = 0.1
    point = Drive(*map(Fraction, (kp, kd, inertia))).point(H)
    z_abs = float(spectral_radius(lookup(method), *map(float, point)))
    z = np.linalg.eigvals(matrix(DRIVE_STEPS[method], float(H), kp, kd, inertia))
    assert np.abs(z).max() == pytest.approx(z_abs, rel=1e-6)  # a double pole


def test_an_inertia_is_above_zero() -> None:
    with pytest.raises(InputError, match="inertia"):
        Drive(Fraction(1), Fraction(1), Fraction(0))
