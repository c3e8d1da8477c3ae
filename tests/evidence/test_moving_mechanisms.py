"""The first-order law of a moving mechanism against the exact rates, and where it can be had by hand."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import ArrayLike

from bezstab.evidence import (
    floquet_rates,
    growth_rates,
    momentary_rates,
    moving_mechanisms,
    moving_pole,
    tabulated_rates,
)
from bezstab.evidence.mixing_poles import NearestPoles, in_pairs
from bezstab.evidence.moving_mechanisms import LARGEST_CHI, _safe_speeds, growth_rates_and_sure_ones
from bezstab.mechanism import TurningNormals, compiled_mechanism, load_scene, simulate, turning_normals
from bezstab.methods import lookup
from bezstab.stability import FloatArray, poles, spectral_radius
from bezstab.units import feedback_gains
from tests.evidence.driven_four_bar import four_bar, turning
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


def test_the_momentary_rate_bounds_a_scalar_one() -> None:
    chi = np.array([1.0, -2j, 0.5 + 0.5j])
    eigenvalues = np.linalg.eigvals(turning().rates)
    assert momentary_rates(turning(), chi) == pytest.approx([(c * eigenvalues).real.max() for c in chi])


@pytest.mark.slow
def test_the_table_is_as_good_as_the_law() -> None:
    random = np.random.default_rng(3)
    chi = random.uniform(0.1, 12, 200) * np.exp(1j * random.uniform(-np.pi, np.pi, 200))
    exact = growth_rates(turning(), chi)
    assert np.abs(tabulated_rates(turning(), chi) - exact).max() < 5e-3 * exact.max()


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


def test_no_entry_of_the_table_is_computed_that_nobody_asks_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Four around each chi, and none twice: each is a motion's worth of products of matrices."""
    computed: list[complex] = []

    def counted(turning: TurningNormals, chi: ArrayLike) -> FloatArray:
        computed.extend(np.ravel(chi).tolist())
        return growth_rates(turning, chi)

    monkeypatch.setattr(moving_mechanisms, "growth_rates", counted)
    coarse = replace(turning(), rates=turning().rates[::8])
    asked = np.array([0.3 + 0.4j, 2.0 - 1.0j])
    first = tabulated_rates(coarse, asked)
    assert len(computed) == 8
    assert tabulated_rates(coarse, asked).tolist() == first.tolist()
    tabulated_rates(coarse, asked.conj())
    assert len(computed) == 8


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


def alone(z_abs: float) -> NearestPoles:
    """A pole that has no other."""
    z = np.array([[complex(z_abs)]])
    return in_pairs(np.abs(z[:, 0]), z, np.array([[0.1 + 0j]]), np.zeros_like(z))


def test_a_pole_at_zero_limits_no_speed() -> None:
    """SYM at (1, 1/2) has the poles 1/2 and 0; what does not count has minus infinity for decay and for growth."""
    z = np.array([[0.5 + 0j, 0j]])
    nearest = in_pairs(np.abs(z[:, 0]), z, np.zeros_like(z), np.zeros_like(z))
    decay, growth = np.array([[np.log(0.5), -np.inf]]), np.array([[10.0, -np.inf]])
    assert _safe_speeds(nearest, decay, growth, turned=0.01) == pytest.approx(-np.log(0.5) / 10)
    assert _safe_speeds(nearest, decay, np.array([[-0.1, -np.inf]]), turned=0.0) == np.inf


def test_at_rest_poles_stay_where_they_are_however_large_chi_is() -> None:
    """SYM at (1, 1/2): the pole 0 has no finite chi."""
    moving = turning()
    at_rest = replace(moving, rates=np.zeros_like(moving.rates))
    pole = moving_pole(lookup("SYM"), at_rest, 0.01, 1.0, 0.5)
    assert (pole.verdict, pole.z_abs) == ("converges", 0.5)


def test_no_speed_is_safe_beyond_the_law() -> None:
    decay, growth = np.array([[np.log(0.5)]]), np.array([[0.001]])
    assert _safe_speeds(alone(0.5), decay, growth, turned=0.02) == pytest.approx(0.1 / 0.02)


@pytest.mark.parametrize(
    ("gap", "splitting", "kappa_h"),
    [
        (0.0, 1.0, 0.04),  # 0.8 + (kappa h)^(1/2) is one
        (0.0, 2.0, 0.02),
        (0.2, 1.0, 0.03),  # 0.8 + (0.01 + kappa h)^(1/2)
        (0.39, 1e-3, 0.1),  # far apart, and the law sees no limit: to its end
    ],
)
def test_where_two_poles_mix_their_reach_limits_the_speed(gap: float, splitting: float, kappa_h: float) -> None:
    """Two conjugates half way at 0.8, their shifts q / g and - q / g."""
    z = np.array([[0.8 + gap / 2 * 1j, 0.8 - gap / 2 * 1j]])
    shift = np.array([[splitting * 1j, -splitting * 1j]]) / complex(max(gap, 1e-9))
    nearest = replace(
        in_pairs(np.abs(z[:, 0]), z, shift, np.zeros_like(z)),
        splitting=np.full((1, 2), splitting),
    )
    decay, growth = np.log(np.abs(z)), np.array([[1e-9, -np.inf]])
    assert _safe_speeds(nearest, decay, growth, turned=0.02) == pytest.approx(kappa_h / 0.02)


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
