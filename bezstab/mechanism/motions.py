"""The motion of a mechanism itself, without a method's errors, as a function of time; and when it begins anew."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.compiled import Mechanism, acceleration_function
from bezstab.mechanism.observation import observe, singular_passages
from bezstab.mechanism.runner import simulate
from bezstab.mechanism.scenes import Driver
from bezstab.methods import lookup
from bezstab.read_only import ReadOnlyArrays

FloatArray = NDArray[np.float64]

STEPS = 4000  # of RK4 over a revolution: its error there is about 1e-12 of a turn
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
        # q0 + v0 s + a0 s^2 / 2 + what makes it end in q1, v1, a1: s^3 (c0 + c1 s + c2 s^2)
        position, velocity, acceleration = q1 - q0 - v0 - a0 / 2, v1 - v0 - a0, a1 - a0
        c0 = 10 * position - 4 * velocity + acceleration / 2
        c1 = -15 * position + 7 * velocity - acceleration
        c2 = 6 * position - 3 * velocity + acceleration / 2
        q = q0 + s * (v0 + s * (a0 / 2 + s * (c0 + s * (c1 + s * c2))))
        v = v0 + s * (a0 + s * (3 * c0 + s * (4 * c1 + s * 5 * c2)))
        a = a0 + s * (6 * c0 + s * (12 * c1 + s * 20 * c2))
        return q, v / step, a / step**2

    def __repr__(self) -> str:
        return f"Motion({'a revolution' if self.closed else 'a run'} of {self.duration:.6g} s)"


@cache
def motion(mechanism: Mechanism, duration: float) -> Motion:
    """Return the motion from the scene's start: one revolution if a driver turns steadily, else over `duration` (s).

    InputError for a driven scene that is not where it began after a revolution; NumericalError if the run that provides
    the motion breaks down.
    """
    period = revolution_period(mechanism)
    span = duration if period is None else period
    step = span / STEPS
    run = simulate(mechanism, lookup("RK4"), step, span, FREE)
    if run.failure:
        raise NumericalError(f"the motion of {mechanism.scene.name} breaks down {run.failure}")
    if period is not None:
        _check_closed(mechanism, run.q[0], run.q[-1], period)
    q, v = np.ascontiguousarray(run.q.T), np.ascontiguousarray(run.v.T)
    a = np.stack(np.broadcast_arrays(*acceleration_function(mechanism, np)(run.t, *FREE, q, v)), axis=-1)
    return Motion(run.t, run.q, run.v, a, closed=period is not None)


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


def revolution_period(mechanism: Mechanism) -> float | None:
    """Return how long one revolution of the drivers takes (s); None unless all turn at one constant rate."""
    drivers = [joint for joint in mechanism.scene.joints if isinstance(joint, Driver)]
    rates = {abs(driver.rate) for driver in drivers}
    steady = all(driver.acceleration == 0 and driver.amplitude == 0 for driver in drivers)
    if len(rates) != 1 or not steady or rates == {0.0}:
        return None
    return float(2 * np.pi / rates.pop())


def _check_closed(mechanism: Mechanism, start: FloatArray, end: FloatArray, period: float) -> None:
    """Raise InputError unless every coordinate is back after a revolution, an angle up to whole turns."""
    for name, before, after in zip(mechanism.scene.coordinates, start, end, strict=True):
        apart = abs(after - before)
        if name.endswith(".theta"):
            apart = abs((apart + np.pi) % (2 * np.pi) - np.pi)
        if apart > CLOSED * max(1.0, abs(before)):
            raise InputError(
                f"{mechanism.scene.name}: {name} is off by {apart:.3g} after one revolution ({period:.6g} s): "
                "expected a driven motion that begins anew"
            )
