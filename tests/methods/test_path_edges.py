from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import closed_loop_at, lookup
from bezstab.methods.path_edges import (
    _along_path,
    _edge_of_pairs,
    _factors_on_the_circle,
    _positive_roots,
    turning_factors,
)

F = Fraction


@pytest.mark.parametrize("name", ["B3", "AB4", "bdf3", "am4", "B2@3"])
@pytest.mark.parametrize("powers", [(1, 2), (1, 0), (0, 2)])
def test_the_explicit_curve_of_a_multistep_method_is_its_determinants(name: str, powers: tuple[int, int]) -> None:
    for alpha_hat, beta_hat in ((F(1, 3), F(1, 7)), (F(1, 2), F(1, 16)), (F(-1, 5), F(1, 9)), (F(2, 5), F(-1, 30))):
        m = lookup(name).step_multiple
        by_curve = _factors_on_the_circle(lookup(name), m * alpha_hat, m**2 * beta_hat, powers)
        pairs = _edge_of_pairs(_along_path(lookup(name), alpha_hat, beta_hat, powers))
        assert all(min(abs(s / t - 1) for t in _positive_roots(pairs)) < 1e-15 for s in by_curve)
        for factor in _positive_roots(pairs):  # of real pairs z, 1/z the determinant vanishes too
            point = alpha_hat * factor ** powers[0], beta_hat * factor ** powers[1]
            z = np.polynomial.polynomial.polyroots([float(c) for c in closed_loop_at(lookup(name), *point)])
            on_circle = np.abs(z[np.abs(z.imag) > 1e-3 * np.abs(z)])
            if (np.abs(on_circle - 1) < 1e-9).any():
                assert min(abs(float(s / factor) - 1) for s in by_curve) < 1e-15


def test_a_rational_place_is_exact() -> None:
    """AB4 has P(-1) = 0 at the double mu = -3/10."""
    (limit,) = turning_factors(lookup("AB4"), F(2), F(1), (1, 2))
    assert limit == F(3, 10)
    assert sum(c * (-1) ** k for k, c in enumerate(closed_loop_at(lookup("AB4"), 2 * limit, limit**2))) == 0
