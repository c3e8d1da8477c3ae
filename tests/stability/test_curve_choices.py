"""Points of a curve, where what is best can be told by hand."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import choose
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.curve_choices import least_along, mildest_along
from tests.reference.settling import settling


def one_step(share: Any) -> tuple[Any, Any]:
    """Return alpha_hat = 1, where symplectic Euler's poles are 0 and 1 - beta_hat; beta_hat to 1.5."""
    return 1.0, 1.5 * share


def modulus(alpha_hat: FloatArray, beta_hat: FloatArray) -> FloatArray:
    return spectral_radius(lookup("SYM"), alpha_hat, beta_hat)


def test_the_least_is_found() -> None:
    alpha_hat, beta_hat = least_along(one_step, modulus)
    assert (alpha_hat, beta_hat) == pytest.approx((1, 1), abs=1e-9)


def test_of_equal_points_the_mildest_is_taken() -> None:
    point = least_along(one_step, lambda a, b: np.maximum(modulus(a, b), 0.5))
    assert point == pytest.approx((1, 0.5), abs=1e-9)  # up to 1.5 all are as good


def test_the_mildest_that_is_fast_enough() -> None:
    assert mildest_along(one_step, modulus, 0.8, "SYM") == pytest.approx((1, 0.2), abs=1e-9)
    with pytest.raises(InputError, match=r"SYM has at best \|z_p\| = 0.9, needed 0.8"):
        mildest_along(lambda share: (1.0, 0.1 * share), modulus, 0.8, "SYM")


def test_choose_keeps_to_the_curve() -> None:
    gentle = choose(lookup("SYM"), "gentle", h=Fraction(1), settle=settling(0.8), along=one_step)
    assert (gentle.alpha_hat, gentle.beta_hat) == pytest.approx((1, 0.2), abs=1e-9)
    with pytest.raises(InputError, match="with any setting of the engine"):
        choose(lookup("SYM"), "gentle", h=Fraction(1), settle=settling(0.8), along=lambda share: (1.0, 0.1 * share))


def test_of_a_curve_the_accurate_point_decays_as_asked_or_is_refused() -> None:
    """At alpha_hat = 1 and off by a tenth of alpha and beta the slowest pole is at least 0.35, whatever beta is."""
    accurate = choose(lookup("SYM"), "accurate", h=Fraction(1), settle=settling(0.9), along=one_step)
    assert accurate.alpha_hat == 1
    assert accurate.worst <= 0.9
    with pytest.raises(InputError, match=r"no setting of the engine reaches \|z_p\| <= 0.3"):
        choose(lookup("SYM"), "accurate", h=Fraction(1), settle=settling(0.3), along=one_step)
