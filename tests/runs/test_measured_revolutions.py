"""Exact rates against disturbed runs: their differences over a whole revolution beside the motion that they make."""

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.runs.exact_rates import exact_rates
from bezstab.stability.closed_loop import spectral_radius
from tests.reference.perturbed_revolutions import runner_motion
from tests.runs.driven_four_bar import four_bar


@pytest.mark.parametrize(
    ("name", "alpha_hat", "beta_hat", "apart"),
    [
        ("AB4", 0.3, 0.115, 3e-8),
        ("AB4", 0.05, 0.01, 3e-8),
        ("AB2", 0.54165581, 0.68299639, 1e-5),  # truncation errors give a run a motion of its own
    ],
)
@pytest.mark.slow
def test_disturbed_runs_show_the_exact_rate(name: str, alpha_hat: float, beta_hat: float, apart: float) -> None:
    method = lookup(name)
    found = runner_motion(four_bar(), method, 203, alpha_hat, beta_hat)
    assert found is not None
    (exact,) = exact_rates(four_bar(), method, 1 / 203, np.array([alpha_hat]), np.array([beta_hat]), 1.0)
    assert found[1] == pytest.approx(exact, abs=apart)
    assert abs(found[1] - spectral_radius(method, alpha_hat, beta_hat)) > 10 * apart
