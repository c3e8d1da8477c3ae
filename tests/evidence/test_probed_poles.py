"""Poles found in logs: those that were put in, never others; and whose they are."""

from collections import Counter
from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.evidence import (
    Likeness,
    ProbedPole,
    kicked_responses,
    likenesses,
    points_like,
    probed_pole,
)
from bezstab.evidence.probed_poles import FEWEST
from bezstab.mechanism import compiled_mechanism, load_scene, simulated
from bezstab.methods import REGISTRY, lookup
from bezstab.stability import FloatArray, dominant_pole, poles, region, window
from tests.evidence.random_logs import H, RandomLog, random_logs
from tests.evidence.samples import of_campaign
from tests.reference.sampled_responses import geometric, of_poles, two_poles

ALL = dict.fromkeys(map(lookup, REGISTRY), 1)
"""All methods, with one of their steps from row to row."""
POINT = Fraction(1, 2), Fraction(1, 10)
ROUNDING = 1e-12
"""Of distances: methods with the same polynomial, but for factors of z, do not always share the last bit of a pole."""


def of_method(name: str, alpha_hat: float = 0.5, beta_hat: float = 0.1, every: int = 1) -> ProbedPole:
    """Return what is probed of two runs of a method at a point, whose rows are so many steps apart."""
    c = of_poles(poles(lookup(name), alpha_hat, beta_hat), 300 * every, seed=1)[::every]
    return told(c, 0 * c)


def told(c: FloatArray, minus: FloatArray | None = None) -> ProbedPole:
    """Return the probed pole, which must be there."""
    found = probed_pole(c, minus)
    assert found.pole is not None, found.reason
    return found


def test_methods_with_the_same_polynomial_are_equally_near() -> None:
    like = {one.method.name: one for one in likenesses(of_method("AB2"), ALL, *POINT)}
    for one, other in (("B2", "AB2"), ("SYM", "verlet-half"), ("trapezoid", "average-acceleration")):
        assert like[one].distance == pytest.approx(like[other].distance, abs=ROUNDING)
    assert not like["RK4"].fits


def test_the_faster_the_mechanism_the_more_is_allowed() -> None:
    found = of_method("B4")
    by_turning: list[Likeness] = [
        one for turned in (0.0, 1e-4, 1e-2, None) for one in likenesses(found, {lookup("B4"): 1}, *POINT, turned)
    ]
    allowed = [one.allowed - one.error for one in by_turning]
    assert allowed[0] == 0
    assert allowed == sorted(set(allowed))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("alpha_hat", ["2", "2.000000000001", "1.999999999999", "1.9998", "2.0002"])
def test_what_fits_only_because_so_much_is_allowed_is_not_told(alpha_hat: str) -> None:
    """Near a double pole, and where a huge pole is followed over several steps, a motion may do anything."""
    found = with_pole(complex(0.375))
    far = [one for one in likenesses(found, dict.fromkeys(ALL, 10), Fraction(alpha_hat), Fraction(1)) if one.fits]
    assert any(one.distance > 1e9 for one in far)
    assert not any(one.told for one in far if one.distance > 0.375)


def test_rows_several_steps_apart_have_powers_of_the_poles() -> None:
    found = of_method("SYM", 0.05, 0.01, every=3)
    assert found.pole == pytest.approx(complex(dominant_pole(lookup("SYM"), 0.05, 0.01)) ** 3, abs=1e-6)
    like = likenesses(found, dict.fromkeys(ALL, 3), Fraction(1, 20), Fraction(1, 100), turned=0.0)
    assert like[0].fits
    assert "SYM" in [one.method.name for one in like if one.distance < like[0].distance + ROUNDING]
    (point,), _ = points_like(found, lookup("SYM"), 3)
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.05, 0.01), abs=1e-6)


def with_pole(z: complex, error: float = 1e-9, others: tuple[complex, ...] = ()) -> ProbedPole:
    """Return what a log of 100 rows has shown, the pole in the upper half plane."""
    upper = complex(z.real, abs(z.imag))
    return ProbedPole(upper, error, 50, 100, (upper, *others), "")


def test_a_pole_that_would_have_grown_far_beyond_the_log_is_not_there() -> None:
    """AB7 has a pole of 2.7 at this point, and among its lesser ones some may be near anything."""
    z = poles(lookup("AB7"), 0.5, 0.1)
    assert abs(z[0]) > 1.5
    lesser = with_pole(complex(z[np.argmin(np.abs(np.abs(z) - 0.7))]), 1e-6)
    (one,) = likenesses(lesser, {lookup("AB7"): 1}, *POINT)
    assert not one.fits


