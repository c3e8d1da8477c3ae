"""A point: what an engine's values mean at other steps, whether it looks like 1/s, and what a window shows of it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from bezstab.engines import Engine, Point
from bezstab.errors import InputError
from bezstab.methods import Method, Verdict
from bezstab.stability import ComplexArray, FloatArray, poles, verdict
from bezstab.units import feedback_gains

SAME_GAINS = 1e-9
"""Of gains in 1/s and 1/s^2: roots and powers that engines take are rounded to float64."""


@dataclass(frozen=True)
class PlanePoint:
    """What a method does to errors at a point (alpha_hat, beta_hat), exact: fast enough to follow a mouse."""

    method: Method
    point: Point

    @cached_property
    def poles(self) -> ComplexArray:
        """All poles, the dominant one first, shape (degree,); errors as `poles`."""
        return poles(self.method, *map(float, self.point))

    @property
    def stable(self) -> bool:
        """Whether the dominant pole, in float64, lies inside the unit circle."""
        return bool(abs(self.poles[0]) < 1)

    @property
    def verdict(self) -> Verdict:
        """What errors do, proven."""
        return verdict(self.method, *self.point)

    def after_a_kick(self, steps: int) -> FloatArray:
        """Return |c| from a unit kick on, shape (steps + 1,)."""
        return abs(kick_response(self.poles, steps))


def kick_response(poles: ComplexArray, steps: int) -> FloatArray:
    """Return c_0 = 1, c_1, ... of the linear recursion that has these poles, float64 of shape (steps + 1,).

    `poles` has shape (degree,), complex ones in conjugate pairs. At rest before the kick. Not finite from where it
    leaves the range of float64.
    """
    polynomial = np.poly(poles).real
    degree = len(polynomial) - 1
    c = np.zeros(degree + steps + 1)  # with `degree` values of rest in front
    c[degree] = 1
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(degree + 1, len(c)):
            newest_first = c[k - 1 : k - degree - 1 : -1]
            c[k] = -polynomial[1:] @ newest_first
    return c[degree:]


def engine_holds(
    engine: Engine, values: tuple[Fraction, ...], shorter: Fraction, longer: Fraction, *, as_typed: bool
) -> bool:
    """Return whether an engine's values mean the same alpha_hat and beta_hat at both steps (s), or alpha and beta.

    InputError where they mean neither, as those do that are clamped to the step.
    """
    at_both = [engine.applied(values, step, as_typed=as_typed).points for step in (shorter, longer)]
    if at_both[0] == at_both[1]:
        return True
    of_shorter, of_longer = (
        [float(gain) for point in points for gain in feedback_gains(*point, step)]
        for points, step in zip(at_both, (shorter, longer), strict=True)
    )
    if all(math.isclose(*gains, rel_tol=SAME_GAINS) for gains in zip(of_shorter, of_longer, strict=True)):
        return False
    raise InputError(
        f"--h-min: {engine.name} makes of these values neither the same α and β nor the same α̂ and β̂ at steps of "
        f"{float(shorter):g} and {float(longer):g} s; with --hold, what it makes of them at --h is asked about"
    )


LARGE = 10
"""From this alpha_hat or beta_hat on, 1/s was probably meant: as alpha_hat it leaves e^-5 of an error after a step."""


def meant_in_seconds(methods: Sequence[Method], point: Point | None) -> bool:
    """Return whether numbers that were given as alpha_hat and beta_hat look like alpha and beta in 1/s.

    They do if no method is stable there and one of the numbers is LARGE.
    """
    if point is None or max(point) <= LARGE:
        return False
    return not any(verdict(method, *point) == "converges" for method in methods)
