"""Whose recursion a log follows, where no pole can be told but the point is known.

At known alpha_hat and beta_hat a method leaves nothing to be fitted. What it does to an error is

    p_0 c_k + p_1 c_(k+1) + ... + p_n c_(k+n) = 0,      P(z) = p_0 + p_1 z + ... + p_n z^n its polynomial,

so a few rows more than n show whether it may have made them: of a blow-up within five rows, of poles of one modulus, of
poles that turn with the mechanism. What is left over is told as a shift of the poles: if every pole were larger by the
share s of itself, P(z / (1 + s)) would vanish in its place, and to first order

    sum_j p_j c_(k+j) = s sum_j j p_j c_(k+j).

Hence s, by least squares, is a distance as that of poles is (`probed_poles`), and what a motion may do is as much. The
fit in some stretch of the log counts, as in linear prediction; a method whose recursion is longer than that, but for a
few rows, cannot be judged.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from fractions import Fraction

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import ArrayLike

from bezstab.errors import NumericalError
from bezstab.evidence.linear_prediction import SPREAD, response_windows
from bezstab.evidence.probed_poles import (
    SLOW,
    Comparison,
    Likeness,
    comparisons,
    linear_limits,
    motion_shift,
    poles_per_row,
    usable_response,
)
from bezstab.methods import Method
from bezstab.stability import FloatArray

EQUATIONS = 3
"""Least number of rows that a recursion must explain: of seventy methods some would explain two by chance."""

LONGEST = 60
"""Rows of a stretch: over more a mechanism that moves has changed."""

EXPLAINED = 0.05
"""Of the size of a recursion's terms: if more is left over, it does not explain the rows. Noise leaves a quarter."""

FOLLOWED = 0.02
"""Shift of the poles: if no recursion fits as well, the log follows none."""

UNEXPLAINED = 1.0
"""Shift that is told where a recursion explains the rows of no stretch."""

BEYOND_THE_BEST = 3.0
"""Times the shift of the method that fits best: what disturbs that disturbs others as much."""

DIFFERENCES = 2
"""Times that one run is differenced at most: each takes off a factor omega h of what a motion forces."""


def recursion_likenesses(
    c: ArrayLike,
    methods: Sequence[Method],
    alpha_hat: Fraction,
    beta_hat: Fraction,
    minus: ArrayLike | None = None,
    differenced: bool = False,
    between: Callable[[Method], int | None] | int = 1,
    turned: float | None = None,
) -> list[Likeness]:
    """Return how far samples are from following each method's recursion at a point, the nearest first; dimensionless.

    `c`, `minus` and `differenced` are as in `probed_pole`, the others as in `likenesses`. None at all if the samples
    follow no recursion; without methods whose recursion is too long for the samples. InputError for arrays of other
    shapes.
    """
    samples, _, _ = usable_response(c, minus)
    stretches = list(_stretches(samples, of_two_runs=differenced or minus is not None))
    shifts: list[tuple[Comparison, float]] = []
    for compared in comparisons(methods, alpha_hat, beta_hat, between):
        with suppress(NumericalError):  # of infinite poles
            polynomial = _polynomial_per_row(compared, alpha_hat, beta_hat)
            told = [shift for stretch in stretches if (shift := _shift(stretch, polynomial)) is not None]
            if told:
                shifts.append((compared, min(told)))
    best = min((shift for _, shift in shifts), default=UNEXPLAINED)
    if best > FOLLOWED:
        return []
    error = max(BEYOND_THE_BEST * best, SPREAD)
    found = [_likeness(compared, alpha_hat, beta_hat, shift, error, turned) for compared, shift in shifts]
    return sorted(found, key=lambda one: one.distance)


def _stretches(samples: FloatArray, of_two_runs: bool) -> Iterator[FloatArray]:
    """Yield stretches of the responses, shape (samples, responses), or of their differences, that may be linear.

    One run is differenced too, and what changes from row to row as little as what a motion forces is left out.
    """
    for times in range(1 if of_two_runs else DIFFERENCES + 1):
        changes = np.diff(samples, n=times, axis=0)
        if len(changes) < EQUATIONS or not np.nan_to_num(changes).any():
            return
        limits = linear_limits(changes)
        for response in changes.T:
            usable = response[np.isfinite(response)]
            for window in response_windows(usable, np.abs(usable), limits):
                stretch = usable[window][:LONGEST]
                if len(stretch) > EQUATIONS and (of_two_runs or _changes_fast(stretch)):
                    yield stretch


def _changes_fast(stretch: FloatArray) -> bool:
    return bool(np.median(np.abs(np.diff(stretch))) > SLOW * np.median(np.abs(stretch)))


def _polynomial_per_row(compared: Comparison, alpha_hat: Fraction, beta_hat: Fraction) -> FloatArray:
    """Return the polynomial of the method's poles per row of the log, in ascending powers."""
    if compared.between == 1:
        return np.array([float(coefficient) for coefficient in reversed(compared.polynomial)])
    z, _ = poles_per_row(compared, float(alpha_hat), float(beta_hat))
    return np.asarray(np.poly(z[z != 0] ** compared.between).real[::-1], np.float64)


def _shift(stretch: FloatArray, polynomial: FloatArray) -> float | None:
    """Return by which share of themselves poles must be larger for their recursion to fit a stretch, or UNEXPLAINED.

    None where the stretch has too few rows for it. Each equation is divided by its largest sample.
    """
    terms = len(polynomial)
    if len(stretch) < terms - 1 + EQUATIONS:
        return None
    rows = sliding_window_view(stretch, terms)
    largest = np.abs(rows).max(axis=1, keepdims=True)
    if not largest.all():
        return None
    rows = rows / largest
    left_over, by_shift = rows @ polynomial, rows @ (polynomial * np.arange(terms))
    if np.linalg.norm(left_over) > EXPLAINED * np.linalg.norm(rows @ np.diag(polynomial)):
        return UNEXPLAINED
    return min(float(np.linalg.norm(left_over) / np.linalg.norm(by_shift)), UNEXPLAINED)


def _likeness(
    compared: Comparison, alpha_hat: Fraction, beta_hat: Fraction, shift: float, error: float, turned: float | None
) -> Likeness:
    z, per_row = poles_per_row(compared, float(alpha_hat), float(beta_hat))
    moved = motion_shift(compared.method, float(alpha_hat), float(beta_hat), z, 0, turned)
    return Likeness(
        method=compared.method,
        predicted=complex(per_row[0]),
        distance=shift,
        error=error,
        allowed=error + compared.between * moved,
        dominant=True,
        same_as=compared.same_as,
        judged_by="recursion",
    )
