"""Poles found in logs: those that were put in, never others; and whose they are."""

import re
from fractions import Fraction

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import simulated
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.probes.probed_poles import FEWEST, SAME, likenesses, point_like, probed_pole
from bezstab.rationals import exact
from bezstab.runs.kicks import kicked_motions
from bezstab.runs.linear_prediction import Fit
from bezstab.stability.arrays import FloatArray
from bezstab.stability.closed_loop import dominant_pole, poles, spectral_radius
from tests.reference.sampled_responses import geometric, of_poles, two_poles

ALL = list(map(lookup, REGISTRY))
POINT = Fraction(1, 2), Fraction(1, 10)


def with_pole(z: complex, error: float = 1e-9, others: tuple[complex, ...] = ()) -> Fit:
    """Return what a log has shown, the pole in the upper half plane."""
    return Fit((complex(z.real, abs(z.imag)), *others), 0.0, 0, 50, error)


def fitted(c: FloatArray, minus: FloatArray | None = None) -> Fit:
    """Return the fit of a log that shows a pole."""
    fit, reason = probed_pole(c, minus)
    assert fit, reason
    return fit


def of_method(name: str, alpha_hat: float = 0.5, beta_hat: float = 0.1, every: int = 1) -> Fit:
    """Return what two runs of a method at a point show, whose rows are so many steps apart."""
    c = of_poles(poles(lookup(name), alpha_hat, beta_hat), 300 * every, seed=1)[::every]
    return fitted(c, 0 * c)


def rounded(c: FloatArray, digits: int) -> FloatArray:
    """Return numbers as they are written with so many digits."""
    return np.array([float(f"{value:.{digits}g}") for value in c])


def names_told(found: Fit, names: list[str], turned: float = 0.0) -> list[str]:
    return [one.method.name for one in likenesses(found, map(lookup, names), 1, *POINT, turned) if one.fits]


def test_methods_with_one_polynomial_have_the_pole_together() -> None:
    names = ["RK4", "SYM", "AB2", "B2", "trapezoid"]
    assert sorted(names_told(of_method("AB2"), names)) == ["AB2", "B2"]
    assert names_told(of_method("SYM"), ["verlet-half", *names]) in (["verlet-half", "SYM"], ["SYM", "verlet-half"])
    assert names_told(of_method("B4"), names) == []


def test_there_is_no_answer_where_more_is_allowed_than_methods_differ_by() -> None:
    one, other = (complex(dominant_pole(lookup(name), 0.5, 0.1)) for name in ("RK4", "RK3"))
    for pole, allowed, names in (
        (one, 0.9, ["RK4"]),
        (one, 1.1, []),
        (one + 0.5 * (one - other), 1.1, []),  # RK3 does not fit, but is too near to RK4
        ((one + other) / 2, 0.6, []),  # both fit, though they differ by more than is allowed
    ):
        assert names_told(with_pole(pole, allowed * abs(one - other)), ["RK3", "RK4"]) == names


def test_rows_several_steps_apart_have_powers_of_the_poles() -> None:
    found = of_method("SYM", 0.05, 0.01, every=3)
    assert found.pole == pytest.approx(complex(dominant_pole(lookup("SYM"), 0.05, 0.01)) ** 3, abs=1e-6)
    like = likenesses(found, ALL, 3, Fraction(1, 20), Fraction(1, 100), turned=0.0)
    assert "SYM" in [one.method.name for one in like if one.fits]
    point = point_like(found, lookup("SYM"), 3)
    assert point
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.05, 0.01), abs=1e-6)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("alpha_hat", ["1", "2", "1.9998"])
def test_poles_that_meet_vanish_or_overflow_are_no_answer(alpha_hat: str) -> None:
    """Near a double pole a motion may do anything, as where a huge pole is followed over many steps."""
    found = likenesses(with_pole(complex(0.3)), ALL, 1000, Fraction(alpha_hat), Fraction(1), 0.03)
    assert not any(one.fits for one in found)


@pytest.mark.parametrize(
    ("name", "point"),
    [*((name, (0.3, 0.09)) for name in ("SYM", "B2", "RK2", "verlet-kdk", "hht")), ("implicit-euler", (1.7, 4.3))],
)
def test_a_point_that_is_found_is_the_one_that_was_set_to_what_an_error_of_the_pole_comes_to(
    name: str, point: tuple[float, float]
) -> None:
    method, error = lookup(name), 1e-9
    z = complex(dominant_pole(method, *point))
    for off in (0, np.exp(0.7j), -1):
        found = point_like(with_pole(z + error * off, error), method)
        assert found
        assert abs(found.alpha_hat - point[0]) < 1.01 * found.alpha_hat_error < 1e-4
        assert abs(found.beta_hat - point[1]) < 1.01 * found.beta_hat_error < 1e-4


