"""What accuracy a feedback costs: the error it forces, the order it leaves, and how many times the least possible."""

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np

from bezstab.errors import InputError, NumericalError
from bezstab.methods.orders import accuracy
from bezstab.methods.schemes import Method
from bezstab.methods.steady_errors import leading_error
from bezstab.rationals import exact
from bezstab.stability.accurate_points import DECAY
from bezstab.stability.choices import USUAL_SPREAD, choose
from bezstab.stability.closed_loop import converges
from bezstab.stability.forced_errors import OMEGA_H, check_omega_h, forced_error

LEAST_DAMPING = DECAY / (1 - USUAL_SPREAD)
"""alpha over omega: with less, and off by the spread, errors that swing do not settle as the goal accurate demands."""

HARDLY_MORE = 1.1
"""Times that: at OMEGA_H the built-in methods that take the least have 1.001, the next (AB8) has 2.7."""

HARDLY_STIFFER = 2.0
"""beta over omega: at OMEGA_H those that follow the motion have 1.8 at most (rkn4), others more, by the step."""


@dataclass(frozen=True, repr=False)
class FeedbackCost:
    """Errors as shares of the amplitude of a motion of omega_h rad a step; None where errors do not decay at all.

    None, too, where they leave the range of float64. forced_error: of the constraint, in the steady state. total_error:
    what is left of it in a run (forced_errors.py). velocity_error: of its velocity, as a share of that one's amplitude.
    order_left: the order in h of the forced error where alpha_hat and beta_hat are held, at most `order`, the method's
    own. times_least, times_least_velocity: total and velocity error over those at `least_at`, (alpha_hat, beta_hat) of
    the goal accurate, which weighs both: elsewhere one of the two may be less. None where no such point is known.
    """

    omega_h: float
    forced_error: float | None
    total_error: float | None
    velocity_error: float | None
    order_left: int
    order: int
    times_least: float | None
    times_least_velocity: float | None
    least_at: tuple[float, float] | None

    def __repr__(self) -> str:
        errors = "error not known" if self.total_error is None else f"error {self.total_error:.3g} of the amplitude"
        times = "" if self.times_least is None else f", {self.times_least:.3g} times the least"
        return f"FeedbackCost({errors}{times}; order {self.order_left} of {self.order})"


def feedback_cost(
    method: Method,
    alpha_hat: float | Fraction,
    beta_hat: float | Fraction,
    omega_h: Fraction = OMEGA_H,
    *,
    least: bool = True,
) -> FeedbackCost:
    """Return what accuracy a feedback costs on a motion of omega_h rad a step; InputError unless 1e-6 <= omega_h < 1.

    Without `least` it is not compared with the point of the goal accurate, which takes most of the time. InputError,
    too, where what the method forces would take too long to find (methods/steady_errors.py, the source); the goal
    accurate is this package's.
    """
    order, _ = accuracy(method)
    position, total, velocity = _shares(method, alpha_hat, beta_hat, omega_h)
    least_at = _least_at(method, omega_h) if least else None
    _, least_total, least_velocity = _shares(method, *least_at, omega_h) if least_at else (None, None, None)
    return FeedbackCost(
        omega_h=float(omega_h),
        forced_error=position,
        total_error=total,
        velocity_error=velocity,
        order_left=order_left(method),
        order=order,
        times_least=_times(total, least_total),
        times_least_velocity=_times(velocity, least_velocity),
        least_at=least_at,
    )


def follows_motion(method: Method) -> bool:
    """Return whether the goal accurate takes the least damping that settles, and beta near omega: multiples of omega.

    Stronger feedback would force larger errors, at any step. Of other methods beta follows the step.
    """
    least_at = _least_at(method, OMEGA_H)
    if least_at is None:
        return False
    alpha_h, beta_h = least_at[0] / 2, least_at[1] ** 0.5
    return alpha_h <= HARDLY_MORE * LEAST_DAMPING * OMEGA_H and beta_h <= HARDLY_STIFFER * OMEGA_H


def order_left(method: Method) -> int:
    """Return the order in h of constraint errors where alpha_hat and beta_hat are held, at most the method's own."""
    order, _ = accuracy(method)
    return min(order, leading_error(method).power)


def _shares(
    method: Method, alpha_hat: float | Fraction, beta_hat: float | Fraction, omega_h: Fraction
) -> list[float | None]:
    """Return the errors at a point: of the position, in total, of the velocity.

    None for what is not finite, or not decaying.
    """
    check_omega_h(omega_h)
    a, b = (each if isinstance(each, Fraction) else exact(each) for each in (alpha_hat, beta_hat))
    if not converges(method, a, b):
        return [None, None, None]
    with np.errstate(over="ignore", invalid="ignore"):  # found below
        errors = forced_error(method, float(a), float(b), omega_h)
    of_each = (errors.position, errors.total, errors.velocity)
    return [float(error) if np.isfinite(error) else None for error in of_each]


def _times(error: float | None, least: float | None) -> float | None:
    return error / least if error is not None and least else None


@lru_cache(maxsize=256)
def _least_at(method: Method, omega_h: Fraction) -> tuple[float, float] | None:
    """Return the point of the goal accurate; None where there is none that is known."""
    try:
        chosen = choose(method, "accurate", omega_h=omega_h)
    except (InputError, NumericalError):
        return None
    return chosen.alpha_hat, chosen.beta_hat
