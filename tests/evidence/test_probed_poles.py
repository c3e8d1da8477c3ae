"""Poles found in logs: those that were put in, never others; and whose they are."""

from collections import Counter
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.evidence import (
    ProbedPole,
    kicked_responses,
    likenesses,
    points_like,
    probed_pole,
    steps_between_rows,
)
from bezstab.evidence.probed_poles import FEWEST
from bezstab.methods import REGISTRY, Method, lookup
from bezstab.stability import FloatArray, dominant_pole, poles, region, window
from tests.evidence.random_logs import H, RandomLog, random_logs
from tests.evidence.samples import of_campaign
from tests.reference.sampled_responses import geometric, of_poles, two_poles

ALL = dict.fromkeys(map(lookup, REGISTRY), 1)
"""All methods, with one of their steps from row to row."""
HALF, TENTH, FIFTH = Fraction(1, 2), Fraction(1, 10), Fraction(1, 5)


def responses_of(method: Method, alpha_hat: float, beta_hat: float, rows: int = 300) -> FloatArray:
    return of_poles(poles(method, alpha_hat, beta_hat), rows, seed=1)


def told(c: FloatArray, minus: FloatArray | None = None) -> ProbedPole:
    """Return the probed pole, which must be there."""
    found = probed_pole(c, minus)
    assert found.pole is not None, found.reason
    assert found.uncertainty is not None
    return found


@settings(max_examples=15, deadline=None)  # each fits some thirty windows
@given(st.floats(0.6, 0.98), st.floats(0.2, 2.9), st.floats(0.3, 0.8), st.integers(0, 5))
def test_the_pole_is_the_one_that_was_put_in_to_the_stated_error(
    modulus: float, angle: float, ratio: float, seed: int
) -> None:
    z = np.array([modulus * np.exp(1j * angle), modulus * np.exp(-1j * angle), ratio * modulus])
    c = np.array([float(f"{value:.9g}") for value in of_poles(z, 400, seed)])
    found = probed_pole(c, np.zeros_like(c))
    if found.pole is not None and found.uncertainty is not None:
        assert abs(found.pole - z[0]) <= found.uncertainty + 1e-7  # which is what nine digits leave


@pytest.mark.parametrize("name", ["AB4", "RK4", "newmark(1/4,1/2)"])
def test_the_true_method_is_the_nearest(name: str) -> None:
    method = lookup(name)
    c = responses_of(method, 0.2, 0.1)
    like = likenesses(told(c, np.zeros_like(c)), ALL, FIFTH, TENTH)
    nearest = [one for one in like if one.distance <= like[0].distance + 1e-6]
    assert any(one.method.scheme == method.scheme or one.method.name == name for one in nearest)
    assert like[0].fits
    assert like[0].distance < 1e-6
    assert [one.distance for one in like] == sorted(one.distance for one in like)


def test_methods_with_the_same_polynomial_are_named_together() -> None:
    c = responses_of(lookup("AB2"), 0.5, 0.1)
    like = {one.method.name: one for one in likenesses(told(c, 0 * c), ALL, HALF, TENTH)}
    assert like["B2"].same_as == "AB2"
    assert like["SYM"].same_as == "verlet-half"  # but for a factor of z
    assert like["RK4"].same_as == ""
    assert like["B2"].distance == like["AB2"].distance
    assert not like["RK4"].fits


def test_the_faster_the_mechanism_the_more_is_allowed() -> None:
    c = responses_of(lookup("B4"), 0.5, 0.1)
    found = told(c, 0 * c)

    def allowed(turned: float | None) -> float:
        (one,) = likenesses(found, {lookup("B4"): 1}, HALF, TENTH, turned)
        return one.allowed - one.error

    assert allowed(0.0) == 0
    assert 0 < allowed(1e-4) < allowed(1e-2) < allowed(None)
    first_order = allowed(1e-4) - 1e-8 * 0.775  # the square of the angle, of the pole's size
    assert allowed(2e-4) - 4e-8 * 0.775 == pytest.approx(2 * first_order, rel=1e-4)


def test_rows_several_steps_apart_have_powers_of_the_poles() -> None:
    c = responses_of(lookup("SYM"), 0.05, 0.01, 900)[::3]
    found = told(c, 0 * c)
    assert found.pole == pytest.approx(complex(dominant_pole(lookup("SYM"), 0.05, 0.01)) ** 3, abs=1e-6)
    like = likenesses(found, dict.fromkeys(ALL, 3), Fraction(1, 20), Fraction(1, 100), turned=0.0)
    assert like[0].fits
    assert "SYM" in (like[0].method.name, like[0].same_as)
    (point,) = points_like(found, lookup("SYM"), 3)
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.05, 0.01), abs=1e-6)


