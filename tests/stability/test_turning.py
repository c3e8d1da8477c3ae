"""What turning constraints do to a pole: against roots of shifted polynomials, and the exact map."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import poles
from bezstab.stability.turning import turning_shift

POINTS = [(0.31, 0.13), (0.9, 0.05), (0.2, 0.3)]


@pytest.mark.parametrize(("alpha_hat", "beta_hat"), POINTS)
def test_symplectic_euler_follows_its_own_shifted_polynomial(alpha_hat: float, beta_hat: float) -> None:
    z = poles(lookup("SYM"), alpha_hat, beta_hat)
    shifts = turning_shift(lookup("SYM"), alpha_hat, beta_hat, z)
    eps = 1e-6  # what is left is of the second order in it
    shifted = [
        np.polyadd(np.polyadd((1 - e) * np.array([1, -2, 1]), alpha_hat * (1 + e) * np.array([1, -1])), [beta_hat, 0])
        for e in (eps, -eps)
    ]
    for pole, shift in zip(z, shifts, strict=True):
        moved = [roots[np.argmin(np.abs(roots - pole))] for roots in map(np.roots, shifted)]
        assert shift == pytest.approx((moved[0] - moved[1]) / (2 * eps), rel=1e-5)


@pytest.mark.parametrize("name", ["B4", "AB3", "RK4", "ABM3", "trapezoid", "AB2@1/2"])
@pytest.mark.parametrize(("alpha_hat", "beta_hat"), POINTS)
def test_a_method_and_its_second_order_form_have_the_same_sensitivity(
    name: str, alpha_hat: float, beta_hat: float
) -> None:
    method = lookup(name)
    written_out = Method(name, method.scheme.second_order, "", method.step_multiple)
    z = poles(method, alpha_hat, beta_hat)[:2]
    assert np.allclose(
        turning_shift(method, alpha_hat, beta_hat, z),
        turning_shift(written_out, alpha_hat, beta_hat, z),
        rtol=1e-6,  # next to a double pole P_z keeps half the digits
    )


@given(rate=st.floats(0.2, 2.0), damping=st.floats(0.1, 0.9))
def test_the_better_the_method_the_less_it_is_turned(rate: float, damping: float) -> None:
    """An exact method has chi = 0; one of order p has chi of order h^p on principal poles."""
    h = 0.01
    for name, order in (("RK2", 2), ("RK4", 4), ("trapezoid", 2), ("verlet-implicit", 2)):
        alpha_hat, beta_hat = 2 * damping * rate * h, (rate * h) ** 2
        z = poles(lookup(name), alpha_hat, beta_hat)[0]
        chi = complex(turning_shift(lookup(name), alpha_hat, beta_hat, z)) / z
        assert abs(chi) < 5 * (rate * h) ** (order - 1)  # of a velocity scheme one order less
