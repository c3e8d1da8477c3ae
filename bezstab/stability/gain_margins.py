r"""Which of two gains is used up: how far alpha_hat alone, and beta_hat alone, is from where a point turns unstable.

beta_hat                      x a stable point: each gain may grow up to the edge
   |  \    edge               o an unstable one: each gain alone is lowered until it is stable again, if ever
   |---x--->\   o
   |        |\ <--
   +------------ alpha_hat
"""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

import numpy as np

from bezstab.stability.choices import Choice
from bezstab.stability.path_crossings import Path, first_stable_below

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

    Dimensionless; where the proven verdict turns.
    """
    factors: tuple[float | None, float | None]
    if choice.margins:
        factors = choice.margins.alpha[1], choice.margins.beta[1] ** 2
    else:
        point = Fraction(choice.alpha_hat), Fraction(choice.beta_hat)
        by_alpha, by_beta = (first_stable_below(Path(choice.method, *point, powers)) for powers in ((1, 0), (0, 2)))
        factors = (None if by_alpha is None else float(by_alpha), None if by_beta is None else float(by_beta**2))
    # the distance is the ratio of the gain and its limit, whichever is larger
    by_gain: dict[Gain, float | None] = {"alpha_hat": factors[0], "beta_hat": factors[1]}
    ratios = {
        gain: max(factor, 1 / factor) for gain, factor in by_gain.items() if factor is not None and 0 < factor < np.inf
    }
    nearest_first = sorted(ratios, key=lambda gain: ratios[gain])
    return GainLimits(
        alpha_hat=None if factors[0] is None else factors[0] * choice.alpha_hat,
        beta_hat=None if factors[1] is None else factors[1] * choice.beta_hat,
        nearest=nearest_first[0] if nearest_first else None,
    )