def test_a_method_whose_steps_are_longer_than_the_rows_has_none_between_them() -> None:
    long = lookup("RK4@5")
    assert steps_between_rows(long, 1e-3, 1e-3) is None
    assert steps_between_rows(long, 1e-3, 1e-2) == 2
    assert steps_between_rows(lookup("B4"), 1e-3, 2.001e-3) == 2
    assert steps_between_rows(lookup("B4"), 1e-3, 2.5e-3) is None
    assert steps_between_rows(lookup("B4"), None, 2.5e-3, every=4) == 4


def test_a_method_whose_step_has_no_solution_there_is_left_out() -> None:
    """Average acceleration divides by 1 + alpha_hat / 2 + beta_hat / 4, which is zero at (-3, 2)."""
    c = responses_of(lookup("B4"), 0.5, 0.1)
    own_steps = {lookup("average-acceleration"): 1, lookup("RK2"): 1}
    like = likenesses(told(c, 0 * c), own_steps, Fraction(-3), Fraction(2))
    assert [one.method.name for one in like] == ["RK2"]


def test_a_pole_that_would_have_grown_far_beyond_the_log_is_not_there() -> None:
    """AB7 has a pole of 2.7 at this point, and among its lesser ones some may be near anything."""
    z = poles(lookup("AB7"), 0.5, 0.1)
    assert abs(z[0]) > 1.5
    lesser = complex(z[np.argmin(np.abs(np.abs(z) - 0.7))])
    found = ProbedPole(complex(lesser.real, abs(lesser.imag)), 1e-6, 50, 100, (lesser,), "")
    (one,) = likenesses(found, {lookup("AB7"): 1}, HALF, TENTH)
    assert not one.fits


@pytest.mark.parametrize("name", ["SYM", "B2", "RK2", "verlet-kdk", "hht"])
def test_the_point_is_the_one_that_was_set(name: str) -> None:
    method, point = lookup(name), (0.3, 0.09)
    z = poles(method, *point)
    assert z[0].imag != 0
    upper = tuple(complex(pole) for pole in z if pole.imag >= 0)
    points = points_like(ProbedPole(upper[0], 1e-9, 50, 100, upper, ""), method)
    (one,) = [one for one in points if abs(one.alpha_hat - point[0]) < 1e-7]
    assert one.beta_hat == pytest.approx(point[1], abs=1e-7)
    for one in points:
        assert complex(dominant_pole(method, one.alpha_hat, one.beta_hat)) == pytest.approx(upper[0], abs=1e-6)


@pytest.mark.parametrize(("name", "point"), [("bdf2", (2.3, 3.1)), ("B2", (1.3, 0.8)), ("implicit-euler", (1.7, 4.3))])
def test_so_is_a_point_far_out(name: str, point: tuple[float, float]) -> None:
    method = lookup(name)
    pole = complex(dominant_pole(method, *point))
    assert pole.imag != 0
    points = points_like(ProbedPole(pole, 1e-9, 50, 100, (pole,), ""), method)
    assert any((one.alpha_hat, one.beta_hat) == pytest.approx(point, abs=1e-7) for one in points)


def test_two_real_poles_give_a_point_and_one_leaves_a_curve() -> None:
    method = lookup("SYM")
    z = [complex(pole) for pole in poles(method, 0.9, 0.1)]
    assert [pole.imag for pole in z] == [0, 0]
    (point,) = points_like(ProbedPole(z[0], 1e-7, 50, 100, tuple(z), ""), method)
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.9, 0.1), abs=1e-9)
    assert 0 < point.alpha_hat_error < 1e-5
    with pytest.raises(InputError, match="curve of points"):
        points_like(ProbedPole(z[0], 1e-7, 50, 100, (z[0],), ""), method)


def test_two_poles_of_one_mu_leave_a_curve() -> None:
    """At real mu BDF3 has a real pole and a complex pair; the pair belongs to that mu alone, whatever the other is."""
    method = lookup("bdf3")
    point = (5.385535894453755, 4.792894556078089)
    z = poles(method, *point)
    assert point[0] ** 2 > 4 * point[1]
    assert z[0].imag != 0
    upper = complex(z[0].real, abs(z[0].imag))
    with pytest.raises(InputError, match="curve of points"):
        points_like(ProbedPole(upper, 1e-9, 50, 100, (upper,), ""), method)


def test_the_stated_error_of_a_point_covers_a_pole_off_by_the_stated_error() -> None:
    method, point, error = lookup("B4"), (0.5, 0.1), 1e-6
    pole = complex(dominant_pole(method, *point)) + error * np.exp(0.7j)
    (found,) = points_like(ProbedPole(pole, error, 50, 100, (pole,), ""), method)
    assert abs(found.alpha_hat - point[0]) <= found.alpha_hat_error
    assert abs(found.beta_hat - point[1]) <= found.beta_hat_error


# Logs that show less than one would like


