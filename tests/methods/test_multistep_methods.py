"""Bezier methods against another route to their weights; of others order and number of steps determine them."""

import numpy as np
import pytest
from scipy.interpolate import BPoly

from bezstab.methods.registry import lookup
from bezstab.methods.schemes import LinearMultistep


@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_step_integrates_the_curve_past_its_end(n: int) -> None:
    """Of slopes at -(n - 1), ..., 0 as control points, by scipy: to the digits of float64."""
    scheme = lookup(f"B{n}").scheme
    assert isinstance(scheme, LinearMultistep)
    assert scheme.rho == (1, -1, *[0] * (n - 1))
    weights = BPoly(np.eye(n)[:, np.newaxis], [1 - n, 0]).integrate(0, 1, extrapolate=True)
    assert np.array(scheme.sigma, float) == pytest.approx(np.array([0, *weights[::-1]]), rel=1e-13)
