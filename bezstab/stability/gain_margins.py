r"""Which of two gains is used up: how far alpha_hat alone, and beta_hat alone, is from where a point turns unstable.

beta_hat                      x a stable point: each gain may grow up to the edge
   |  \    edge               o an unstable one: each gain alone is lowered until it is stable again, if ever
   |---x--->\   o
   |        |\ <--
   +------------ alpha_hat
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bezstab.stability.arrays import FloatArray
from bezstab.stability.choices import Choice
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.searches import first_where

LOWERED = np.geomspace(1, 1e-6, 600)
"""Factors on a gain that is lowered: neighbours are 2.3 % apart, and nobody is off by more than a million."""

ON_THE_CIRCLE = 1e-12
"""Within which of one a computed modulus is no decay: some thousand roundings, more than a pole on the circle has."""

Gain = Literal["alpha_hat", "beta_hat"]


@dataclass(frozen=True)
class GainLimits:
    """The largest alpha_hat and beta_hat that are stable with the other as it is, and which is nearest its limit.

    A limit is infinite where there is none, None where lowering that gain alone does not help. `nearest` is None
    where neither has a finite limit.
    """

    alpha_hat: float | None
    beta_hat: float | None
    nearest: Gain | None


def gain_limits(choice: Choice) -> GainLimits:
    """Return how far each of a point's two gains is from its limit, upwards from a stable point, else downwards.

    Dimensionless. NumericalError if a pole (a root of paper Eq. 17) leaves the range of float64.
    """
    a, b = choice.alpha_hat, choice.beta_hat
    if choice.margins:
        factors: tuple[float | None, float | None] = (choice.margins.alpha[1], choice.margins.beta[1] ** 2)
    else:
        factors = (
            _largest_stable(lambda factor: spectral_radius(choice.method, factor * a, b)),
            _largest_stable(lambda factor: spectral_radius(choice.method, a, factor * b)),
        )
    # the distance is the ratio of the gain and its limit, whichever is larger
    by_gain: dict[Gain, float | None] = {"alpha_hat": factors[0], "beta_hat": factors[1]}
    ratios = {
        gain: max(factor, 1 / factor) for gain, factor in by_gain.items() if factor is not None and 0 < factor < np.inf
    }
    nearest_first = sorted(ratios, key=lambda gain: ratios[gain])
    return GainLimits(
        alpha_hat=None if factors[0] is None else factors[0] * a,
        beta_hat=None if factors[1] is None else factors[1] * b,
        nearest=nearest_first[0] if nearest_first else None,
    )


def _largest_stable(modulus: Callable[[FloatArray], FloatArray]) -> float | None:
    """Return the largest of LOWERED's factors, and between them, with a modulus below one; None if none is."""
    met = first_where(lambda factor: modulus(factor) < 1 - ON_THE_CIRCLE, LOWERED)
    return met[1] if met else None
