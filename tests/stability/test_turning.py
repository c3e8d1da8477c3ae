"""What turning constraints do to a pole: against derivatives by hand, and the second-order form."""

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.closed_loop import poles
from bezstab.stability.turning import turning_shift

POINTS = [(0.31, 0.13), (0.9, 0.05), (0.2, 0.3)]


@pytest.mark.parametrize(("alpha_hat", "beta_hat"), POINTS)
def test_symplectic_euler_follows_its_own_shifted_polynomial(alpha_hat: float, beta_hat: float) -> None:
    """(1 - e) (z - 1)^2 + (1 + e) alpha_hat (z - 1) + beta_hat z = 0, and what dz/de is of it at e = 0."""
    z = poles(lookup("SYM"), alpha_hat, beta_hat)
    by_hand = (z - 1) * (z - 1 - alpha_hat) / (2 * (z - 1) + alpha_hat + beta_hat)
    assert turning_shift(lookup("SYM"), alpha_hat, beta_hat, z) == pytest.approx(by_hand, rel=1e-9)


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
