"""Predicted poles against poles measured in a simulated mechanism.

A few steps into a run the first constraint is kicked, once up and once down, and half the difference of the two
histories of c_1 is followed:

    c_1   kicked up    *                      half the difference of the two:
          |             *  *                  - forcing by truncation errors, the same in both, cancels
          |~~~~~~~~~~~~~~~~~~*~~~*~~~         - what is even in the kick, hence everything quadratic, cancels
          |             *  *                  - the linear recursion whose characteristic polynomial is P(z) remains
          kicked down  *

Linear prediction finds the poles of that recursion.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import Literal

import numpy as np

from bezstab.evidence.linear_prediction import SAMPLES, SETTLED, SPREAD, Refusal, fit_dominant_pole
from bezstab.mechanism import Mechanism, constraint_errors, initial_state, march, perturbed_state, resume, states_needed
from bezstab.methods import Method, SecondOrder, Verdict, closed_loop_table, steps
from bezstab.rationals import exact
from bezstab.stability import ComplexArray, FloatArray, dominant_pole, poles, region, verdict, window
from bezstab.units import feedback_gains

MeasuredVerdict = Literal["converges", "diverges", "too close to call"]
Progress = Callable[[Sequence[int]], Iterable[int]]

RUN = 1000
"""Steps after the kick."""

KICKS = (1e-4, 1e-6, 1e-8, 1e-11)
"""SI units: decay is seen longest after the largest, growth after the smallest."""

LINEAR = (1e-3, 1e-4, 1e-5)
"""Largest |c| of a window, SI units: up to here a mechanism of about a metre answers linearly."""

GROWN = 10.0
"""Times the kick, well before c leaves the linear range; else the mechanism itself broke down."""

CLOSE = 1e-3
"""Of |z|: nearer to the circle than the bias of a moving mechanism (0.01 omega h) no verdict is given."""

SURROUNDINGS = 0.1
"""Of the window that shows the region, added on every side."""

SEED = 2024
"""Of the random points: the same every time."""


@dataclass(frozen=True)
class Measurement:
    """Predicted and measured dominant pole at one point; `measured` is None, and `reason` says why, if it cannot be."""

    method: Method
    alpha_hat: float
    beta_hat: float
    predicted: complex
    predicted_verdict: Verdict
    measured: complex | None
    measured_verdict: MeasuredVerdict
    reason: str


def random_points(method: Method, count: int) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat of random points over region and surroundings, always the same, to six decimals.

    Both have shape (count,).
    """
    low, high = np.transpose(window(region(method)))
    margin = SURROUNDINGS * (high - low)
    points = np.random.default_rng(SEED).uniform(low - margin, high + margin, (count, 2))
    alpha_hat, beta_hat = np.round(points, 6).T
    return alpha_hat, beta_hat


def measure_poles(
    mechanism: Mechanism,
    method: Method,
    h: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    progress: Progress = iter,
) -> list[Measurement]:
    """Return what is predicted and what is measured at each of a row of points.

    alpha_hat and beta_hat have shape (points,), h is in s; `progress` sees the step numbers pass. All points run as one
    batch. Where no pole can be measured the verdict still says whether the error grew or decayed. NumericalError where
    a predicted pole leaves the range of float64. The prediction is the characteristic polynomial P(z) (paper Eq. 17,
    Table 2), the measurement linear prediction (`fit_dominant_pole`).
    """
    difference, size = _kicked_responses(mechanism, method, h, alpha_hat, beta_hat, progress)
    return [
        _measurement(method, float(a), float(b), difference[:, :, i], size[:, :, i])
        for i, (a, b) in enumerate(zip(alpha_hat, beta_hat, strict=True))
    ]


def _kicked_responses(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray, progress: Progress
) -> tuple[FloatArray, FloatArray]:
    """Return half the difference of c_1 after kicks up and down, and the largest |c|; shape (steps, kicks, points)."""
    shape = (RUN + 1, len(KICKS), alpha_hat.size)
    difference = np.zeros(shape)
    size = np.full(shape, np.inf)
    with np.errstate(all="ignore"):  # what diverges runs into infinity, and is cut off there
        kicked = kicked_constraint_errors(mechanism, method, h, alpha_hat, beta_hat, KICKS)
        for k, c in zip(progress(range(RUN + 1)), kicked, strict=False):
            up, down = c[0]
            difference[k] = (up - down) / 2
            size[k] = np.abs(c).max(axis=(0, 1))
    size[~np.isfinite(size)] = np.inf
    return difference, size


