"""How far each number of a drive may go with the others as they are: gains, inertia, rate and delay."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from bezstab.drives.held_torque import SEEN, spectral_radius, verdict
from bezstab.engines import MOST_STEPS, Drive, Timing
from bezstab.methods import Method
from bezstab.stability import SLOW, BoolArray, FloatArray, first_where

Stretch = tuple[float, float]
"""From and to where a drive is stable: from 0 where there is no lower end, to infinity where there is no upper one."""

FACTORS = np.geomspace(1e-8, 1e8, 756)
"""alpha_hat or beta_hat at which ends of stability are looked for first, 5 % apart: a shorter stretch is not seen."""


@dataclass(frozen=True)
class Limits:
    """How far each number may go alone (SI units).

    `kp`, `kd`, `inertia`, `h` (s): the stretch that holds the drive's own number, else the one nearest to it; None
    where there is none. `every`, `late`: the last whole numbers of steps up to which all are proven stable; None where
    the least, 1 and 0, is not, and for a method that cannot be held or late.
    """

    kp: Stretch | None
    kd: Stretch | None
    inertia: Stretch | None
    h: Stretch | None
    every: int | None
    late: int | None


def limits(drive: Drive, h: Fraction, method: Method, timing: Timing) -> Limits:
    """Return how far each number may go: by |z_p| in float64, whole steps by proven verdicts."""
    point = drive.point(h)
    a, b = map(float, point)
    kp_of_one, kd_of_one = drive.gains(1.0, 1.0, float(h))

    def decays(alpha_hat: FloatArray | float, beta_hat: FloatArray | float) -> BoolArray:
        stable: BoolArray = spectral_radius(method, alpha_hat, beta_hat, timing) < 1 - SLOW
        return stable

    def stable(**changed: Any) -> bool:
        return verdict(method, *point, replace(timing, **changed)) == "converges"

    in_steps = method.name in SEEN
    return Limits(
        kp=_times(kp_of_one, _stable_stretch(b, lambda some: decays(a, some))),
        kd=_times(kd_of_one, _stable_stretch(a, lambda some: decays(some, b))),
        inertia=_times(float(drive.inertia), _stable_stretch(1.0, lambda some: decays(a / some, b / some))),
        h=_times(float(h), _stable_stretch(1.0, lambda some: decays(a * some, b * some**2))),
        every=_last_stable(lambda every: stable(every=every), least=1) if in_steps else None,
        late=_last_stable(lambda late: stable(late=Fraction(late)), least=0) if in_steps else None,
    )


def _stable_stretch(own: float, decays: Callable[[FloatArray], BoolArray]) -> Stretch | None:
    """Return the stretch that decays around a drive's own number, else that nearest to it; None if there is none."""
    numbers = np.sort(np.append(FACTORS, own)) if own > 0 else FACTORS
    stable = np.flatnonzero(decays(numbers))
    if not stable.size:
        return None
    start = stable[np.argmin(np.abs(np.log(numbers[stable] / max(own, FACTORS[0]))))]  # the own one, if it is stable
    down, up = (first_where(lambda some: ~decays(some), way) for way in (numbers[start::-1], numbers[start:]))
    return (down[0] if down else 0.0, up[0] if up else np.inf)


def _times(unit: float, stretch: Stretch | None) -> Stretch | None:
    return None if stretch is None else (unit * stretch[0], unit * stretch[1])


def _last_stable(stable: Callable[[int], bool], least: int) -> int | None:
    """Return the last whole number from the least on up to which all are stable, at most MOST_STEPS."""
    unstable = next((number for number in range(least, MOST_STEPS + 1) if not stable(number)), MOST_STEPS + 1)
    return unstable - 1 if unstable > least else None
