"""Drives whose torque is held for several steps or applied late: exact verdicts, closed forms, plain simulation."""

from fractions import Fraction
from math import floor, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.drives.held_torque import (
    SEEN,
    STRONGEST,
    closed_loop,
    dominant_pole,
    drive_map,
    law_bounds,
    verdict,
)
from bezstab.drives.limits import Limits, limits
from bezstab.engines.drives import Drive, Timing
from bezstab.methods.registry import lookup

ONE = Fraction(1)
POSITIVE = st.fractions(Fraction(1, 100), 4, max_denominator=1000)


def converges(way: str, a: Fraction, b: Fraction, timing: Timing) -> bool:
    return said(way, a, b, timing) == "converges"


def said(way: str, a: Fraction, b: Fraction, timing: Timing) -> str:
    """Return the verdict of a drive of inertia 1 with steps of 1 s: its gains are the point."""
    return verdict(Drive(kp=b, kd=a, inertia=ONE), ONE, lookup(way), timing)


def limits_of(way: str, a: Fraction, b: Fraction, timing: Timing) -> Limits:
    """Return the limits of a drive of inertia 1 with steps of 1 s: its gains are the point."""
    return limits(Drive(kp=b, kd=a, inertia=ONE), ONE, lookup(way), timing)


LAWS = [
    *(("SYM", Timing(every)) for every in (1, 2, 3, 7, 12)),
    ("SYM", Timing(late=Fraction(1))),
    ("imex-euler", Timing()),
    ("stable-pd", Timing()),
]


@pytest.mark.parametrize(("way", "timing"), LAWS, ids=str)
@given(a=POSITIVE, b=st.fractions(Fraction(1, 100), 12, max_denominator=1000))
@settings(deadline=None, max_examples=20)
def test_a_drive_converges_where_its_law_says(way: str, timing: Timing, a: Fraction, b: Fraction) -> None:
    if way == "SYM":
        a, b = a / 2 / timing.every, b / 6 / timing.every**2  # most of the region lies there
    bounds = law_bounds(way, a, timing)
    assert bounds
    assert all(b < bound for bound in bounds) == converges(way, a, b, timing)


VELOCITY_LIMITS = [  # of alpha_hat, without stiffness: v' = v - a v of so many steps before
    ("SYM", Timing(), 2),
    ("SYM", Timing(every=4), Fraction(1, 2)),
    ("SYM", Timing(late=Fraction(1)), 1),
    ("SYM", Timing(late=Fraction(1, 2)), 2),  # half of it is a step late: z^2 - (1 - a / 2) z + a / 2
    ("SYM", Timing(late=Fraction(2)), 2 * sin(pi / 10)),
    ("imex-euler", Timing(late=Fraction(1)), 2),
]


@pytest.mark.parametrize(("way", "timing", "limit"), VELOCITY_LIMITS, ids=str)
def test_without_stiffness_the_velocity_is_judged(way: str, timing: Timing, limit: Fraction | float) -> None:
    """Late by k steps a pole is on the circle at 2 sin(pi / (4 k + 2)); implicit and one step late is explicit."""
    zero = Fraction(0)
    for factor, expected in ((Fraction("0.999"), "converges"), (Fraction("1.001"), "diverges")):
        assert said(way, factor * Fraction(limit), zero, timing) == expected
    stretch = limits_of(way, Fraction(limit) / 2, zero, timing).kd
    assert stretch == pytest.approx((0, float(limit)), rel=1e-6)


def test_where_no_closed_form_is_known_there_is_no_law() -> None:
    for timing in (Timing(every=2, late=Fraction(1)), Timing(late=Fraction(1, 2)), Timing(filter_steps=Fraction(1))):
        assert law_bounds("SYM", Fraction(1), timing) == ()


