"""What accuracy a feedback costs: the error it forces, the order it leaves, and how many times the least possible."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, accuracy, leading_error
from bezstab.rationals import exact
from bezstab.stability.choices import choose
from bezstab.stability.closed_loop import converges
from bezstab.stability.forced_errors import OMEGA_H, check_omega_h, forced_error


@dataclass(frozen=True)
class FeedbackCost:
    """Errors as shares of the amplitude of a motion of omega_h rad a step; None where errors do not decay at all.

    None, too, where they leave the range of float64. forced_error: of the constraint, in the steady state. total_error:
    what is left in a run (forced_errors.py). order_left: the order in h of the error where alpha_hat and beta_hat are
    held, at most `order`, the method's own. times_least: total_error over that at `least_at`, (alpha_hat, beta_hat) of
    the goal accurate, which weighs the velocity as well and may have a little more; None where no such point is known.
    """

    omega_h: float
    forced_error: float | None
    total_error: float | None
    order_left: int
    order: int
    times_least: float | None
    least_at: tuple[float, float] | None


def feedback_cost(
    method: Method, alpha_hat: float | Fraction, beta_hat: float | Fraction, omega_h: Fraction = OMEGA_H
) -> FeedbackCost:
    """Return what accuracy a feedback costs on a motion of omega_h rad a step; InputError unless 1e-6 <= omega_h < 1.

    InputError, too, where what the method forces would take too long to find (methods/steady_errors.py, the source);
    the goal accurate is this package's.
    """
    order, _ = accuracy(method)
    leading = leading_error(method)
    position, total = _shares(method, alpha_hat, beta_hat, omega_h)
    least_at = _least_at(method, omega_h)
    _, least = (None, None) if least_at is None else _shares(method, *least_at, omega_h)
    return FeedbackCost(
        omega_h=float(omega_h),
        forced_error=position,
        total_error=total,
        order_left=min(order, leading.order_left),
        order=order,
        times_least=total / least if total is not None and least else None,
        least_at=least_at,
    )


def _shares(
    method: Method, alpha_hat: float | Fraction, beta_hat: float | Fraction, omega_h: Fraction
) -> tuple[float | None, float | None]:
    """Return forced and total error at a point; None where errors do not decay, or in place of what is not finite."""
    check_omega_h(omega_h)
    a, b = (each if isinstance(each, Fraction) else exact(each) for each in (alpha_hat, beta_hat))
    if not converges(method, a, b):
        return None, None
    with np.errstate(over="ignore", invalid="ignore"):  # found below
        errors = forced_error(method, float(a), float(b), omega_h)
    position, total = (float(each) if np.isfinite(each) else None for each in (errors.position, errors.total))
    return position, total


@lru_cache(maxsize=256)
def _least_at(method: Method, omega_h: Fraction) -> tuple[float, float] | None:
    """Return the point of the goal accurate; None where there is none that is known."""
    try:
        chosen = choose(method, "accurate", margins=False, omega_h=omega_h)
    except (InputError, NumericalError):
        return None
    return chosen.alpha_hat, chosen.beta_hat
