"""The first-order law of a moving mechanism against the exact rates, and where it can be had by hand."""

from dataclasses import replace

import numpy as np
import pytest

from bezstab.evidence import LAW_HOLDS, moving_poles
from bezstab.evidence.moving_mechanisms import growth_rates
from bezstab.mechanism import compiled_mechanism, load_scene, turning_normals
from bezstab.methods import lookup
from bezstab.stability import poles
from tests.evidence.driven_four_bar import four_bar, turning
from tests.evidence.exact_rates import floquet_rates

OMEGA = 2 * np.pi


def test_the_motion_never_helps() -> None:
    """Over a closed motion det Y = 1: Lambda >= 0 for every chi; at chi = 2.4 theory has seen 0.2 to 0.43 omega."""
    chi = 2.4 * np.exp(1j * np.linspace(-np.pi, np.pi, 25))
    rates = growth_rates(turning(), chi)[0] / OMEGA
    assert rates.min() > -1e-9
    assert 0.19 < rates.min() < rates.max() < 0.44
    assert np.abs(growth_rates(turning(), [0.0])).max() < 1e-9


@pytest.mark.slow
def test_a_triangular_k_does_not_make_errors_grow() -> None:
    """On the driven slider-crank K is triangular in some basis: only its diagonal's mean, zero, would count."""
    turning = turning_normals(compiled_mechanism(load_scene("driven_slider_crank")), 1.0)
    assert np.abs(growth_rates(turning, np.array([2.4, 2.4j, -1 + 1j]))).max() < 1e-6 * OMEGA


@pytest.mark.promise(
    "Rates over a motion",
    measured="the law at most 0.15 of the map's error against exact rates, at ωh = 0.031",
)
@pytest.mark.parametrize(
    "name",
    ["B4", "AB4", "AB2", "SYM", "RK4", "verlet-predicted", "newmark(1/4,1/2)"],
)
@pytest.mark.slow_except("SYM")
def test_the_law_closes_most_of_the_gap_to_the_exact_rate(name: str) -> None:
    """At omega h = 0.031 the map is off by 3e-3 to 8e-3 in the median; the law leaves terms of (omega h)^2 = 1e-3."""
    method = lookup(name)
    count = 203
    random = np.random.default_rng(5)
    points = random.uniform([0.05, 0.02], [1.5, 1.0], (400, 2))
    z = poles(method, *points.T)[:, 0]
    far_from_the_corners = np.sin(np.abs(np.angle(z))) > np.sin(4 * OMEGA / count)
    near_one = (np.abs(z) > 0.8) & (np.abs(z) < 1.1) & far_from_the_corners
    alpha_hat, beta_hat = points[near_one][:30].T
    exact = floquet_rates(four_bar(), method, 1 / count, alpha_hat, beta_hat, 1.0)
    law = np.array([each.z_abs_moving for each in moving_poles(method, turning(), 1 / count, alpha_hat, beta_hat)])
    map_error, law_error = np.abs(np.abs(z)[near_one][:30] - exact), np.abs(law - exact)
    assert np.median(law_error) < 0.15 * np.median(map_error)
    assert not ((law > 1) != (exact > 1))[np.abs(exact - 1) > 1e-3].any()


@pytest.mark.parametrize(("name", "alpha_hat", "beta_hat"), [("B4", 0.6, 0.3), ("AB4", 0.3, 0.115), ("SYM", 1.0, 0.5)])
def test_up_to_the_safe_speed_errors_decay_and_the_law_holds(name: str, alpha_hat: float, beta_hat: float) -> None:
    """A mechanism F times as fast turns as far in a step as one whose step is F times as long."""
    h = 0.005
    (pole,) = moving_poles(lookup(name), turning(), h, alpha_hat, beta_hat)
    safe = pole.safe_speed
    assert safe > 1
    slower, faster = (
        moving_poles(lookup(name), turning(), share * safe * h, alpha_hat, beta_hat)[0] for share in (0.999, 1.001)
    )
    assert slower.z_abs_moving < 1
    if turning().kappa * safe * h < 0.999 * LAW_HOLDS:  # else the law ends there
        assert faster.z_abs_worst > 1


def test_at_rest_poles_stay_where_they_are_however_large_chi_is() -> None:
    """SYM at (1, 1/2): the pole 0 has no finite chi."""
    moving = turning()
    at_rest = replace(moving, rates=np.zeros_like(moving.rates))
    (pole,) = moving_poles(lookup("SYM"), at_rest, 0.01, 1.0, 0.5)
    assert (pole.verdict, pole.z_abs) == ("converges", 0.5)


@pytest.mark.slow
def test_an_error_that_stays_as_it_is_does_not_surely_grow() -> None:
    """Over a run of the free four-bar what an error stands for grows by 0.79 a second; at chi = 0 no error does."""
    run = turning_normals(compiled_mechanism(load_scene("four_bar")), 1.0)
    assert not run.closed
    rates, sure = growth_rates(run, [0.0, 0.1, 1.0, 3j])
    assert rates[0] > 0.5
    assert sure[0] == pytest.approx(0.0, abs=1e-12)
    assert (sure <= rates).all()
    (near_the_corner,) = moving_poles(lookup("AB8"), run, 1e-3, 0.001356, 0.000529)
    assert near_the_corner.z_abs_moving > 1
    assert not near_the_corner.settled


@pytest.mark.promise(
    "Where the law of the motion fails",
    measured=(
        "beyond κh = 0.1 nothing is said to converge; two poles that mix stay within the reach that is shown for "
        "the worst"
    ),
)
def test_nothing_converges_beyond_the_law() -> None:
    """AB4 where chi is 1e-4, at kappa h = 0.19: the law sees a decay that the exact rate has not."""
    step, alpha_hat, beta_hat = 0.06, 0.15, 0.006
    (exact,) = floquet_rates(four_bar(), lookup("AB4"), step, np.array([alpha_hat]), np.array([beta_hat]), 1.0)
    (moving,) = moving_poles(lookup("AB4"), turning(), step, alpha_hat, beta_hat)
    assert moving.z_abs_worst < 0.95
    assert exact > 1.05
    assert moving.verdict == "not settled for this mechanism"
