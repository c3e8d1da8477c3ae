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
    assert limits_of(way, Fraction(limit) / 2, zero, timing).kd == pytest.approx((0, float(limit)), rel=1e-6)


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
    ("SYM", "1/10", "5", Timing(), None, (0, 19 / 5)),
    ("SYM", "0", "1/100", Timing(), (0, 2 - 1 / 200), None),  # rounding on the circle is no decay
    ("imex-euler", "1", "8", Timing(), (2, inf), (0, 6)),  # b < 4 + 2 a
    ("implicit-euler", "1", "1", Timing(), (0, inf), (0, inf)),
    ("SYM", "1/20", "9/100", Timing(late=ONE), (0.1, 0.9), (0, 0.05 * 0.95)),  # b < a (1 - a): the nearest stretch
    ("SYM", "-1/10", "1/100", Timing(every=2), (0.005, 0.995), None),  # b < 2 a and b < 2 - 2 a
    ("SYM", "9/5", "4/5", Timing(every=4), None, None),
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
    ("SYM", Timing(filter_steps=ONE)),
    ("SYM", Timing(late=Fraction(7))),
    ("SYM", Timing(every=10, late=Fraction(3, 2), filter_steps=Fraction(5))),
    ("imex-euler", Timing(every=2)),
    ("stable-pd", Timing(late=Fraction(1, 2))),
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
