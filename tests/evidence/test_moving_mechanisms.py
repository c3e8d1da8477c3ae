"""The first-order law of a moving mechanism against the exact rates, and where it can be had by hand."""

from dataclasses import replace

import numpy as np
import pytest

from bezstab.evidence import (
    LAW_HOLDS,
    MovingPole,
    growth_rates,
    moving_pole,
    tabulated_rates,
)
from bezstab.evidence.moving_mechanisms import LARGEST_CHI, growth_rates_and_sure_ones
from bezstab.mechanism import compiled_mechanism, load_scene, simulate, turning_normals
from bezstab.methods import lookup
from bezstab.stability import poles, spectral_radius
from bezstab.units import feedback_gains
from tests.evidence.driven_four_bar import four_bar, turning
from tests.evidence.exact_rates import floquet_rates
from tests.methods.kinds import sampled

OMEGA = 2 * np.pi


def test_the_motion_never_helps() -> None:
    """Over a closed motion det Y = 1: Lambda >= 0 for every chi; at chi = 2.4 theory has seen 0.2 to 0.43 omega."""
    chi = 2.4 * np.exp(1j * np.linspace(-np.pi, np.pi, 25))
    rates = growth_rates(turning(), chi) / OMEGA
    assert rates.min() > -1e-9
    assert 0.19 < rates.min() < rates.max() < 0.44
    assert growth_rates(turning(), 0.0) == pytest.approx(0, abs=1e-9)


@pytest.mark.slow
def test_a_triangular_k_does_not_make_errors_grow() -> None:
    """On the driven slider-crank K is triangular in some basis: only its diagonal's mean, zero, would count."""
    turning = turning_normals(compiled_mechanism(load_scene("driven_slider_crank")), 1.0)
    assert np.abs(growth_rates(turning, np.array([2.4, 2.4j, -1 + 1j]))).max() < 1e-6 * OMEGA


def test_the_table_is_good_to_half_a_percent_and_grows_in_proportion_beyond() -> None:
    """Of the motion as 51 samples tell it; up to |chi| = 20, further out steps between so few samples are too long."""
    coarse = replace(turning(), rates=turning().rates[::8])
    random = np.random.default_rng(3)
    direction = np.exp(1j * random.uniform(-np.pi, np.pi, 60))
    chi = random.uniform(0.1, 20, 60) * direction
    exact = growth_rates(coarse, chi)
    assert np.abs(tabulated_rates(coarse, chi) - exact).max() < 5e-3 * exact.max()
    at_the_end = tabulated_rates(coarse, LARGEST_CHI * direction)
    assert tabulated_rates(coarse, 3 * LARGEST_CHI * direction) == pytest.approx(3 * at_the_end, rel=1e-12)


@pytest.mark.promise(
    "Rates over a motion",
    measured=(
        "the law at most 0.15 of the map's error against exact rates, at ωh = 0.031; exact rates to 1e-4 of the "
        "runner's own"
    ),
)
@pytest.mark.parametrize(
    "name",
    sampled(
        ["B4", "AB4", "AB2", "SYM", "RK4", "verlet-predicted", "newmark(1/4,1/2)"],
        quick=["AB2", "SYM", "RK4", "newmark(1/4,1/2)"],
    ),
)
@pytest.mark.slow_except("SYM")
def test_the_law_closes_most_of_the_gap_to_the_exact_rate(name: str) -> None:
    """At omega h = 0.031 the map is off by 3e-3 to 8e-3 in the median; the law leaves terms of (omega h)^2 = 1e-3."""
    method = lookup(name)
    count = 203
    random = np.random.default_rng(5)
    points = random.uniform([0.05, 0.02], [1.5, 1.0], (400, 2))
    at_rest = spectral_radius(method, points[:, 0], points[:, 1])
    angle = np.abs(np.angle([poles(method, a, b)[0] for a, b in points]))
    far_from_the_corners = (angle > 4 * OMEGA / count) & (angle < np.pi - 4 * OMEGA / count)
    near_one = (at_rest > 0.8) & (at_rest < 1.1) & far_from_the_corners
    alpha_hat, beta_hat = points[near_one][:30].T
    exact = floquet_rates(four_bar(), method, 1 / count, alpha_hat, beta_hat, 1.0)
    law = np.array([
        moving_pole(method, turning(), 1 / count, a, b).z_abs_moving for a, b in zip(alpha_hat, beta_hat, strict=True)
    ])  # fmt: skip
    map_error, law_error = np.abs(at_rest[near_one][:30] - exact), np.abs(law - exact)
    assert np.median(law_error) < 0.15 * np.median(map_error)
    assert not ((law > 1) != (exact > 1))[np.abs(exact - 1) > 1e-3].any()


