"""What accuracy a feedback costs: the error it forces, the order it leaves, and how many times the least possible."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

from bezstab.errors import InputError, NumericalError
from bezstab.methods import Method, accuracy, leading_error
from bezstab.stability.choices import choose
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import OMEGA_H, forced_error


@dataclass(frozen=True)
class FeedbackCost:
    """Errors as shares of the amplitude of a motion of omega_h rad a step; None where errors do not decay at all.

    forced_error: of the constraint, in the steady state. total_error: what is left in a run (forced_errors.py).
    order_left: the order in h of the error where alpha_hat and beta_hat are held, at most `order`, the method's own.
    times_least: total_error over that at `least_at`, (alpha_hat, beta_hat) of the goal accurate; None where there is
    no such point.
    """

    omega_h: float
    forced_error: float | None
    total_error: float | None
    order_left: int
    order: int
    times_least: float | None
    least_at: tuple[float, float] | None


def feedback_cost(method: Method, alpha_hat: float, beta_hat: float, omega_h: Fraction = OMEGA_H) -> FeedbackCost:
    """Return what accuracy a feedback costs on a motion of omega_h rad a step; InputError unless 1e-6 <= omega_h < 1.

    Source: methods/steady_errors.py; the goal accurate is this package's.
    """
    order, _ = accuracy(method)
    errors = forced_error(method, alpha_hat, beta_hat, omega_h)
    decays = bool(spectral_radius(method, alpha_hat, beta_hat) < 1)
    least_at = _least_at(method, omega_h)
    least = None if least_at is None else float(forced_error(method, *least_at, omega_h).total)
    return FeedbackCost(
        omega_h=float(omega_h),
        forced_error=float(errors.position) if decays else None,
        total_error=float(errors.total) if decays else None,
        order_left=min(order, leading_error(method).order_left),
        order=order,
        times_least=float(errors.total) / least if decays and least else None,
        least_at=least_at,
    )


@lru_cache(maxsize=256)
def _least_at(method: Method, omega_h: Fraction) -> tuple[float, float] | None:
    """Return the point of the goal accurate; None where there is none that is known."""
    try:
        chosen = choose(method, "accurate", margins=False, omega_h=omega_h)
    except (InputError, NumericalError):
        return None
    return chosen.alpha_hat, chosen.beta_hat
