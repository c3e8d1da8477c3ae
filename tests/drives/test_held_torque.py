"""Drives whose torque is held for several steps or applied late: exact verdicts, closed forms, plain simulation."""

from fractions import Fraction
from math import floor, inf, pi, sin

import numpy as np
import pytest

from bezstab.drives.held_torque import (
    SEEN,
    STRONGEST,
    closed_loop,
    dominant_pole,
    drive_map,
    verdict,
)
from bezstab.drives.limits import Limits, limits
from bezstab.engines.drives import Drive, Timing
from bezstab.methods.registry import lookup

ONE = Fraction(1)


def said(way: str, a: Fraction, b: Fraction, timing: Timing) -> str:
    """Return the verdict of a drive of inertia 1 with steps of 1 s: its gains are the point."""
    return verdict(Drive(kp=b, kd=a, inertia=ONE), ONE, lookup(way), timing)


def limits_of(way: str, a: Fraction, b: Fraction, timing: Timing) -> Limits:
    """Return the limits of a drive of inertia 1 with steps of 1 s: its gains are the point."""
    return limits(Drive(kp=b, kd=a, inertia=ONE), ONE, lookup(way), timing)


VELOCITY_LIMITS = [  # of alpha_hat, without stiffness: v' = v - a v of so many steps before
    ("SYM", Timing(), 2),
    ("SYM", Timing(every=4), Fraction(1, 2)),
    ("SYM", Timing(late=Fraction(2)), 2 * sin(pi / 10)),
    ("imex-euler", Timing(late=Fraction(1)), 2),
]


@pytest.mark.parametrize(("way", "timing", "limit"), VELOCITY_LIMITS, ids=str)
def test_without_stiffness_the_velocity_is_judged(way: str, timing: Timing, limit: Fraction | float) -> None:
    """Late by k steps a pole is on the circle at 2 sin(pi / (4 k + 2)); implicit and one step late is explicit."""
    zero = Fraction(0)
    for factor, expected in ((Fraction("0.999"), "converges"), (Fraction("1.001"), "diverges")):
        assert said(way, factor * Fraction(limit), zero, timing) == expected


