"""Whose recursion a log follows, where no pole can be told but the point is known.

At known alpha_hat and beta_hat a method leaves nothing to be fitted. What it does to an error is

    p_0 c_k + p_1 c_(k+1) + ... + p_n c_(k+n) = 0,      P(z) = p_0 + p_1 z + ... + p_n z^n its polynomial,

so a few rows more than n show whether it may have made them: of a blow-up within five rows, of poles of one modulus, of
poles that turn with the mechanism. What is left over is told as a shift of the poles: if every pole were larger by the
share s of itself, P(z / (1 + s)) would vanish in its place, and to first order

    sum_j p_j c_(k+j) = s sum_j j p_j c_(k+j).

Hence s, by least squares, is a distance as that of poles is (`probed_poles`), and what a motion may do is as much. The
fit in some stretch of the log counts, as in linear prediction.

Where no recursion can be tested so, of a method that is longer than the rows but for a few, or of any in rows that a
motion or large errors disturb, a method can still be excluded: each of its equations must be left over by a large share
of its terms. What is neither tested nor excluded may have made the log.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
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

EQUATIONS_OF_ONE_RUN = 5
"""The same of one run's rows: of fewer, what the motion forces may hide the true recursion and resemble another."""

LONGEST = 60
"""Rows of a stretch: over more a mechanism that moves has changed."""

EXPLAINED = 0.05
"""Of the size of a recursion's terms: if more is left over, it does not explain the rows. Noise leaves a quarter."""

FOLLOWED = 0.02
"""Shift of the poles: if no recursion fits as well, the log follows none."""

UNEXPLAINED = 1.0
"""Shift that is told where a recursion explains the rows of no stretch."""

BEYOND_THE_BEST = 10.0
"""Times the shift of the method that fits best: what disturbs that disturbs others as much. Of 10,000 starts of logs
the true method was off by eight times at most, where nine rows or fewer let another fit by chance."""

DIFFERENCES = 4
"""Times that one run is differenced at most: each takes off a factor omega h of what a motion forces, so that more rows
of what decays within a few stand out."""

AT_THE_KICK = 1
"""Rows that are not tested: a simulator may remember accelerations of before a kick, which is in the first row."""

EXCLUDING = 2
"""Equations that must contradict a method: the first may, for the same reason."""

