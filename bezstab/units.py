"""Units: Baumgarte's alpha and beta (1/s) and the step h (s) against the dimensionless alpha_hat and beta_hat."""

from fractions import Fraction
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bezstab.rationals import within_float64

Number = TypeVar("Number", float, NDArray[np.float64])


def to_dimensionless(alpha: Fraction, beta: Fraction, h: Fraction) -> tuple[Fraction, Fraction]:
    """Return (alpha_hat, beta_hat) = (2 alpha h, beta^2 h^2); alpha and beta in 1/s, h in s (paper Eq. 16).

    InputError where they leave the range of float64.
    """
    return within_float64(2 * alpha * h, "α̂ = 2αh"), within_float64(beta * beta * h * h, "β̂ = β²h²")


def feedback_gains(alpha_hat: Number, beta_hat: Number, h: float) -> tuple[Number, Number]:
    """Return (2 alpha, beta^2) in 1/s and 1/s^2, the coefficients of paper Eq. 6, for a step of h seconds."""
    return alpha_hat / h, beta_hat / h**2