def period(way: str, drive: Drive, timing: Timing, state: list[float]) -> list[float]:
    """Return the state after N steps, as a controller and a physics engine compute them: each torque once, then held.

    The state: x, v, the filtered velocity, the summed error, and the torques that were computed last, newest first.
    """
    a, b, ki = map(float, (drive.kd, drive.kp, drive.ki))
    x, v, filtered, summed, *old = state
    whole, left = floor(timing.late), float(timing.late % 1)
    gain = float(1 / (1 + timing.filter_steps / timing.every))

    def after(guess: float) -> tuple[list[float], float, float, float]:
        """What is applied in each step if the torque computed now is the guess; what is seen then; and the answer."""

        def of(step: int) -> float:
            return [guess, *old][-(step // timing.every)]

        applied = [(1 - left) * of(step - whole) + left * of(step - whole - 1) for step in range(timing.every)]
        p = applied[0]
        seen_x, seen_v = {
            "SYM": (x, v),
            "imex-euler": (x, v + p),
            "stable-pd": (x + v, v + p),
            "implicit-euler": (x + v + p, v + p),
            "RK4": (x, v),
        }[way]
        seen = filtered + gain * (seen_v - filtered)
        total = bool(ki) * summed + timing.every * seen_x
        return applied, seen, total, -b * seen_x - a * seen - ki * total

    # linear: the torque that is its own answer
    at_zero, at_one = after(0.0)[3], after(1.0)[3]
    torque = at_zero / (1 - (at_one - at_zero))
    applied, filtered, summed, _ = after(torque)
    for each in applied:
        v += each
        x += v - each / 2 if way == "RK4" else v  # which moves a mass under a constant force exactly
    return [x, v, filtered, summed, torque, *old[:-1]]


@pytest.mark.parametrize("way", SEEN)
@pytest.mark.parametrize(
    ("timing", "ki"),
    [
        (Timing(every=3), "0.0003"),
        (Timing(late=Fraction(87, 2)), "0"),
        (Timing(every=4, late=Fraction(3, 2)), "0"),
        (Timing(every=2, late=Fraction(5)), "0.0003"),
        (Timing(every=2, late=Fraction(1), filter_steps=Fraction(3)), "0"),
        (Timing(filter_steps=Fraction(4)), "0"),
    ],
    ids=str,
)
def test_what_a_controller_and_an_engine_compute_has_the_pole(way: str, timing: Timing, ki: str) -> None:
    drive = Drive(kp=Fraction("0.004"), kd=Fraction("0.05"), inertia=ONE, ki=Fraction(ki))
    units = np.eye(6 + floor(timing.late)).tolist()
    values = np.linalg.eigvals([period(way, drive, timing, unit) for unit in units])  # of the matrix, transposed
    pole = dominant_pole(drive, ONE, lookup(way), timing)
    # by float64's rounding of a simple one
    assert np.abs(values).max() ** (1 / timing.every) == pytest.approx(abs(pole), rel=1e-9)


def test_a_torque_may_be_held_and_late_up_to_the_last_step_that_is_proven() -> None:
    a, b, every, late = Fraction("0.1"), Fraction("0.008"), 4, Fraction(1)
    found = limits_of("SYM", a, b, Timing(every, late))
    assert found.every
    assert found.late
    for further in (0, 1):
        assert (said("SYM", a, b, Timing(found.every + further, late)) == "converges") == (not further)
        assert (said("SYM", a, b, Timing(every, Fraction(found.late + further))) == "converges") == (not further)
    unstable = limits_of("SYM", Fraction("1.8"), Fraction("0.8"), Timing(every=4))
    assert (unstable.every, unstable.late) == (None, None)


ENDS = [  # closed forms
    ("SYM", "1", "1/4", Timing(), (0, 15 / 8), (0, 2)),  # 2 a + b < 4
    ("SYM", "19/10", "1/2", Timing(), (0, 7 / 4), (0, 1 / 5)),  # unstable: each is lowered until it is stable
    ("SYM", "3", "1/4", Timing(), (0, 15 / 8), None),  # where one alone is too much the other does not help
    ("SYM", "0", "1/100", Timing(), (0, 2 - 1 / 200), None),  # rounding on the circle is no decay
    ("imex-euler", "1", "8", Timing(), (2, inf), (0, 6)),  # b < 4 + 2 a
    ("implicit-euler", "1", "1", Timing(), (0, inf), (0, inf)),
    ("SYM", "1/20", "9/100", Timing(late=ONE), (0.1, 0.9), (0, 0.05 * 0.95)),  # b < a (1 - a): the nearest stretch
    ("SYM", "-1/10", "1/100", Timing(every=2), (0.005, 0.995), None),  # b < 2 a and b < 2 - 2 a
]


@pytest.mark.parametrize(("way", "a", "b", "timing", "kd", "kp"), ENDS)
def test_a_gain_may_go_to_the_ends_of_the_stretch_that_is_its_own_or_the_nearest(
    way: str, a: str, b: str, timing: Timing, kd: tuple[float, float] | None, kp: tuple[float, float] | None
) -> None:
    found = limits_of(way, Fraction(a), Fraction(b), timing)
    for stretch, expected in ((found.kd, kd), (found.kp, kp)):
        assert stretch == (expected and pytest.approx(expected, rel=1e-9))


LAWS = [*(("SYM", Timing(every)) for every in (1, 2, 4, 12)), ("SYM", Timing(late=ONE))]
LAWS += [("imex-euler", Timing()), ("stable-pd", Timing())]
MAPPED = [
    *LAWS,
    ("SYM", Timing(every=2, late=ONE)),
    ("SYM", Timing(late=Fraction(7))),
    ("implicit-euler", Timing(late=Fraction(2))),
]


@pytest.mark.parametrize(("way", "timing"), MAPPED, ids=str)
def test_a_map_shows_all_that_is_stable_proven_and_by_its_law_if_it_has_one(way: str, timing: Timing) -> None:
    found = drive_map(closed_loop(Drive(ONE, ONE, ONE), ONE, lookup(way), timing), timing, 40, (0.0, 0.0))
    stable, told = found.z_abs < 1, np.abs(found.z_abs - 1) > 1e-9  # float64's rounding of a pole
    for row, column in np.argwhere(told)[::17]:
        point = Fraction(found.alpha_hat[column]), Fraction(found.beta_hat[row])
        assert stable[row, column] == (said(way, *point, timing) == "converges"), point
    assert (found.law is not None) == ((way, timing) in LAWS)
    if found.law is not None:
        assert (stable == (found.beta_hat[:, np.newaxis] < found.law))[told].all()
    for edge, axis in ((stable.any(axis=0), found.alpha_hat), (stable.any(axis=1), found.beta_hat)):
        reach = axis[edge].max() / axis[-1]
        assert (0.7 < reach < 1) or axis[-1] == STRONGEST
