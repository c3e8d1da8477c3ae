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

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import median
from typing import Literal

import numpy as np

from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.constraint_normals import turning_normals
from bezstab.mechanism.equations import Mechanism
from bezstab.methods.schemes import Method
from bezstab.methods.schur import Verdict
from bezstab.rationals import exact
from bezstab.runs.exact_rates import exact_rates
from bezstab.runs.kicks import LINEAR, TOO_CLOSE, kicked_fates, kicked_motions
from bezstab.runs.linear_prediction import SAMPLES, SPREAD, fit_dominant_pole
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.closed_loop import dominant_pole, poles, verdict
from bezstab.stability.regions import region, window
from bezstab.stability.turning import MovingPole, moving_pole
from bezstab.words import point_words

MeasuredVerdict = Literal["converges", "diverges", "too close to call"]

RUN = 1000
"""Steps after the kick."""

KICKS = (1e-4, 1e-6, 1e-8, 1e-11)
"""SI units: decay is seen longest after the largest, growth after the smallest."""

CLOSE = 1e-4
"""Of |z|: nearer to the circle than a hundred of the fit's errors no verdict is given; on a mechanism that moves not
nearer than its dominant pole is moved."""

SURROUNDINGS = 0.1
"""Of the window that shows the region, added on every side."""

SEED = 2024
"""Of the random points: the same every time."""


@dataclass(frozen=True, repr=False)
class Measurement:
    """Predicted and measured dominant pole at one point, for steps of h (s).

    `measured` is None if it cannot be, and `reason` says why.
    `predicted` and its verdict are those of the mechanism at rest, `moving` has bounds for the motion. `floquet_abs` is
    the exact rate over the motion, not a number unless asked for. Where the motion is not `periodic` that is no exact
    rate, but a growth over the run. `measured` is what the first steps after the kick show; `difference_abs` is its
    modulus less that predicted. `verdicts_agree`: whether the verdict for the motion is the measured one; None where
    either is not settled. `right`: which predictions have it: at rest, in motion, exact.
    """

    method: Method
    h: float
    alpha_hat: float
    beta_hat: float
    predicted: complex
    predicted_verdict: Verdict
    moving: MovingPole
    floquet_abs: float
    periodic: bool
    measured: complex | None
    measured_verdict: MeasuredVerdict
    reason: str
    difference_abs: float | None
    verdicts_agree: bool | None
    right: str

    def __repr__(self) -> str:
        point = point_words(self.alpha_hat, self.beta_hat, None)
        measured = "none measured" if self.measured is None else f"measured {abs(self.measured):.6g}"
        return f"Measurement({point}, {self.method.name}: |z_p| = {abs(self.predicted):.6g}, {measured})"


@dataclass(frozen=True)
class MeasurementSummary:
    """Errors of |z|, and verdicts that contradict theory, of `measured` among all `points` of a method."""

    method: Method
    points: int
    measured: int
    median_error: float | None
    largest_error: float | None
    called: int
    wrong: int


def measurement_summary(measurements: Sequence[Measurement]) -> MeasurementSummary:
    """Return how well the measured poles of one method agree; there is at least one measurement."""
    errors = [abs(each.difference_abs) for each in measurements if each.difference_abs is not None]
    agreements = [each.verdicts_agree for each in measurements]
    return MeasurementSummary(
        method=measurements[0].method,
        points=len(measurements),
        measured=len(errors),
        median_error=median(errors) if errors else None,
        largest_error=max(errors, default=None),
        called=sum(agree is not None for agree in agreements),
        wrong=sum(agree is False for agree in agreements),
    )