def test_what_two_runs_share_goes() -> None:
    k = np.arange(300)
    response, forced = 1e-4 * two_poles(300, 0.9, 0.5, 1.0, 0.5), 1e-3 * np.sin(0.01 * k) + 0.3
    assert told(response + forced, forced - response).pole == pytest.approx(0.9 * np.exp(0.5j), abs=1e-6)


@pytest.mark.parametrize("offset", [1e-8, 1e-6, 1e-4, -1e-3, 0.3])
def test_a_constant_offset_goes_and_is_said(offset: float) -> None:
    found = told(1e-3 * two_poles(300, 0.9, 0.5, 1.0, 0.5) + offset)
    assert found.pole == pytest.approx(0.9 * np.exp(0.5j), abs=1e-5)
    assert "taken off" in found.reason or abs(offset) < 1e-7


def test_a_plateau_that_a_motion_forces_is_never_taken_for_a_pole() -> None:
    k = np.arange(600)
    for size in (1e-9, 1e-7, 1e-6, 1e-5):
        found = probed_pole(1e-4 * two_poles(600, 0.7, 1.0, 1.0, 0.5) + size * np.cos(0.003 * k + 1))
        assert found.pole is None or found.pole == pytest.approx(0.7 * np.exp(1j), abs=1e-4)


def test_a_slow_pole_of_one_run_is_told_with_a_warning() -> None:
    found = told(1e-3 * geometric(600, 0.99))
    assert found.pole == pytest.approx(0.99, abs=1e-6)
    assert "may be forced" in found.reason


def test_a_pole_on_the_circle_is_flagged_and_in_one_run_refused() -> None:
    c = 1e-3 * np.cos(0.5 * np.arange(300))
    assert probed_pole(c).pole is None
    assert "on" not in probed_pole(c).reason.split()[:1]
    of_two = told(c, 0 * c)
    assert of_two.pole == pytest.approx(np.exp(0.5j), abs=1e-6)
    assert "marginal" in of_two.reason


@pytest.mark.parametrize("modulus", [1.02, 1.3, 2.0])
def test_growth_out_of_a_small_kick_is_told_although_it_saturates(modulus: float) -> None:
    c = 1e-8 * two_poles(round(25 / np.log(modulus)), modulus, 0.5, 1.0, 0.5)
    c = np.tanh(c[np.abs(c) < 3])
    assert told(c, 0 * c).pole == pytest.approx(modulus * np.exp(0.5j), abs=1e-3)


def test_a_pole_is_told_out_of_noise_and_noise_is_told_as_noise() -> None:
    random = np.random.default_rng(3)
    c = two_poles(300, 0.95, 0.5, 1.0, 0.5) + 0.01 * random.normal(size=300)
    for found in (told(c), told(c, 0 * c)):
        assert abs(complex(found.pole or 0) - 0.95 * np.exp(0.5j)) < (found.uncertainty or 0) < 0.01
        assert "in noise of 0.0" in found.reason
    found = probed_pole(random.normal(size=300))
    assert found.pole is None
    assert found.reason.startswith("noise of ")


def test_coarse_rounding_is_refused_and_said() -> None:
    c = np.round(1e-3 * two_poles(300, 0.95, 0.5, 1.0, 0.5), 5)
    found = probed_pole(c)
    assert found.pole is None
    assert "rounded to 1e-05" in found.reason
    sixteenths = np.round(two_poles(300, 0.95, 0.5, 1.0, 0.5) * 256) / 256  # of a quantiser, with many decimals
    assert "rounded to 0.00391" in probed_pole(sixteenths).reason


def test_powers_of_one_half_are_not_taken_for_a_quantiser() -> None:
    assert told(0.5 ** np.arange(40.0), np.zeros(40)).pole == pytest.approx(0.5, abs=1e-9)


@pytest.mark.parametrize(
    ("c", "said"),
    [
        (np.zeros(0), "0 samples: at least 12"),
        (geometric(FEWEST - 1, 0.5), "11 samples"),
        (np.full(100, 0.25), "nothing changes"),
        (np.zeros(100), "nothing changes"),
        (np.append([1.0, -0.5], np.zeros(98)), "gone after 2 rows"),
        (np.append(geometric(5, 0.5), np.full(95, np.nan)), "row 6 holds no number"),
    ],
)
def test_too_little_is_refused(c: FloatArray, said: str) -> None:
    found = probed_pole(c)
    assert found.pole is None
    assert said in found.reason
    assert ("holds no number" in found.reason) == bool(np.isnan(c).any())


def test_a_missing_number_ends_the_log_and_is_said() -> None:
    c = two_poles(300, 0.9, 0.5, 1.0, 0.5)
    c[150:] = np.nan
    found = told(c, 0 * c)
    assert found.pole == pytest.approx(0.9 * np.exp(0.5j), abs=1e-6)
    assert "row 151" in found.reason