CONTRADICTED = 0.5
"""Of its largest term: what each of a method's equations must leave over. Of some 10,000 starts of logs of random runs,
with that many equations, one of the true method's leaves 0.15 at most."""


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

    `c`, `minus` and `differenced` are as in `probed_pole`, the others as in `likenesses`. Methods whose recursion
    cannot be tested come last, judged by exclusion: of samples that follow no recursion these are all. There are none
    at all for fewer than two samples, or if nothing changes. InputError for arrays of other shapes.
    """
    samples, rounding, _ = usable_response(c, minus)
    if len(samples) < 2 or not np.ptp(samples, axis=0).any():
        return []
    of_two_runs = differenced or minus is not None
    recursions: list[tuple[Comparison, FloatArray]] = []
    for compared in comparisons(methods, alpha_hat, beta_hat, between):
        with suppress(NumericalError):  # of infinite poles
            recursions.append((compared, _polynomial_per_row(compared, alpha_hat, beta_hat)))
    needed = AT_THE_KICK + (EQUATIONS if of_two_runs else EQUATIONS_OF_ONE_RUN)
    testable = np.array([len(samples) - (len(polynomial) - 1) >= needed for _, polynomial in recursions], bool)
    shifts = np.full(len(recursions), np.nan)
    shifts[testable] = _shifts(
        _stretches(samples, rounding / 2, of_two_runs),
        [polynomial for (_, polynomial), enough in zip(recursions, testable, strict=True) if enough],
    )
    error = max(BEYOND_THE_BEST * float(np.fmin.reduce(shifts, initial=UNEXPLAINED)), SPREAD)
    found = []
    for (compared, polynomial), shift in zip(recursions, shifts.tolist(), strict=True):
        if np.isnan(shift):
            left_over = _least_left_over(samples, polynomial, of_two_runs)
            found.append(_by_exclusion(compared, alpha_hat, beta_hat, left_over))
        else:
            found.append(_by_recursion(compared, alpha_hat, beta_hat, shift, error, turned))
    return sorted(found, key=_order)


def _order(one: Likeness) -> tuple[bool, float]:
    """Return what puts tested methods first, the nearest before others, and those that are excluded untested last."""
    return one.judged_by == "exclusion", CONTRADICTED if np.isnan(one.distance) else one.distance


def _stretches(samples: FloatArray, floor: float, of_two_runs: bool) -> Iterator[FloatArray]:
    """Yield stretches of the responses, shape (samples, responses), or of their differences, that may be linear.

    One run is differenced too, and what changes from row to row as little as what a motion forces is left out. `floor`
    is what the rounding of the samples amounts to.
    """
    for times in range(1 if of_two_runs else DIFFERENCES + 1):
        changes = np.diff(samples, n=times, axis=0)
        if len(changes) < EQUATIONS or not np.nan_to_num(changes).any():
            return
        limits = linear_limits(changes)
        for response in changes.T:
            usable = response[np.isfinite(response)]
            for window in response_windows(usable, np.abs(usable), limits, 2**times * floor):
                stretch = usable[max(window.start, AT_THE_KICK) : window.stop][:LONGEST]
                if len(stretch) > EQUATIONS and (of_two_runs or _changes_fast(stretch)):
                    yield stretch


def _changes_fast(stretch: FloatArray) -> bool:
    return bool(np.median(np.abs(np.diff(stretch))) > SLOW * np.median(np.abs(stretch)))


def _polynomial_per_row(compared: Comparison, alpha_hat: Fraction, beta_hat: Fraction) -> FloatArray:
    """Return the polynomial of the method's poles per row of the log, in ascending powers, with its roots at zero.

    NumericalError where they are infinite.
    """
    z, _ = poles_per_row(compared, float(alpha_hat), float(beta_hat))
    rows_at_zero = -(-compared.at_zero // compared.between)
    if compared.between == 1:
        ascending = np.array([float(coefficient) for coefficient in reversed(compared.polynomial)])
    else:
        largest = z[np.argsort(-np.abs(z))][: len(compared.polynomial) - 1]
        ascending = np.poly(largest**compared.between).real[::-1]
    return np.concatenate([np.zeros(rows_at_zero), ascending])


def _shifts(stretches: Iterable[FloatArray], polynomials: Sequence[FloatArray]) -> FloatArray:
    """Return the least shift of each polynomial's poles in a stretch that follows any recursion; nan without a test.

    A stretch that follows none is disturbed, and says nothing against a method that can be tested nowhere else.
    """
    least = np.full(len(polynomials), np.nan)
    for stretch in stretches:
        shifts = np.array([_shift(stretch, polynomial) for polynomial in polynomials])
        if (shifts <= FOLLOWED).any():
            least = np.fmin(least, shifts)
    return least


def _shift(stretch: FloatArray, polynomial: FloatArray) -> float:
    """Return by which share of themselves poles must be larger for their recursion to fit a stretch, or UNEXPLAINED.

    Not a number where the stretch has too few rows for it. Each equation is divided by its largest sample.
    """
    terms = len(polynomial)
    if len(stretch) < terms - 1 + EQUATIONS:
        return np.nan
    rows = sliding_window_view(stretch, terms)
    largest = np.abs(rows).max(axis=1, keepdims=True)
    if not largest.all():
        return np.nan
    rows = rows / largest
    left_over = float(np.linalg.norm(rows @ polynomial))
    if left_over > EXPLAINED * np.linalg.norm(rows @ np.diag(polynomial)):
        return UNEXPLAINED
    by_shift = float(np.linalg.norm(rows @ (polynomial * np.arange(terms))))
    if left_over == 0:
        return 0.0
    return left_over / by_shift if left_over < UNEXPLAINED * by_shift else UNEXPLAINED


def _by_recursion(
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


def _by_exclusion(compared: Comparison, alpha_hat: Fraction, beta_hat: Fraction, left_over: float) -> Likeness:
    """Return whether the rows contradict a method that they cannot test, by what its equations leave over at least."""
    if np.isnan(left_over):
        reason = "not excluded: too few rows for its recursion"
    elif left_over <= CONTRADICTED:
        reason = "not excluded: too disturbed, or too few rows, to test its recursion"
    else:
        reason = "excluded: its recursion leaves more than half of a term over in every row"
    _, per_row = poles_per_row(compared, float(alpha_hat), float(beta_hat))
    return Likeness(
        method=compared.method,
        predicted=complex(per_row[0]),
        distance=left_over,
        error=CONTRADICTED,
        allowed=CONTRADICTED,
        dominant=True,
        same_as=compared.same_as,
        judged_by="exclusion",
        reason=reason,
    )


def _least_left_over(samples: FloatArray, polynomial: FloatArray, of_two_runs: bool) -> float:
    """Return what each of a recursion's equations leaves over at least, as a share of its largest term.

    Not a number with fewer than EXCLUDING equations; of one run they count without a constant offset.
    """
    terms = len(polynomial)
    rows = int(np.isfinite(samples).sum(axis=0).max())
    if rows - (0 if of_two_runs else 1) < terms - 1 + EXCLUDING:
        return np.nan
    shares: list[float] = []
    for times in range(1 if of_two_runs else DIFFERENCES + 1):
        for response in np.diff(samples, n=times, axis=0).T:
            usable = response[np.isfinite(response)]
            if len(usable) >= terms:
                of_terms = sliding_window_view(usable, terms) * polynomial
                largest = np.abs(of_terms).max(axis=1)
                shares.extend((np.abs(of_terms.sum(axis=1))[largest > 0] / largest[largest > 0]).tolist())
    return min(shares, default=np.nan)