def random_points(method: Method, count: int) -> tuple[FloatArray, FloatArray]:
    """Return alpha_hat and beta_hat of random points over region and surroundings, always the same, to six decimals.

    Both have shape (count,) and no dimension. NumericalError as `region`.
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
    floquet: bool = False,
) -> list[Measurement]:
    """Return what is predicted and what is measured at each of a row of points.

    alpha_hat and beta_hat have shape (points,), h is in s. All points run as one batch. Where no pole can be measured
    the verdict still says whether the error grew or decayed. InputError for a scene that cannot start; NumericalError
    where a predicted pole leaves the range of float64. The prediction is the characteristic polynomial P(z) (paper Eq.
    17, Table 2), bounds for the motion and, with `floquet`, exact; the measurement is linear prediction
    (`fit_dominant_pole`).
    """
    difference, size = _kicked_responses(mechanism, method, h, alpha_hat, beta_hat)
    grows, undecided = kicked_fates(mechanism, method, h, alpha_hat, beta_hat, RUN)
    duration = RUN * h * float(method.step_multiple)
    turning = turning_normals(mechanism, duration)
    rates = np.full(alpha_hat.size, np.nan)
    if floquet:
        rates = exact_rates(mechanism, method, h, alpha_hat, beta_hat, duration)
    found = []
    for i, (a, b) in enumerate(zip(alpha_hat.tolist(), beta_hat.tolist(), strict=True)):
        responses = difference[:, :, i], size[:, :, i]
        predicted = complex(dominant_pole(method, a, b))
        measured, reason = _measured_pole(predicted, poles(method, a, b), *responses)
        moving = moving_pole(method, turning.kappa, h, a, b)
        close = max(CLOSE, moving.z_abs - moving.at_least)
        unclear = bool(undecided[i]) or abs(abs(predicted) - 1) < TOO_CLOSE / RUN
        at_rest, rate = verdict(method, exact(a), exact(b)), float(rates[i])
        seen = _measured_verdict(measured, bool(grows[i]), unclear, close)
        settled = seen != "too close to call" and moving.verdict != "not settled"
        found.append(
            Measurement(
                method=method,
                h=h,
                alpha_hat=a,
                beta_hat=b,
                predicted=predicted,
                predicted_verdict=at_rest,
                moving=moving,
                floquet_abs=rate,
                periodic=turning.closed,
                measured=measured,
                measured_verdict=seen,
                reason=reason,
                difference_abs=None if measured is None else abs(measured) - abs(predicted),
                verdicts_agree=moving.verdict == seen if settled else None,
                right=_right(seen, at_rest, moving, rate, periodic=turning.closed),
            )
        )
    return found


def _kicked_responses(
    mechanism: Mechanism, method: Method, h: float, alpha_hat: FloatArray, beta_hat: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return half the difference of c_1 after kicks up and down, and the largest |c|; shape (steps, kicks, points)."""
    differences, sizes = [], []
    compiled = runs_compiled(method, 2 * len(KICKS) * (RUN + 1) * alpha_hat.size, together=True)
    with np.errstate(all="ignore"):  # what diverges runs into infinity, and is cut off there
        for c, _ in kicked_motions(mechanism, method, h, alpha_hat, beta_hat, KICKS, RUN, compiled):
            differences.append((c[:, 0, 0] - c[:, 0, 1]) / 2)
            sizes.append(np.abs(c).max(axis=(1, 2)))
    return np.concatenate(differences), np.concatenate(sizes)


def _measured_pole(
    predicted: complex, all_poles: ComplexArray, difference: FloatArray, size: FloatArray
) -> tuple[complex | None, str]:
    """Return the dominant pole that responses of shape (steps, kicks) show, or None and why they show none."""
    # by its angle neither the dominant pole nor its conjugate
    off_in_angle = np.abs(np.abs(np.angle(all_poles)) - np.angle(predicted))
    rival = float(np.abs(all_poles[off_in_angle > SPREAD]).max(initial=0.0))
    # Over a window of SAMPLES steps the lesser of two such moduli does not even fall to 1/e of the other.
    if rival > (1 - 1 / SAMPLES) * abs(predicted):
        return None, f"another pole, of modulus {rival:.6g}, is too near to tell them apart"
    fit, reason = fit_dominant_pole(difference, order=len(all_poles), sizes=size, limits=LINEAR)
    if fit is None:
        return None, reason
    is_a_pole = np.abs(all_poles - fit.pole).min() < SPREAD
    if is_a_pole and abs(predicted - fit.pole) > SPREAD:
        return None, f"the kick hardly excites the dominant pole: what answers is one of modulus {abs(fit.pole):.6g}"
    return fit.pole, ""


def _measured_verdict(measured: complex | None, grows: bool, undecided: bool, close: float) -> MeasuredVerdict:
    """Return whether the error grew or decayed: by the pole, else by what became of the kick's error.

    `close`: so near to the circle the pole decides nothing.
    """
    if undecided if measured is None else abs(abs(measured) - 1) < close:
        return "too close to call"
    return "diverges" if (grows if measured is None else abs(measured) > 1) else "converges"


def _right(seen: MeasuredVerdict, at_rest: Verdict, moving: MovingPole, rate: float, *, periodic: bool) -> str:
    """Return which predictions have the measured verdict; "none" if none has, "" where nothing is measured."""
    if seen == "too close to call":
        return ""
    diverges = {"at rest": at_rest == "diverges"}
    if moving.verdict != "not settled":
        diverges["in motion"] = moving.verdict == "diverges"
    if math.isfinite(rate):
        diverges["exact" if periodic else "over the run"] = rate > 1
    return ", ".join(name for name, predicted in diverges.items() if predicted == (seen == "diverges")) or "none"