def _measurement(
    method: Method, alpha_hat: float, beta_hat: float, difference: FloatArray, size: FloatArray
) -> Measurement:
    """Return the measurement at one point from its responses of shape (steps, kicks)."""
    predicted = complex(dominant_pole(method, alpha_hat, beta_hat))
    measured, reason = None, ""
    all_poles = poles(method, alpha_hat, beta_hat)
    rival = _rival(all_poles, predicted)
    # Over a window of SAMPLES steps the lesser of two such moduli does not even fall to 1/e of the other.
    if rival > (1 - 1 / SAMPLES) * abs(predicted):
        reason = f"another pole, of modulus {rival:.6g}, is too near to tell them apart"
    else:
        fit = fit_dominant_pole(difference, order=_number_of_poles(method), sizes=size, limits=LINEAR)
        if isinstance(fit, Refusal):
            reason = fit.reason
        elif _is_another(fit.pole, predicted, all_poles):
            reason = f"the kick hardly excites the dominant pole: what answers is one of modulus {abs(fit.pole):.6g}"
        else:
            measured = fit.pole
    return Measurement(
        method=method,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        predicted=predicted,
        predicted_verdict=verdict(method, exact(alpha_hat), exact(beta_hat)),
        measured=measured,
        measured_verdict=_measured_verdict(measured, difference, size),
        reason=reason,
    )


def _number_of_poles(method: Method) -> int:
    """Return the degree of P: for each of two mu as many as the method steps, or that of a second-order scheme."""
    if isinstance(method.scheme, SecondOrder):
        return len(closed_loop_table(method)) - 1
    return 2 * steps(method)


def _rival(z: ComplexArray, predicted: complex) -> float:
    """Return the largest modulus of a pole that is neither the dominant one nor its conjugate, by its angle."""
    off_in_angle = np.abs(np.abs(np.angle(z)) - np.angle(predicted))
    return float(np.abs(z[off_in_angle > SPREAD]).max(initial=0.0))


def _is_another(measured: complex, predicted: complex, all_poles: ComplexArray) -> bool:
    """Return whether what was measured is a pole, but another than the dominant one or its conjugate."""
    distances = np.abs(all_poles - measured)
    return abs(predicted - measured) > SPREAD and bool(distances.min() < SPREAD)


def _measured_verdict(measured: complex | None, difference: FloatArray, size: FloatArray) -> MeasuredVerdict:
    """Return whether the error grew or decayed: by the pole, else by the responses, shape (steps, kicks)."""
    if measured is not None:
        excess = abs(measured) - 1
        if abs(excess) < CLOSE:
            return "too close to call"
        return "diverges" if excess > 0 else "converges"
    outside = np.flatnonzero(~(size[:, -1] < LINEAR[0]))
    if outside.size:
        # c has left the linear range: by growth after the smallest kick, seen well before, or because the mechanism
        # itself broke down, which is no verdict.
        well_before = 1 + 3 * int(outside[0]) // 4
        grown = np.abs(difference[:well_before, -1]).max() > GROWN * KICKS[-1]
        return "diverges" if grown else "too close to call"
    after_largest_kick = np.abs(difference[:, 0])
    second_half = after_largest_kick[len(after_largest_kick) // 2 :]
    settled = second_half.max() < SETTLED * after_largest_kick.max()
    return "converges" if settled else "too close to call"


def kicked_constraint_errors(
    mechanism: Mechanism,
    method: Method,
    h: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    kicks: Sequence[float],
) -> Iterator[FloatArray]:
    """Yield c at each step from the kick on, without end; shape (constraints, 2 for up and down, kicks, points).

    The kick of the first constraint (SI units) comes after as many steps as the method has; what a multistep method
    remembers of before is left alone, and so is what a second-order scheme remembers of accelerations: its recursion is
    linear, and its poles are the same from any first values.
    """
    h_step = h * float(method.step_multiple)
    gains = feedback_gains(alpha_hat, beta_hat, h)
    q, v = initial_state(mechanism)
    displaced = perturbed_state(mechanism, 1.0)[0] - q  # linear in the constraint error
    direction = (*displaced, *np.zeros_like(v))
    amounts = np.multiply.outer([1.0, -1.0], kicks)[..., np.newaxis]
    start = tuple(np.full(alpha_hat.shape, value) for value in (*q, *v))
    history = [start]
    slopes = []
    before_the_kick = max(steps(method), states_needed(method) - 1)
    for state, slope, _ in islice(march(mechanism, method, h_step, gains, start, "rk4", np), before_the_kick):
        history.append(state)
        slopes.append(slope)
    undisturbed = history[-1]
    state = tuple(value + amounts * change for value, change in zip(undisturbed, direction, strict=True))
    history[-1] = state
    run = resume(mechanism, method, h_step, gains, history, slopes, np, undisturbed=undisturbed)
    k = len(history) - 1
    while True:
        yield constraint_errors(mechanism, k * h_step, state[: mechanism.size])
        state, _, _ = next(run)
        k += 1
