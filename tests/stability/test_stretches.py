"""Stable stretches of paths: against lines in rationals."""

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.rationals import exact
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import verdict
from bezstab.stability.stretches import ALONG_ALPHA, ALONG_BETA, ALONG_H, paths
from tests.methods.kinds import sampled
from tests.reference.exact_lines import stable_parts
from tests.reference.random_methods import random_method

METHODS = ["B4", "ABM4", "RK4", "verlet-old", "ruth3", "generalized-alpha", "bdf3"]


@pytest.mark.parametrize("name", sampled(METHODS, quick=["B4", "verlet-old", "generalized-alpha"]))
@pytest.mark.parametrize("level", [1.0, 0.875])
@pytest.mark.parametrize("axis", [0, 1])
def test_lines_have_the_stretches_that_rationals_prove(name: str, level: float, axis: int) -> None:
    for place in (Fraction(1, 4), Fraction(7, 8)):
        proven = joined(stable_parts(lookup(name), level, place, axis))
        start = (float(place), 1.0) if axis == 0 else (1.0, float(place))
        alpha_hat, beta_hat = np.reshape(start, (2, 1))
        found = paths(lookup(name), alpha_hat, beta_hat, (ALONG_BETA, ALONG_ALPHA)[axis], level).stretches()
        assert np.stack([found.low, found.high], axis=-1) == pytest.approx(proven, rel=1e-8, abs=1e-10)


def joined(parts: list[tuple[Fraction | float, Fraction | float]]) -> FloatArray:
    """Return the parts of a line above zero, those joined between which there is but a place that is met."""
    positive = [(max(float(low), 0.0), float(high)) for low, high in parts if high > 0]
    starts = positive[:1] + [after for before, after in pairwise(positive) if before[1] != after[0]]
    ends = [before for before, after in pairwise(positive) if before[1] != after[0]] + positive[-1:]
    return np.array([(low, high) for (low, _), (_, high) in zip(starts, ends, strict=True)]).reshape(-1, 2)


def test_two_places_that_rounding_makes_one_leave_no_gap() -> None:
    """Just above bdf3's least damping ratio two places of its path of steps are complex, with one real part."""
    found = paths(lookup("bdf3"), np.array([2 * 0.069193]), np.ones(1), ALONG_H).stretches()
    assert (found.low.tolist(), found.high.tolist()) == ([0.0], [np.inf])


@pytest.mark.parametrize("number", [103, 154, 178, 182])
def test_a_line_that_is_stable_next_to_weak_feedback_is_so_from_zero(number: int) -> None:
    """As beta_hat falls to zero one pole comes to z = 1 and stays inside: rounding of P(1) would let it out."""
    found = paths(random_method(number), np.array([1e-3]), np.ones(1), ALONG_BETA).stretches()
    assert found.low[0] == 0
    assert verdict(random_method(number), exact(1e-3), exact(1e-25)) == "converges"