def grown(way: str, drive: Drive, timing: Timing, steps: int) -> float:
    """Return how much |x| + |v| grows in many steps, as a controller and a physics engine would compute it."""
    a, b, ki = map(float, (drive.kd, drive.kp, drive.ki))
    x, v, filtered, summed = 1.0, 0.3, 0.3, 0.0
    left = float(timing.late - floor(timing.late))
    gain = float(1 / (1 + timing.filter_steps / timing.every)) if timing.filter_steps else 1.0
    computed: dict[int, float] = {}

    def of_step(step: int) -> float:
        """The torque that was computed last by a step, 0 before the first."""
        return computed.get(step // timing.every * timing.every, 0.0)

    def torque_applied(step: int) -> float:
        due = step - floor(timing.late)
        return (1 - left) * of_step(due) + left * of_step(due - 1)

    def controller(seen_x: float, seen_v: float) -> tuple[float, float, float]:
        seen, total = filtered + gain * (seen_v - filtered), summed + timing.every * seen_x
        return -b * seen_x - a * seen - ki * total, seen, total

    def seen(step: int, guess: float) -> tuple[float, float]:
        """What the way of applying looks at, if the torque computed now is the guess."""
        computed[step] = guess
        p = torque_applied(step)
        return {
            "SYM": (x, v),
            "imex-euler": (x, v + p),
            "stable-pd": (x + v, v + p),
            "implicit-euler": (x + v + p, v + p),
            "RK4": (x, v),
        }[way]

    sizes = []
    for step in range(steps):
        if step % timing.every == 0:
            # the torque's equation is linear: guess = f(guess) has the root f(0) / (1 - slope)
            at_zero = controller(*seen(step, 0.0))[0]
            slope = controller(*seen(step, 1.0))[0] - at_zero
            computed[step] = at_zero / (1 - slope)
            _, filtered, summed = controller(*seen(step, computed[step]))
        torque = torque_applied(step)
        v += torque
        x += v - torque / 2 if way == "RK4" else v  # which moves a mass under a constant force exactly
        sizes.append(abs(x) + abs(v))
    return float((max(sizes[-200:]) / max(sizes[200:400])) ** (1 / (steps - 400)))


@pytest.mark.parametrize("way", SEEN)
@pytest.mark.parametrize(
    ("timing", "ki"),
    [
        (Timing(), "0.0003"),
        (Timing(every=3), "0"),
        (Timing(every=3), "0.0003"),
        (Timing(late=Fraction(1, 2)), "0"),
        (Timing(late=Fraction(87, 2)), "0"),
        (Timing(every=4, late=Fraction(3, 2)), "0"),
        (Timing(every=2, late=Fraction(5)), "0.0003"),
        (Timing(every=2, late=Fraction(1), filter_steps=Fraction(3)), "0"),
        (Timing(filter_steps=Fraction(4)), "0"),
    ],
    ids=str,
)
def test_a_simulated_drive_grows_as_the_pole_says(way: str, timing: Timing, ki: str) -> None:
    drive = Drive(kp=Fraction("0.004"), kd=Fraction("0.05"), inertia=ONE, ki=Fraction(ki))
    pole = dominant_pole(drive, ONE, lookup(way), timing)
    # two maxima of an oscillation, 2600 steps apart
    assert grown(way, drive, timing, 3000) == pytest.approx(abs(pole), abs=1e-3)


def test_limits_lie_where_the_verdict_turns() -> None:
    a, b, timing = Fraction("0.1"), Fraction("0.008"), Timing(every=4, late=Fraction(1))
    found = limits_of("SYM", a, b, timing)
    assert found.kp is not None
    assert found.kd is not None
    assert found.kp[0] == 0
    less, more = Fraction(999_999, 10**6), Fraction(1_000_001, 10**6)
    kp_max, kd_min, kd_max = (Fraction(gain) for gain in (found.kp[1], *found.kd))
    inside = [(a, kp_max * less), (kd_min * more, b), (kd_max * less, b)]
    outside = [(a, kp_max * more), (kd_min * less, b), (kd_max * more, b)]
    for points, expected in ((inside, "converges"), (outside, "diverges")):
        assert [said("SYM", *point, timing) for point in points] == [expected] * 3
    assert found.every is not None
    assert found.late is not None
    assert converges("SYM", a, b, Timing(found.every, timing.late))
    assert not converges("SYM", a, b, Timing(found.every + 1, timing.late))
    assert converges("SYM", a, b, Timing(4, Fraction(found.late)))
    assert not converges("SYM", a, b, Timing(4, Fraction(found.late + 1)))


TOLD = [
    ("0.05", "0.09", Timing(late=Fraction(1)), (0.1, 0.9), (0, 0.05 * 0.95), (None, 0)),  # b < a (1 - a)
    ("0", "0.01", Timing(every=2), (0.005, 0.995), None, (None, None)),  # b < 2 a and b < 2 - 2 a; fresh: marginal
    ("-0.1", "0.01", Timing(every=2), (0.005, 0.995), None, (None, None)),
    ("1.8", "0.8", Timing(every=4), None, None, (None, None)),
]


@pytest.mark.parametrize(("a", "b", "timing", "kd", "kp", "steps"), TOLD, ids=str)
def test_an_unstable_drive_is_told_the_stretch_nearest_to_it(
    a: str,
    b: str,
    timing: Timing,
    kd: tuple[float, float] | None,
    kp: tuple[float, float] | None,
    steps: tuple[int | None, int | None],
) -> None:
    found = limits_of("SYM", Fraction(a), Fraction(b), timing)
    for stretch, expected in ((found.kd, kd), (found.kp, kp)):
        assert stretch == (expected and pytest.approx(expected, rel=1e-9))
    assert (found.every, found.late) == steps


MAPPED = [
    ("SYM", Timing()),
    ("SYM", Timing(every=4)),
    ("SYM", Timing(every=4, late=Fraction(1))),
    ("SYM", Timing(late=Fraction(7))),
    ("SYM", Timing(every=10, late=Fraction(3, 2), filter_steps=Fraction(5))),
    ("imex-euler", Timing(every=2)),
    ("stable-pd", Timing(late=Fraction(1, 2))),
    ("implicit-euler", Timing(late=Fraction(2))),
]


@pytest.mark.parametrize(("way", "timing"), MAPPED, ids=str)
def test_a_map_shows_all_that_is_stable_and_its_cells_are_where_the_verdict_is_proven(way: str, timing: Timing) -> None:
    found = drive_map(closed_loop(Drive(ONE, ONE, ONE), ONE, lookup(way), timing), timing, 40, (0.0, 0.0))
    stable = found.z_abs < 1
    for row, column in np.argwhere(np.abs(found.z_abs - 1) > 1e-9)[::17]:  # float64's rounding of a pole
        point = Fraction(found.alpha_hat[column]), Fraction(found.beta_hat[row])
        assert stable[row, column] == converges(way, *point, timing), point
    for edge, axis in ((stable.any(axis=0), found.alpha_hat), (stable.any(axis=1), found.beta_hat)):
        reach = axis[edge].max() / axis[-1]
        assert (0.7 < reach < 1) or axis[-1] == STRONGEST
