"""How far each number of a drive may go with the others as they are: gains, inertia, rate and delay."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from bezstab.drives.held_torque import SEEN, closed_loop, spectral_radius, verdict
from bezstab.engines.drives import MOST_STEPS, Drive, Timing
from bezstab.methods.schemes import Method
from bezstab.stability.arrays import SLOW, BoolArray, FloatArray
from bezstab.stability.searches import first_where

Stretch = tuple[float, float]
"""From and to where a drive is stable: from 0 where there is no lower end, to infinity where there is no upper one."""

FACTORS = np.geomspace(1e-8, 1e8, 756)
"""alpha_hat or beta_hat at which ends of stability are looked for first, 5 % apart: a shorter stretch is not seen."""

FEW_FACTORS = np.geomspace(1e-5, 1e5, 57)
"""Times a drive's own number, 50 % apart."""


@dataclass(frozen=True)
class Limits:
    """How far each number may go alone (SI units).

    `kp`, `kd`, `ki`, `inertia`, `h` (s): the stretch that holds the drive's own number, else the one nearest to it;
    None where there is none, and of ki without one. `every`, `late`: the last whole numbers of steps up to which all
    are proven stable; None where the least, 1 and 0, is not, and for a method that cannot be held or late.
    """

    kp: Stretch | None
    kd: Stretch | None
    ki: Stretch | None
    inertia: Stretch | None
    h: Stretch | None
    every: int | None
    late: int | None


def limits(drive: Drive, h: Fraction, method: Method, timing: Timing) -> Limits:
    """Return how far each number may go: by |z_p| in float64, whole steps by proven verdicts."""
    loop = closed_loop(drive, h, method, timing)
    a, b = map(float, drive.point(h))
    kp_of_one, kd_of_one = drive.gains(1.0, 1.0, float(h))

    def decays(alpha_hat: FloatArray | float, beta_hat: FloatArray | float) -> BoolArray:
        stable: BoolArray = spectral_radius(loop, alpha_hat, beta_hat) < 1 - SLOW
        return stable

    def stable_with(changed: Drive, step: Fraction = h, **timed: Any) -> bool:
        return verdict(changed, step, method, replace(timing, **timed)) == "converges"

    if drive.ki:  # the closed loop itself depends on these
        inertia = _proven_around(drive.inertia, lambda some: stable_with(replace(drive, inertia=some)))
        step = _proven_around(h, lambda some: stable_with(drive, some))
        ki = _proven_around(drive.ki, lambda some: stable_with(replace(drive, ki=some)))
    else:
        inertia = _times(float(drive.inertia), _stable_stretch(1.0, lambda some: decays(a / some, b / some)))
        step = _times(float(h), _stable_stretch(1.0, lambda some: decays(a * some, b * some**2)))
        ki = None
    in_steps = method.name in SEEN
    return Limits(
        kp=_times(kp_of_one, _stable_stretch(b, lambda some: decays(a, some))),
        kd=_times(kd_of_one, _stable_stretch(a, lambda some: decays(some, b))),
        ki=ki,
        inertia=inertia,
        h=step,
        every=_last_stable(lambda every: stable_with(drive, every=every), least=1) if in_steps else None,
        late=_last_stable(lambda late: stable_with(drive, late=Fraction(late)), least=0) if in_steps else None,
    )


def _proven_around(own: Fraction, stable: Callable[[Fraction], bool]) -> Stretch | None:
    """Return the stretch around a drive's own number where each takes a closed loop and a verdict of its own."""
    each = np.vectorize(lambda some: stable(Fraction(some)), otypes=[bool])
    return _stable_stretch(float(own), each, float(own) * FEW_FACTORS)


def _stable_stretch(
    own: float, decays: Callable[[FloatArray], BoolArray], numbers: FloatArray = FACTORS
) -> Stretch | None:
    """Return the stretch that decays around a drive's own number, else that nearest to it; None if there is none.

    `numbers`: at which ends are looked for first, rising.
    """
    if own > 0:
        numbers = np.sort(np.append(numbers, own))
    stable = np.flatnonzero(decays(numbers))
    if not stable.size:
        return None
    start = stable[np.argmin(np.abs(np.log(numbers[stable] / max(own, numbers[0]))))]  # the own one, if it is stable
    down, up = (first_where(lambda some: ~decays(some), way) for way in (numbers[start::-1], numbers[start:]))
    return (down[0] if down else 0.0, up[0] if up else np.inf)


def _times(unit: float, stretch: Stretch | None) -> Stretch | None:
    return None if stretch is None else (unit * stretch[0], unit * stretch[1])


def _last_stable(stable: Callable[[int], bool], least: int) -> int | None:
    """Return the last whole number from the least on up to which all are stable, at most MOST_STEPS."""
    unstable = next((number for number in range(least, MOST_STEPS + 1) if not stable(number)), MOST_STEPS + 1)
    return unstable - 1 if unstable > least else None