def test_rows_before_the_kick_do_not_count() -> None:
    c = np.append(np.zeros(40), two_poles(200, 0.9, 0.5, 1.0, 0.5))
    forced = np.sin(0.01 * np.arange(240))
    assert told(c + forced, forced).pole == pytest.approx(0.9 * np.exp(0.5j), abs=1e-4)


def test_columns_of_one_system_are_fitted_jointly() -> None:
    pair = np.stack([two_poles(300, 0.9, 0.5, 1.0, 0.5), 1e-3 * two_poles(300, 0.9, 0.5, 2.0, 0.4)], axis=1)
    assert told(pair, 0 * pair).pole == pytest.approx(0.9 * np.exp(0.5j), abs=1e-6)
    with pytest.raises(InputError, match="minus has 1 responses, c has 2"):
        probed_pole(pair, pair[:, :1])
    with pytest.raises(InputError, match="3 dimensions"):
        probed_pole(np.zeros((20, 2, 2)))


def test_a_users_step_is_kicked_both_ways_and_by_parts_of_the_kick() -> None:
    def step(state: FloatArray) -> FloatArray:
        return 0.9 * state + 0.1

    responses = kicked_responses(step, [1.0, 2.0], lambda state: float(state[0] + state[1] ** 2), [1e-3, 0.0], 50)
    assert responses.shape == (51, 5)
    assert responses[:, 0] == pytest.approx(1e-3 * geometric(51, 0.9), rel=1e-9)
    assert responses[:, -1] == pytest.approx(1e-4 * responses[:, 0], abs=1e-15)  # rounding of one
    grown = kicked_responses(lambda state: 1e60 * state, [1.0], lambda state: float(state[0]), [1e-3], 50)
    assert np.isfinite(grown[:6]).all()
    assert np.isnan(grown[6:]).all()
    with pytest.raises(InputError, match=r"kick has shape \(1,\), the state has \(2,\)"):
        kicked_responses(step, [1.0, 2.0], lambda state: 0.0, [1e-3], 50)


# Random methods, points and scenes


def outcome(log: RandomLog, found: ProbedPole, turned: float | None) -> str:
    """Return what came of a log: the true method first, or among those that fit, no pole with a reason, or wrong."""
    if found.pole is None:
        assert found.reason
        return "no pole"
    like = likenesses(found, ALL, log.alpha_hat, log.beta_hat, turned=turned)
    (true,) = [one for one in like if one.method.name == log.method.name]
    if not true.fits:
        return "wrong"
    return "first" if log.method.name in (like[0].method.name, *like[0].same_as.split(", ")) else "among"


@pytest.mark.promise(
    "`probe`: logs of 600 random runs, all methods, nine digits",
    measured=(
        "where a pole is told (four in five) the true method is the first (nine in ten) or among those that fit, "
        "whether or not it is said how fast the mechanism turns; else it is said why none is"
    ),
)
@pytest.mark.slow
@pytest.mark.parametrize("seed", of_campaign([1, 2, 7], [1]))
def test_the_true_method_is_named_whatever_made_the_log(seed: int) -> None:
    """Of random logs it is first or among those that fit, whether or not one knows how fast the mechanism turns.

    Some four fifths show a pole. The others grow to a metre within a few rows, or are one run that shows next to
    nothing but what the motion forces.
    """
    count = of_campaign(200, 10)
    counts: Counter[str] = Counter()
    for log in random_logs(count=count, seed=seed, rows=250):
        found = probed_pole(log.c, log.minus)
        counts.update(outcome(log, found, turned) for turned in (log.turning * H, None))
    assert set(counts) <= {"first", "among", "no pole"}
    told = counts["first"] + counts["among"]
    assert told >= 0.65 * 2 * count  # of 60 logs four fifths, of ten ones more or less
    assert counts["first"] >= 0.8 * told  # nine tenths of 60


@pytest.mark.slow
@pytest.mark.parametrize("name", list(REGISTRY)[:: of_campaign(1, 8)])
def test_every_method_is_inverted_at_a_random_point(name: str) -> None:
    method = lookup(name)
    random = np.random.default_rng(11)
    low, high = np.transpose(window(region(method)))
    while True:
        alpha_hat, beta_hat = random.uniform(low, high).tolist()
        z = poles(method, alpha_hat, beta_hat)
        if alpha_hat**2 < 4 * beta_hat and z[0].imag != 0 and abs(z[0]) < 1.2:
            break
    pole = complex(z[0].real, abs(z[0].imag))
    points = points_like(ProbedPole(pole, 1e-9, 50, 100, (pole,), ""), method)
    assert any(
        abs(one.alpha_hat - alpha_hat) < 1e-5 * high[0] and abs(one.beta_hat - beta_hat) < 1e-5 * high[1]
        for one in points
    )
