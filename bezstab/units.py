"""Units: Baumgarte's alpha and beta (1/s) and the step h (s) against the dimensionless alpha_hat and beta_hat.

    alpha_hat = 2 alpha h          c'' + 2 alpha c' + beta^2 c = 0        (paper Eqs 6 and 16)
    beta_hat  = beta^2 h^2

This is the only place where the two meet. What is exact on the way in stays exact; what comes out is float64.
"""

from __future__ import annotations

from decimal import Context, Decimal
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from bezstab.errors import InputError, shown
from bezstab.rationals import within_float64

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

LEAST_STEP = 1e-100  # s, and the inverse of the longest: so their squares are within float64
LONGEST_STEP = 1e100
GRAVITY = Fraction("9.81")  # m/s^2
DECIMALS = Context(prec=40)  # far more digits than a float64 has, and far larger numbers

FloatOrArray = TypeVar("FloatOrArray", float, "NDArray[np.float64]")
Number = TypeVar("Number", Fraction, float, "NDArray[np.float64]")


def check_step(h: Fraction | float, name: str = "h") -> None:
    """Raise InputError unless a step, so called, lies within 1e-100 to 1e100 s."""
    is_number = isinstance(h, int | float | Fraction) or getattr(h, "shape", None) == ()
    if isinstance(h, bool) or not is_number:
        raise InputError(f"{name} = {shown(h)}: expected one number, in s")
    if not (h <= LONGEST_STEP and float(h) >= LEAST_STEP):  # 1/10^100 is a little below the float 1e-100
        raise InputError(f"{name} = {float(h):g} s: expected {LEAST_STEP:g} to {LONGEST_STEP:g} s")


def _check_real(**values: object) -> None:
    """Raise InputError unless each value, by its name, is a real number or an array of them without a mask."""
    for name, value in values.items():
        kind = getattr(getattr(value, "dtype", None), "kind", "")
        is_array = kind in ("i", "u", "f") and not hasattr(value, "mask")
        if isinstance(value, bool) or not (is_array or isinstance(value, int | float | Fraction)):
            raise InputError(
                f"{name} = {shown(value)}: expected a real number, or a numpy array of them without a mask"
            )


def to_dimensionless(alpha: Number, beta: Number, h: Any) -> tuple[Number, Number]:
    """Return (alpha_hat, beta_hat) = (2 alpha h, beta^2 h^2).

    Parameters
    ----------
    alpha, beta : number, Fraction or array
        Feedback in 1/s.
    h : number or Fraction
        Step (s).

    Returns
    -------
    tuple
        Dimensionless numbers or arrays, as alpha and beta are; exact if all three are Fractions, else float64.

    Raises
    ------
    InputError
        h is outside 1e-100 to 1e100 s, or a result outside the range of float64.

    References
    ----------
    The paper's Eq. 16.
    """
    _check_real(alpha=alpha, beta=beta)
    check_step(h)
    if not (isinstance(alpha, Fraction) and isinstance(beta, Fraction)):
        h = float(h)
    alpha_hat, beta_hat = from_feedback_gains(2 * alpha, beta * beta, h)
    if isinstance(alpha_hat, Fraction) and isinstance(beta_hat, Fraction):
        return within_float64(alpha_hat, "α̂ = 2αh"), within_float64(beta_hat, "β̂ = β²h²")
    import numpy as np  # exact numbers do without, and --help

    if not (np.isfinite(alpha_hat).all() and np.isfinite(beta_hat).all()):
        raise InputError(f"α̂ = 2αh or β̂ = β²h² is outside the range of float64 for h = {float(h):g} s")
    return alpha_hat, beta_hat


def from_dimensionless(alpha_hat: FloatOrArray, beta_hat: FloatOrArray, h: float) -> tuple[FloatOrArray, FloatOrArray]:
    """Return (alpha, beta) = (alpha_hat / 2h, sqrt(beta_hat) / h) in 1/s.

    Parameters
    ----------
    alpha_hat, beta_hat : float or array
        Dimensionless feedback; beta_hat is not negative.
    h : float
        Step (s).

    Returns
    -------
    tuple
        Floats or arrays, as alpha_hat and beta_hat are.

    Raises
    ------
    InputError
        beta_hat is negative, h is outside 1e-100 to 1e100 s, or a result outside the range of float64.

    References
    ----------
    The paper's Eq. 16.
    """
    import numpy as np

    _check_real(alpha_hat=alpha_hat, beta_hat=beta_hat)
    check_step(h)
    if not (np.asarray(beta_hat) >= 0).all():  # not a number included
        raise InputError(f"β̂ = {np.min(beta_hat):g}: expected 0 or more, as β = √β̂/h is real")
    with np.errstate(over="ignore"):  # found and named below
        two_alpha, beta_squared = feedback_gains(alpha_hat, beta_hat, h)
    if not (np.isfinite(two_alpha).all() and np.isfinite(beta_squared).all()):
        raise InputError(f"α̂/h or β̂/h² is outside the range of float64 for h = {h:g} s")
    beta = np.sqrt(beta_squared)
    return two_alpha / 2, beta if isinstance(beta_squared, np.ndarray) else float(beta)


def feedback_gains(alpha_hat: Number, beta_hat: Number, h: Any) -> tuple[Number, Number]:
    """Return (2 alpha, beta^2) in 1/s and 1/s^2, the coefficients of paper Eq. 6, for a step of h seconds.

    Floats or arrays as given; exact numbers, for which h is exact too; beta^2 is negative where beta_hat is.
    """
    return alpha_hat / h, beta_hat / h**2


def alpha_and_beta(
    alpha_hat: Fraction | float, beta_hat: Fraction | float, h: Fraction | float | None
) -> tuple[float | None, float | None]:
    """Return (alpha, beta) in 1/s of one point for a step of h seconds, rounded once, to be shown.

    Both are None without a step, beta where beta_hat is negative; what is beyond float64 is infinite.
    """
    if h is None:
        return None, None
    two_alpha, beta_squared = map(_in_decimals, feedback_gains(Fraction(alpha_hat), Fraction(beta_hat), Fraction(h)))
    beta = None if beta_squared < 0 else float(DECIMALS.sqrt(beta_squared))
    return float(two_alpha) / 2, beta


def _in_decimals(number: Fraction) -> Decimal:
    return DECIMALS.divide(Decimal(number.numerator), Decimal(number.denominator))


def from_feedback_gains(two_alpha: Number, beta_squared: Number, h: Any) -> tuple[Number, Number]:
    """Return (alpha_hat, beta_hat) for the coefficients 2 alpha (1/s) and beta^2 (1/s^2) of paper Eq. 6.

    As `feedback_gains`: exact numbers stay exact, for which h is exact too.
    """
    return two_alpha * h, beta_squared * h * h
