"""Rates of runs that are kicked from the method's own motion: what the exact rate predicts, by the runner alone."""

from itertools import product

import numpy as np
import pytest

from bezstab.evidence import random_points
from bezstab.evidence.exact_rates import find_own_motions
from bezstab.evidence.kicked_revolutions import rates_of_kicked_revolutions
from bezstab.methods import lookup
from bezstab.stability import FloatArray, spectral_radius
from tests.evidence.driven_four_bar import four_bar
from tests.evidence.samples import of_campaign


def rates(name: str, count: int, points: tuple[FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return |z| per step as it is measured and as it is predicted, of so many steps a revolution."""
    method = lookup(name)
    motions = find_own_motions(four_bar(), method, 1 / count, *points, 1.0)
    return rates_of_kicked_revolutions(motions), motions.rates


@pytest.mark.promise("Rates over the method's own motion")
@pytest.mark.parametrize(
    ("name", "count"),
    of_campaign([*product(["B4", "AB4", "AB2", "SYM", "RK4"], [203, 60])], [("SYM", 60), ("AB4", 60), ("B4", 203)]),
)
@pytest.mark.slow_except("SYM-60")
def test_runs_show_the_exact_rate_and_are_on_its_side_of_one(name: str, count: int) -> None:
    """At omega h = 0.031 and 0.105, at the random points of verify: ten times nearer than the poles at rest."""
    points = random_points(lookup(name), 60)
    shown, exact = rates(name, count, points)
    followed = np.isfinite(shown)
    assert followed.sum() >= 3
    assert ((shown > 1) == (exact > 1))[followed].all()
    apart = np.median(np.abs(shown - exact)[followed])
    assert apart < 5e-5
    assert apart < 0.1 * np.median(np.abs(shown - spectral_radius(lookup(name), *points))[followed])


@pytest.mark.parametrize("name", ["bdf2", "trapezoid"])
@pytest.mark.slow
def test_runs_of_methods_that_solve_equations_show_it_too(name: str) -> None:
    shown, exact = rates(name, 60, (np.array([0.03, 0.06]), np.array([0.03, 0.05])))
    assert shown == pytest.approx(exact, abs=1e-6)


def test_what_cannot_be_followed_has_no_rate() -> None:
    """Errors that fall to nothing within a revolution, and those that grow beyond all bounds: no motion is found."""
    shown, _ = rates("AB4", 200, (np.array([0.3, 1.5]), np.array([0.06, 2.0])))
    assert np.isnan(shown).all()
