"""Bounds on the poles of a moving mechanism against the exact rates: never safe where errors grow."""

import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.runs.exact_rates import exact_rates
from bezstab.stability.arrays import FloatArray
from bezstab.stability.regions import region, window
from bezstab.stability.turning import moving_pole, turn_limits
from tests.methods.kinds import sampled
from tests.runs.driven_four_bar import four_bar, turning


def anywhere(name: str, random: np.random.Generator, count: int) -> FloatArray:
    low, high = np.transpose(window(region(lookup(name))))
    return np.asarray(random.uniform(low - 0.1 * (high - low), high + 0.1 * (high - low), (count, 2)).T)


def near_a_double_pole(name: str, random: np.random.Generator, count: int) -> FloatArray:
    """Return points on and beside the curve on which both mu are one."""
    (_, high), _ = window(region(lookup(name)))
    alpha_hat = random.uniform(0, high, count)
    return np.array([alpha_hat, alpha_hat**2 / 4 * (1 + random.choice([0, 1e-6, -1e-4, 1e-3, -1e-2], count))])


def weak(name: str, random: np.random.Generator, count: int) -> FloatArray:
    """Return feedback of damping ratios 0.1 to 10, down to much slower than the constraints turn."""
    alpha_hat, damping_ratio = 10 ** random.uniform([[-4], [-1]], [[0], [1]], (2, count))
    return np.array([alpha_hat, (alpha_hat / 2 / damping_ratio) ** 2])


@pytest.mark.parametrize("count", [203, 60, 34])
@pytest.mark.parametrize("name", sampled(["B4", "AB2", "AB4", "RK2", "RK4", "SYM", "bdf2"], quick=["SYM"]))
def test_errors_decay_wherever_the_bound_says_so(name: str, count: int) -> None:
    """On the driven four-bar at kappa h = 0.016, 0.054 and 0.095; half of the points are nearly unsettled."""
    method, h, random = lookup(name), 1 / count, np.random.default_rng(5)
    alpha_hat, beta_hat = np.hstack([kind(name, random, 3000) for kind in (anywhere, near_a_double_pole, weak)])
    turned, limits = turning().kappa * h, turn_limits(method, alpha_hat, beta_hat)
    safe = np.flatnonzero(limits > turned)
    hardly = safe[limits[safe] < 1.2 * turned]
    some = np.concatenate([random.permutation(each)[:20] for each in (safe, hardly)])
    assert some.size
    assert (exact_rates(four_bar(), method, h, alpha_hat[some], beta_hat[some], 1.0) < 1).all()


@pytest.mark.slow
def test_most_of_what_decays_is_called_safe_and_nothing_that_grows() -> None:
    """A hundred random points of four methods; three of four that decay are, and no wrong "diverges"."""
    decaying, called, h = 0, 0, 1 / 60
    for name in ("B4", "AB4", "RK4", "SYM"):
        points = anywhere(name, np.random.default_rng(11), 100)
        rates = exact_rates(four_bar(), lookup(name), h, points[0], points[1], 1.0)
        moving = [moving_pole(lookup(name), turning().kappa, h, *at) for at in points.T]
        verdicts = np.array([each.verdict for each in moving])
        assert all(rate < each.at_most for rate, each in zip(rates, moving, strict=True) if each.verdict != "diverges")
        assert (rates[verdicts == "converges"] < 1).all()
        assert (rates[verdicts == "diverges"] > 1).all()
        decaying, called = decaying + (rates < 1).sum(), called + (verdicts == "converges").sum()
    assert called > 0.75 * decaying


@pytest.mark.parametrize(
    ("name", "at"), [("B4", (0.6, 0.3)), ("AB4", (0.3, 0.03)), ("SYM", (1.2, 0.5)), ("AB2@1/2", (0.9, 0.2))]
)
def test_a_point_is_safe_up_to_the_speed_that_is_said(name: str, at: tuple[float, float]) -> None:
    """There the bound is one, or first order ends; a mechanism F times as fast turns F times as far in a step."""
    method, kappa, h = lookup(name), 3.0, 0.005
    safe = moving_pole(method, kappa, h, *at).safe_speed
    slower, faster = (moving_pole(method, share * safe * kappa, h, *at) for share in (0.999, 1.001))
    assert (slower.verdict, faster.verdict) == ("converges", "not settled")
    assert slower.at_most < 1