def random_point(name: str) -> tuple[float, float]:
    """Return a point in or around the region of a method where mu and the pole are complex."""
    method, random = lookup(name), np.random.default_rng(11)
    low, high = np.transpose(window(region(method)))
    while True:
        alpha_hat, beta_hat = random.uniform(low, high).tolist()
        z = dominant_pole(method, alpha_hat, beta_hat)
        if alpha_hat**2 < 4 * beta_hat and z.imag != 0 and abs(z) < 1.2:
            return alpha_hat, beta_hat


@pytest.mark.parametrize(
    ("name", "point"),
    [
        *((name, (0.3, 0.09)) for name in ("SYM", "B2", "RK2", "verlet-kdk", "hht")),
        ("ABM3", (0.3, 0.09)),  # elsewhere this is one of its lesser poles
        *(("bdf2", (2.3, 3.1)), ("B2", (1.3, 0.8)), ("implicit-euler", (1.7, 4.3))),  # far out
        *(pytest.param(name, None, marks=pytest.mark.slow) for name in list(REGISTRY)[:: of_campaign(1, 8)]),
    ],
)
def test_the_point_is_the_one_that_was_set(name: str, point: tuple[float, float] | None) -> None:
    """To the stated error of it where the pole is off by the stated error."""
    method, point, error = lookup(name), point or random_point(name), 1e-9
    z = complex(dominant_pole(method, *point))
    points, _ = points_like(with_pole(z + error * np.exp(0.7j), error), method)
    assert any(
        abs(one.alpha_hat - point[0]) < 1.01 * one.alpha_hat_error < 1e-5
        and abs(one.beta_hat - point[1]) < 1.01 * one.beta_hat_error < 1e-5
        for one in points
    )
    for one in points:
        found = complex(dominant_pole(method, one.alpha_hat, one.beta_hat))
        assert complex(found.real, abs(found.imag)) == pytest.approx(complex(z.real, abs(z.imag)), abs=1e-6)


def test_two_real_poles_give_a_point_and_one_or_two_of_one_mu_leave_a_curve() -> None:
    """At real mu BDF3 has a real pole and a complex pair; the pair belongs to that mu alone, whatever the other is."""
    sym, bdf3 = lookup("SYM"), lookup("bdf3")
    first, second = (complex(pole) for pole in poles(sym, 0.9, 0.1))
    assert first.imag == second.imag == 0
    (point,), _ = points_like(with_pole(first, 1e-7, others=(second,)), sym)
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.9, 0.1), abs=1e-9)
    assert 0 < point.alpha_hat_error < 1e-5
    of_pair = complex(dominant_pole(bdf3, 5.385535894453755, 4.792894556078089))
    assert of_pair.imag != 0
    for method, pole in ((sym, first), (bdf3, of_pair)):
        none, reason = points_like(with_pole(pole), method)
        assert not none
        assert "curve of points" in reason


# Logs that show less than one would like


ROWS = np.arange(300)
RESPONSE, Z = two_poles(300, 0.9, 0.5, 1.0, 0.5), 0.9 * np.exp(0.5j)
FORCED = 1e-3 * np.sin(0.01 * ROWS) + 0.3
ENDS = np.where(ROWS < 150, RESPONSE, np.nan)
LATE = np.append(np.zeros(40), RESPONSE)
ON_THE_CIRCLE = 1e-3 * np.cos(0.5 * ROWS)


def growing(modulus: float) -> FloatArray:
    """Return growth out of a small kick that saturates."""
    c = 1e-8 * two_poles(round(25 / np.log(modulus)), modulus, 0.5, 1.0, 0.5)
    return np.tanh(c[np.abs(c) < 3])


@pytest.mark.parametrize(
    ("c", "minus", "pole", "within", "said"),
    [
        (1e-4 * RESPONSE + FORCED, FORCED - 1e-4 * RESPONSE, Z, 1e-6, ""),  # what two runs share goes
        *((1e-3 * RESPONSE + offset, None, Z, 1e-5, "taken off") for offset in (1e-6, 1e-4, -1e-3, 0.3)),
        (1e-3 * geometric(600, 0.99), None, 0.99, 1e-6, "may be forced"),
        (ON_THE_CIRCLE, 0 * ON_THE_CIRCLE, np.exp(0.5j), 1e-6, "marginal"),
        (0.5 ** np.arange(40.0), np.zeros(40), 0.5, 1e-9, ""),
        (ENDS, np.zeros(300), Z, 1e-6, "row 151"),  # a missing number ends the log
        (LATE + 1e-3 * FORCED[0], np.full(340, 1e-3 * FORCED[0]), Z, 1e-4, ""),  # rows before the kick do not count
        (np.stack([RESPONSE, 1e-3 * two_poles(300, 0.9, 0.5, 2.0, 0.4)], axis=1), np.zeros((300, 2)), Z, 1e-6, ""),
        *((growing(z), 0 * growing(z), z * np.exp(0.5j), 1e-3, "") for z in (1.02, 1.3, 2.0)),
    ],
)
def test_the_pole_is_told_and_what_is_to_be_kept_in_mind(
    c: FloatArray, minus: FloatArray | None, pole: complex, within: float, said: str
) -> None:
    found = told(c, minus)
    assert found.pole == pytest.approx(pole, abs=within)
    assert said in found.reason