def test_two_real_poles_give_a_point_and_one_or_two_of_one_mu_leave_a_curve() -> None:
    """At real mu BDF3 has a real pole and a complex pair; the pair belongs to that mu alone, whatever the other is."""
    sym, bdf3 = lookup("SYM"), lookup("bdf3")
    first, second = map(complex, poles(sym, 0.9, 0.1).real)
    point = point_like(with_pole(first, 1e-7, others=(second,)), sym)
    assert point
    assert (point.alpha_hat, point.beta_hat) == pytest.approx((0.9, 0.1), abs=1e-9)
    of_pair = complex(dominant_pole(bdf3, 5.385535894453755, 4.792894556078089))
    assert of_pair.imag != 0
    assert point_like(with_pole(of_pair), bdf3) is None
    assert point_like(with_pole(first), sym) is None


# Logs that show less than one would like


ROWS = np.arange(300)
RESPONSE, Z = two_poles(300, 0.9, 0.5, 1.0, 0.5), 0.9 * np.exp(0.5j)
FORCED = 1e-3 * np.sin(0.01 * ROWS) + 0.3
ENDS = np.where(ROWS < 150, RESPONSE, np.nan)
LATE = np.append(np.zeros(40), RESPONSE)
PARTING = RESPONSE * (1 + 1e-5 * np.sin(ROWS**2)) + 3e-5 * geometric(300, 1.02)  # two motions that drift apart
ON_THE_CIRCLE = 1e-3 * np.cos(0.5 * ROWS)


def growing(modulus: float) -> FloatArray:
    """Return growth out of a small kick that saturates."""
    c = 1e-8 * two_poles(round(25 / np.log(modulus)), modulus, 0.5, 1.0, 0.5)
    return np.tanh(c[np.abs(c) < 3])


@pytest.mark.parametrize(
    ("c", "minus", "pole", "within"),
    [
        (1e-4 * RESPONSE + FORCED, FORCED - 1e-4 * RESPONSE, Z, 1e-6),  # what two runs share goes
        (1e-4 * RESPONSE + 1e-8 * np.cos(0.003 * ROWS), np.zeros(300), Z, 1e-6),  # what they do not, is small
        (1e-3 * RESPONSE, None, Z, 1e-6),
        (0.5 ** np.arange(40.0), np.zeros(40), 0.5, 1e-9),
        (ENDS, np.zeros(300), Z, 1e-6),  # a missing number ends the log
        (LATE + 1e-3 * FORCED[0], np.full(340, 1e-3 * FORCED[0]), Z, 1e-4),  # rows before the kick do not count
        (1e-4 * RESPONSE + 1e-7 * np.cos(0.003 * ROWS), np.zeros(300), Z, 1e-3),  # changes show what hides in errors
        (np.round(1e-3 * RESPONSE, 9), np.zeros(300), Z, 1e-3),  # nine decimals
        (PARTING, np.zeros(300), Z, 1e-3),
        *((growing(z), minus, z * np.exp(0.5j), 1e-3) for z in (1.02, 1.3, 2.0) for minus in (None, 0 * growing(z))),
    ],
)
def test_the_pole_is_told_to_its_stated_error(
    c: FloatArray, minus: FloatArray | None, pole: complex, within: float
) -> None:
    found = fitted(c, minus)
    assert found.pole == pytest.approx(pole, abs=min(within, found.uncertainty))
    assert found.uncertainty < 0.05