def test_a_verdict_that_the_motion_can_turn_is_not_settled() -> None:
    step = 0.1 / OMEGA
    safe = moving_pole(lookup("B4"), turning(), step, 0.5, 0.2)
    close = moving_pole(lookup("B4"), turning(), step, 0.5, 0.1)
    assert safe.settled
    assert safe.z_abs < safe.z_abs_moving < safe.z_abs_worst < 1
    assert not close.settled or close.z_abs_worst < 1


@pytest.mark.parametrize(("share", "turns_round"), [(0.99, True), (1.01, False)])
def test_symplectic_euler_keeps_a_mass_on_a_circle_up_to_a_known_speed(share: float, turns_round: bool) -> None:
    """Steps of angle phi need r^2 = beta_hat / (beta_hat + 2 alpha_hat (1 - cos phi)), and (theory, section 9) exist
    if and only if omega h < sqrt(beta_hat / (beta_hat + 4 alpha_hat))."""
    alpha_hat, beta_hat, h = 0.5, 0.25, 1e-3
    limit = np.sqrt(beta_hat / (beta_hat + 4 * alpha_hat))
    scene = replace(load_scene("pendulum"), gravity=(0.0, 0.0))
    mechanism = compiled_mechanism(scene)
    length = float(np.hypot(scene.position["bob.x"], scene.position.get("bob.y", 0.0))) or 1.0
    speed = share * limit / h
    state = np.array([length, 0.0]), np.array([0.0, speed * length])
    run = simulate(mechanism, lookup("SYM"), h, 3.0, feedback_gains(alpha_hat, beta_hat, h), state)
    radius = np.hypot(run.q[-500:, 0], run.q[-500:, 1]) / length
    steady = run.failure is None and float(np.ptp(radius)) < 1e-6
    assert steady == turns_round


@pytest.mark.parametrize(("name", "alpha_hat", "beta_hat"), [("B4", 0.6, 0.3), ("B4", 0.5, 0.2), ("SYM", 1.0, 0.5)])
def test_up_to_the_safe_speed_errors_decay_and_the_law_holds(name: str, alpha_hat: float, beta_hat: float) -> None:
    """A mechanism F times as fast turns as far in a step as one whose step is F times as long."""
    h = 0.005

    def pole(faster: float) -> MovingPole:
        return moving_pole(lookup(name), turning(), faster * h, alpha_hat, beta_hat)

    safe = pole(1).safe_speed
    assert safe > 1
    assert pole(0.999 * safe).z_abs_moving < 1
    if turning().kappa * safe * h < 0.999 * LAW_HOLDS:  # else the law ends there
        assert pole(1.001 * safe).z_abs_worst > 1


def test_at_rest_poles_stay_where_they_are_however_large_chi_is() -> None:
    """SYM at (1, 1/2): the pole 0 has no finite chi."""
    moving = turning()
    at_rest = replace(moving, rates=np.zeros_like(moving.rates))
    pole = moving_pole(lookup("SYM"), at_rest, 0.01, 1.0, 0.5)
    assert (pole.verdict, pole.z_abs) == ("converges", 0.5)


@pytest.mark.promise("Where the law of the motion fails")
@pytest.mark.parametrize(
    ("name", "alpha_hat", "beta_hat"),
    [
        ("SYM", 1.0, 1.0),
        ("SYM", 1.0, 0.99),
        ("RK2", 2.0, 2.0),
        ("AB4", 0.42928868, 0.04607219),
        ("B4", 1.0127, 0.256389),
    ],
)
@pytest.mark.parametrize("step", [0.001, 0.005, 0.02])
@pytest.mark.slow_except("0.02")
def test_double_poles_stay_within_their_reach(name: str, alpha_hat: float, beta_hat: float, step: float) -> None:
    """Where the law itself has zero or no bound at all."""
    moving = moving_pole(lookup(name), turning(), step, alpha_hat, beta_hat)
    (exact,) = floquet_rates(four_bar(), lookup(name), step, np.array([alpha_hat]), np.array([beta_hat]), 1.0)
    assert moving.double
    assert moving.z_abs <= moving.z_abs_moving <= moving.z_abs_worst
    assert exact < moving.z_abs_worst
    assert not moving.settled or exact < 1


@pytest.mark.slow
def test_an_error_that_stays_as_it_is_does_not_surely_grow() -> None:
    """Over a run of the free four-bar what an error stands for grows by 0.79 a second; at chi = 0 no error does."""
    run = turning_normals(compiled_mechanism(load_scene("four_bar")), 1.0)
    assert not run.closed
    rates, sure = growth_rates_and_sure_ones(run, [0.0, 0.1, 1.0, 3j])
    assert rates[0] > 0.5
    assert sure[0] == pytest.approx(0.0, abs=1e-12)
    assert (sure <= rates).all()
    near_the_corner = moving_pole(lookup("AB8"), run, 1e-3, 0.001356, 0.000529)
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
    moving = moving_pole(lookup("AB4"), turning(), step, alpha_hat, beta_hat)
    assert moving.z_abs_worst < 0.95
    assert exact > 1.05
    assert moving.verdict == "not settled for this mechanism"
