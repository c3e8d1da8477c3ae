"""The motion of a mechanism itself, without a method's errors, as a function of time; and when it begins anew."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from math import lcm

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import accelerations
from bezstab.mechanism.observation import observe, singular_passages
from bezstab.mechanism.runner import simulate
from bezstab.mechanism.scenes import Driver
from bezstab.methods.registry import lookup
from bezstab.read_only import ReadOnlyArrays

FloatArray = NDArray[np.float64]

STEPS = 4000  # of RK4 over a run, or a turn of the fastest driver: its error there is about 1e-12 of a turn
MOST_TURNS = 60  # of the fastest driver until all begin anew: a second and a minute do
SAME_RATIO = (
    1e-12  # of frequencies, which are given as decimals: no others are so near a ratio of such small whole numbers
)
FREE = (0.0, 0.0)  # gains: the exact motion has c = 0, and feedback at a fixed alpha_hat would cost RK4 two orders
CLOSED = 1e-6  # of a coordinate, at least of 1: a motion further from its start after a revolution does not close


@dataclass(frozen=True, eq=False, repr=False)
class Motion(ReadOnlyArrays):
    """q, v and qddot (shape (times, n) each, SI units) at equal steps t (s) from 0 to `duration`.

    `closed`: after `duration` the mechanism is where it was, angles up to whole turns: a revolution.
    """

    t: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray
    closed: bool

    @property
    def duration(self) -> float:
        """How long the motion takes (s)."""
        return float(self.t[-1])

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return q, v and qddot at times t (s), shape (t.size, n) each, between the steps by Hermite's quintic.

        A little before the start and after the end the first and the last quintic go on. The error is that of the
        sixth power of a step, 1e-18 of a revolution.
        """
        step = self.t[1]
        k = np.clip((t / step).astype(int), 0, len(self.t) - 2)
        s = (t / step - k)[:, np.newaxis]
        q0, v0, a0 = self.q[k], step * self.v[k], step**2 * self.a[k]
        q1, v1, a1 = self.q[k + 1], step * self.v[k + 1], step**2 * self.a[k + 1]
        # q0 + v0 s + a0 s^2 / 2 + what makes it end in q1, v1, a1: three powers more
        position, velocity, acceleration = q1 - q0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
        quintic = np.stack(
            [
                *(q0, v0, a0 / 2),
                10 * position - 4 * velocity + acceleration / 2,
                -15 * position + 7 * velocity - acceleration,
                6 * position - 3 * velocity + acceleration / 2,
            ]
        )
        q, v, a = (polyval(s, polyder(quintic, order), tensor=False) / step**order for order in range(3))
        return q, v, a


@cache
def motion(mechanism: Mechanism, duration: float) -> Motion:
    """Return the motion from the scene's start: a revolution, where its drivers begin anew, else over `duration` (s).

    InputError for a scene that is driven steadily and not where it began after a revolution; NumericalError if the run
    that provides the motion breaks down. Of a scene whose drivers oscillate, and that is not where it began after
    their common period, as one with freedoms of its own, there is a run.
    """
    drivers = [joint for joint in mechanism.scene.joints if isinstance(joint, Driver)]
    period, turns = revolution(drivers)
    if not turns:
        return motion_over(mechanism, duration, STEPS)
    along = motion_over(mechanism, period, STEPS * turns)
    off = _what_is_off(mechanism, along.q[0], along.q[-1])
    if off is None:
        return replace(along, closed=True)
    if any(driver.amplitude and driver.frequency for driver in drivers):
        return motion_over(mechanism, duration, STEPS)
    name, apart = off
    raise InputError(
        f"{mechanism.scene.name}: {name} is off by {apart:.3g} after one revolution ({period:.6g} s): "
        "expected a driven motion that begins anew"
    )


def motion_over(mechanism: Mechanism, span: float, steps: int) -> Motion:
    """Return the motion from the scene's start over a span (s) in so many steps, as a run."""
    run = simulate(mechanism, lookup("RK4"), span / steps, span, FREE)
    if run.failure:
        raise NumericalError(f"the motion of {mechanism.scene.name} breaks down {run.failure}")
    q, v = np.ascontiguousarray(run.q.T), np.ascontiguousarray(run.v.T)
    return Motion(run.t, run.q, run.v, accelerations(mechanism, run.t, *FREE, q, v).T, closed=False)


@cache
def regular_motion(mechanism: Mechanism, duration: float) -> Motion:
    """Return the same motion; NumericalError, too, if it goes through a singular configuration.

    There the directions of constraints turn without bound, and no rate along the motion means anything.
    """
    along = motion(mechanism, duration)
    passages = singular_passages(observe(mechanism, along.t, along.q, along.v, *FREE).pivots)
    if passages.size:
        raise NumericalError(
            f"the motion of {mechanism.scene.name} goes through a singular configuration at t = "
            f"{along.t[passages[0]]:.4g} s: there the directions of its constraints turn without bound"
        )
    return along


def revolution(drivers: Sequence[Driver]) -> tuple[float, int]:
    """Return how long it takes until all drivers begin anew (s), and how many turns of the fastest that are.

    Both are 0 without drivers that turn or oscillate, where one speeds up, and where the turns are more than
    MOST_TURNS: their frequencies are not in the ratio of whole numbers.
    """
    turning = {abs(driver.rate) for driver in drivers}
    oscillating = {abs(driver.frequency) for driver in drivers if driver.amplitude}
    frequencies = (turning | oscillating) - {0.0}  # in rad/s
    if not frequencies or any(driver.acceleration for driver in drivers):
        return 0.0, 0
    fastest, turns = max(frequencies), 1
    for frequency in frequencies:
        ratio = Fraction(frequency / fastest).limit_denominator(MOST_TURNS)
        if not ratio or abs(float(ratio) * fastest - frequency) > SAME_RATIO * frequency:
            return 0.0, 0
        turns = lcm(turns, ratio.denominator)
    return (2 * np.pi * turns / fastest, turns) if turns <= MOST_TURNS else (0.0, 0)


def _what_is_off(mechanism: Mechanism, start: FloatArray, end: FloatArray) -> tuple[str, float] | None:
    """Return a coordinate that is not back after a revolution, an angle up to whole turns, and how far it is off."""
    for name, before, after in zip(mechanism.scene.coordinates, start, end, strict=True):
        apart = abs(after - before)
        if name.endswith(".theta"):
            apart = abs((apart + np.pi) % (2 * np.pi) - np.pi)
        if apart > CLOSED * max(1.0, abs(before)):
            return name, apart
    return None