@pytest.mark.parametrize("distance", [0.0, 1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("digits", [6, 9])
def test_two_close_poles_widen_the_error(distance: float, digits: int) -> None:
    """Two look like one between them, or like two others: how far off, noise decides, or no pole is told."""
    k = np.arange(200.0)
    both = 0.9**k + (0.9 - distance) ** k if distance else 0.9**k * (1 + 0.1 * k)
    one, (two, _) = fitted(rounded(0.9**k, digits)), probed_pole(rounded(both, digits))
    assert one.pole == pytest.approx(0.9, abs=one.uncertainty)
    if two is None:
        assert digits == 6
        return
    assert two.pole == pytest.approx(0.9, abs=two.uncertainty)
    assert digits == 6 or two.uncertainty > 3 * one.uncertainty


@pytest.mark.parametrize(
    ("c", "minus", "said"),
    [
        (geometric(FEWEST - 1, 0.5), None, "11 rows"),
        (np.zeros(300), None, "0 rows from the kick on"),
        (ON_THE_CIRCLE, None, "neither dies nor grows.*--minus"),
        (ON_THE_CIRCLE, 0 * ON_THE_CIRCLE, "neither dies nor grows.*kick harder$"),
        (1e-3 * geometric(600, 0.99), None, "hardly changes from row to row.*--minus"),
        (0.3 + 1e-3 * RESPONSE, None, "--minus"),
        (np.round(1e-3 * RESPONSE, 5), None, "log more digits, or kick harder"),
        (RESPONSE + 1e-2 * np.random.default_rng(1).normal(size=300), None, "log more digits, or kick harder"),
        (np.abs(np.cos(0.7 * ROWS) * 0.9**ROWS), None, "log more digits, or kick harder"),
    ],
)
def test_too_little_is_refused(c: FloatArray, minus: FloatArray | None, said: str) -> None:
    fit, reason = probed_pole(c, minus)
    assert fit is None
    assert re.search(said, reason), reason


@pytest.mark.parametrize(
    ("scene", "name", "h", "kick", "point"),
    [
        ("slider_crank_300rpm", "SYM", 0.002, 1e-4, (0.050207, 0.00063019)),
        ("driven_four_bar", "B4", 0.005, 1e-6, (0.032623, 0.00106425)),
    ],
)
def test_what_a_fast_motion_forces_is_not_taken_for_growth(
    scene: str, name: str, h: float, kick: float, point: tuple[float, float]
) -> None:
    """A few growing poles go from sample to sample through what is forced of one run, but do not follow it for long."""
    mechanism, (alpha_hat, beta_hat) = compiled_mechanism(load_scene(scene)), point
    run = simulated(mechanism, lookup(name), h=h, duration=2.0, alpha_hat=alpha_hat, beta_hat=beta_hat, perturb=kick)
    assert abs(dominant_pole(lookup(name), *point)) < 1
    assert "--minus" in probed_pole(run.c[:, 0])[1]


TURNING = {"pendulum": 2.43, "four_bar": 17.1, "driven_four_bar": 27.4, "slider_crank_300rpm": 9.21}
"""How fast the directions of their constraints turn while a log is written, at most (1/s).

With A = C_q M^-1/2 and its rate B along the motion that is the norm of B, in units in which A A' = 1: of a pendulum
the angular speed.
"""


@pytest.mark.slow
@pytest.mark.parametrize("scene", TURNING)
@pytest.mark.parametrize("digits", [6, 9, 15])
def test_no_other_method_is_named_and_no_pole_is_off_by_more_than_is_stated(scene: str, digits: int) -> None:
    """Of runs kicked up and down, with good gains and critically damped ones, where two poles meet.

    With the least digits, or where the motion forces most, a sixth of the logs has an answer, else up to a half.
    """
    mechanism, told, tried = compiled_mechanism(load_scene(scene)), 0, 0
    alpha_hat, beta_hat = np.array([0.5, 0.2, 0.3]), np.array([0.1, 0.01, 0.08])
    for method in ALL[::4]:
        blocks = kicked_motions(mechanism, method, 1e-3, alpha_hat, beta_hat, [1e-4], 250)
        runs = np.concatenate([c[:, 0, :, 0] for c, _ in blocks])
        for k in np.flatnonzero(spectral_radius(method, alpha_hat, beta_hat) < 1):
            tried += 1
            fit, _ = probed_pole(*(rounded(c, digits) for c in runs[:, :, k].T))
            if fit:
                point = exact(float(alpha_hat[k])), exact(float(beta_hat[k]))
                like = likenesses(fit, ALL, 1, *point, turned=1e-3 * TURNING[scene])
                (own,) = [one for one in like if one.method == method]
                assert own.distance <= own.allowed, (method.name, fit, own)
                named = [one for one in like if one.fits]
                assert all(abs(one.predicted - own.predicted) < SAME for one in named), (method.name, fit, named)
                told += bool(named)
    assert told >= 0.15 * tried
