"""Where paths cross the boundary, against the edges of regions that have formulas."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.methods import closed_loop_at, lookup
from bezstab.stability.path_crossings import Path, crossing_factors
from tests.methods.kinds import sampled


def test_a_path_that_stays_where_it_is_crosses_nothing() -> None:
    assert crossing_factors(Path(lookup("RK4"), Fraction(0), Fraction(1, 10), (1, 0))) == ()


@pytest.mark.parametrize("name", sampled(["B4", "AB4", "ABM3", "RK4", "bdf3", "hht", "yoshida4"], quick=["B4"]))
@pytest.mark.parametrize("powers", [(1, 2), (1, 0), (0, 2)])
@settings(deadline=None, max_examples=3)
@given(
    alpha_hat=st.fractions(Fraction(1, 50), 1, max_denominator=1000),
    share=st.one_of(st.floats(0.1, 0.9), st.floats(1.1, 3)),
)
def test_at_every_crossing_the_product_of_two_roots_is_one(
    name: str, powers: tuple[int, int], alpha_hat: Fraction, share: float
) -> None:
    """A pair on the circle, 1 or -1 with itself, or two real ones, of which one is outside before and after.

    Second route: the eigenvalues of P's companion matrix at the crossing, which double poles would spoil.
    """
    path = Path(lookup(name), alpha_hat, Fraction(share) * alpha_hat**2 / 4, powers)
    # up to four roots of ABM3 meet on its edge: float64 parts those by a few fourth roots of its rounding, 1.2e-4
    close = 1e-3 if name == "ABM3" else 1e-6
    for factor in crossing_factors(path):
        polynomial = [float(c) for c in closed_loop_at(path.method, *path.at(Fraction(factor)))]
        if abs(polynomial[-1]) < 1e-9 * max(map(abs, polynomial)):
            continue  # a root comes from infinity
        z = np.polynomial.polynomial.polyroots(polynomial)
        assert np.abs(np.outer(z, z) - 1).min() < close


def test_the_crossings_of_a_triangle() -> None:
    """SYM is stable for 0 < alpha_hat < 2, 0 < beta_hat < 4 - 2 alpha_hat."""
    upwards = crossing_factors(Path(lookup("SYM"), Fraction(1, 2), Fraction(1), (1, 0)))
    assert upwards[0] == pytest.approx(3, rel=1e-14)