@pytest.mark.parametrize("size", [1e-9, 1e-7, 1e-6, 1e-5])
def test_a_plateau_that_a_motion_forces_is_never_taken_for_a_pole(size: float) -> None:
    found = probed_pole(1e-4 * two_poles(600, 0.7, 1.0, 1.0, 0.5) + size * np.cos(0.003 * np.arange(600) + 1))
    assert found.pole is None or found.pole == pytest.approx(0.7 * np.exp(1j), abs=1e-4)


@pytest.mark.parametrize(
    ("scene", "name", "h", "rows", "kick", "point"),
    [
        ("four_bar", "B4", 0.001, 600, 1e-4, (0.02, 1e-4)),
        ("slider_crank_300rpm", "SYM", 0.002, 1000, 1e-4, (0.050207, 0.00063019)),
        ("driven_four_bar", "B4", 0.005, 600, 1e-6, (0.032623, 0.00106425)),
    ],
)
def test_what_a_fast_motion_forces_is_not_taken_for_growth(
    scene: str, name: str, h: float, rows: int, kick: float, point: tuple[float, float]
) -> None:
    """A few growing poles go from sample to sample through what is forced of one run, but do not follow it for long."""
    mechanism, method = compiled_mechanism(load_scene(scene)), lookup(name)
    alpha_hat, beta_hat = point
    run = simulated(mechanism, method, h=h, duration=rows * h, alpha_hat=alpha_hat, beta_hat=beta_hat, perturb=kick)
    found = probed_pole(run.c[:, 0])
    assert abs(dominant_pole(method, *point)) < 1
    assert found.pole is None
    assert "forced" in found.reason


@pytest.mark.parametrize("modulus", [1.02, 1.3, 2.0])
def test_growth_is_told_of_one_run(modulus: float) -> None:
    assert told(growing(modulus)).pole == pytest.approx(modulus * np.exp(0.5j), abs=1e-3)


@pytest.mark.parametrize(
    ("c", "said"),
    [
        (geometric(FEWEST - 1, 0.5), "11 samples"),
        (np.full(100, 0.25), "nothing changes"),
        (ON_THE_CIRCLE, "|z| is one"),
        (np.round(1e-3 * RESPONSE, 5), "rounded to 1e-05"),
        (np.append([1.0, -0.5], np.zeros(98)), "gone after 2 rows"),
        (np.append(geometric(5, 0.5), np.full(95, np.nan)), "row 6 holds no number"),
    ],
)
def test_too_little_is_refused(c: FloatArray, said: str) -> None:
    found = probed_pole(c)
    assert found.pole is None
    assert said in found.reason


def test_a_users_step_is_kicked_by_parts_of_the_kick_until_an_error_is_not_finite() -> None:
    grown = kicked_responses(lambda state: 1e60 * state, [1.0], lambda state: float(state[0]), [1e-3], 50)
    assert grown[0] == pytest.approx(1e-3 * 10.0 ** -np.arange(5), abs=1e-15)
    assert np.isfinite(grown[:6]).all()
    assert np.isnan(grown[6:]).all()


def test_arrays_of_other_shapes_are_refused() -> None:
    with pytest.raises(InputError, match="minus has 1 responses, c has 2"):
        probed_pole(np.zeros((20, 2)), np.zeros((20, 1)))
    with pytest.raises(InputError, match="3 dimensions"):
        probed_pole(np.zeros((20, 2, 2)))
    with pytest.raises(InputError, match=r"kick has shape \(1,\), the state has \(2,\)"):
        kicked_responses(lambda state: state, [1.0, 2.0], lambda state: 0.0, [1e-3], 50)


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
    return "first" if true.distance < like[0].distance + ROUNDING else "among"


@pytest.mark.slow
@pytest.mark.parametrize("seed", of_campaign([1, 2, 7], [1]))
def test_the_true_method_is_named_whatever_made_the_log(seed: int) -> None:
    """Logs without a pole grow to a metre within a few rows, or are one run that shows next to nothing but forcing."""
    count = of_campaign(200, 8)
    counts: Counter[str] = Counter()
    for log in random_logs(count=count, seed=seed, rows=250):
        found = probed_pole(log.c, log.minus)
        counts.update(outcome(log, found, turned) for turned in (log.turning * H, None))
    assert set(counts) <= {"first", "among", "no pole"}
    told = counts["first"] + counts["among"]
    assert told >= 0.65 * 2 * count  # of 60 logs four fifths, of ten ones more or less
    assert counts["first"] >= 0.8 * told  # nine tenths of 60
