"""Linear prediction (Prony's method): the dominant pole in a sampled response, or why none can be told.

This module knows of samples only, not of mechanisms, methods or feedback.

The samples of a linear recursion are sums of powers of its poles,

    d_k = a_1 z_1^k + a_2 z_2^k + ... + a_p z_p^k,

so each sample is one and the same combination of the p samples before it:

    d_k = c_0 d_(k-p) + c_1 d_(k-p+1) + ... + c_(p-1) d_(k-1)        for every k >= p,

and the poles are the roots of z^p - c_(p-1) z^(p-1) - ... - c_0. Hence three steps, for any stretch of a response:
least squares for the coefficients c, the roots of that polynomial for the poles z, and least squares again for the
amplitudes a, because a root without amplitude belongs to the noise.

What is difficult is to choose the stretch. A response that decays looks like this (log |d| over k):

    |d|  *
         | * .                  too early: poles that decay fast are still seen, which is harmless but costs digits
         |    *  .
         |       *   .          usable: the dominant pole is left, well above what does not decay
         |           *    .
         |                *  .
         |~~~~~~~~~~~~~~~~~~~*~~~~~~~~~~~   too late: forcing and round-off, which no recursion explains
         +------------------------------------ k

and one that grows leaves the range in which the system is linear. Nobody knows beforehand where the usable part begins
and ends. So many windows are tried, each gives a fit or none, and a pole is claimed only if the better half of the fits
has found one and the same.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bezstab.stability.arrays import ComplexArray, FloatArray

ABOVE_FORCED = (1e2, 1e3, 1e4, 1e5, 1e6)
"""Least |d| of a window, in units of the largest |d| in the second half of the response: above what is forced."""

NEGLIGIBLE = 1e-3
"""A share that does not count: of the largest sample, what is left at the end is forced, not still decaying; of the
largest amplitude, a root with less belongs to the noise; of a sample, a pole so small is gone with the next."""

SKIPPED = (0.5, 0.3, 0.0)
"""Share of a window that is left to the poles that decay fast."""

SAMPLES = 400
"""Of a window at most: the system that answers may change meanwhile."""

RESIDUAL = 1e-4
"""Relative, of a recursion that is believed. The least order that reaches it is taken, so that noise is not fitted."""

LESS = 0.1
"""Of the residual: a longer recursion that leaves so much over shows poles, not noise."""

STANDARD_ERRORS = 3.0
"""That are stated, and beyond which nothing is taken for chance: 99.7 % of normal errors are less."""

TIMES_FARTHEST = 2.0
"""Times the farthest pole of the better half of the fits, that is stated: windows overlap, and err alike."""

PARTING = 2.0
"""Over a window, of the logarithms of two poles' powers: as a mechanism moves, one pole twice has looked so."""

SPREAD = 1e-3
"""Of |z|, and rad: fits that differ by more have not found one and the same pole."""


@dataclass(frozen=True)
class Fit:
    """The poles of a response, per sample, and how well the dominant one is known.

    `poles` carry amplitude in a window of the response and lie in the closed upper half plane, for conjugates are poles
    too; by modulus. `residual` is the relative error of the window's recursion, `start` its first sample and `samples`
    its length. `uncertainty` bounds the error of the dominant pole in the plane, as far as samples can tell: what the
    recursion leaves open, or by how much other windows are off it where that is more.
    """

    poles: tuple[complex, ...]
    residual: float
    start: int
    samples: int
    uncertainty: float

    @property
    def pole(self) -> complex:
        """The dominant pole."""
        return self.poles[0]


def fit_dominant_pole(
    responses: FloatArray,
    order: int,
    sizes: FloatArray | None = None,
    limits: Sequence[float] = (np.inf,),
    floor: float = 0.0,
) -> tuple[Fit | None, str]:
    """Return the dominant pole that several responses of one linear system share, or None and why it cannot be had.

    `responses` has shape (samples, responses), equally spaced in time; unit as the user likes, for the pole has none.
    `order` is the largest number of poles to look for. `sizes`, of the same shape and by default |responses|, is what
    must not exceed a limit for the system to answer linearly; every one of `limits` is tried. `floor`, in the unit of
    the samples, is what their rounding amounts to: like what is forced, it stays far below a window. A number that is
    not finite ends a response. No errors are raised.

    Every window of every response gives a fit. Of the half with the smaller residuals the one of median |z| is taken;
    if these differ, or stem from one window only, no pole is claimed (Prony's method: Hildebrand, Introduction to
    Numerical Analysis, 2nd ed., section 9.4).
    """
    if sizes is None:
        sizes = np.abs(responses)
    fits: list[Fit] = []
    longest = 0
    for response, size in zip(responses.T, sizes.T, strict=True):
        for window in response_windows(response, size, limits, floor):
            samples = response[window]
            longest = max(longest, len(samples))
            fit = fit_window(samples, order, window.start)
            if fit is not None:
                fits.append(fit)
    fits.sort(key=lambda fit: fit.residual)
    better_half = fits[: (len(fits) + 1) // 2]
    # Several responses in one window are no independent witnesses: they may differ by a factor only.
    if len({(fit.start, fit.samples) for fit in better_half}) < 2:
        return None, f"no linear recursion fits the {longest} samples between round-off and the linear range"
    z = np.array([fit.pole for fit in better_half])
    moduli = np.abs(z)
    for quantity, values in {"|z| (relative)": moduli / moduli.max(), "angle (rad)": np.angle(z)}.items():
        spread = float(np.ptp(values))
        if not spread <= SPREAD:  # not a number included
            differing = f"{spread:.1g} in {quantity}"
            return None, f"fits differ by {differing}: poles of nearly equal modulus, or too much forced error"
    median = better_half[int(np.argsort(moduli)[len(moduli) // 2])]
    farthest = TIMES_FARTHEST * float(np.abs(z - median.pole).max())
    return replace(median, uncertainty=max(farthest, median.uncertainty)), ""


def response_windows(response: FloatArray, size: FloatArray, limits: Sequence[float], floor: float) -> Iterator[slice]:
    """Yield the stretches of one response, shape (samples,), that lie in the linear range and above what is forced.

    What is forced is at least `floor`, the rounding of the samples.
    """
    ends: set[int] = set()
    for limit in limits:
        outside = np.flatnonzero(~(size <= limit))  # not a number included
        end = int(outside[0]) if outside.size else len(response)
        within = np.abs(response[:end])
        largest = within.max(initial=0.0)
        remaining = max(within[len(within) // 2 :].max(initial=0.0), floor)
        if remaining < NEGLIGIBLE * largest:
            # It has decayed to what is forced: end where it is last well above that.
            for factor in ABOVE_FORCED:
                last_above = np.flatnonzero(within > factor * remaining).max(initial=-1)
                ends.add(int(last_above) + 1)
        else:
            ends.add(len(within))
    for end in sorted(ends):
        for share in SKIPPED:
            start = int(share * end)
            yield slice(start, min(end, start + SAMPLES))


def fit_window(samples: FloatArray, order: int, start: int = 0) -> Fit | None:
    """Return what the shortest recursion of at most `order` says of the samples, which begin at `start`; None without.

    A recursion of p terms is tried only on 2p + 2 samples and more, so that there are more equations than unknowns.
    """
    fit = None
    for terms in range(1, order + 1):
        if len(samples) < 2 * terms + 2:
            break
        # Each row is an equation: p samples and the one after them. Rows are scaled to their largest entry, so that
        # decay does not hide the later ones.
        rows = sliding_window_view(samples, terms + 1)
        largest = np.abs(rows).max(axis=1, keepdims=True)
        if not largest.all():
            break
        rows = rows / largest
        before, after = rows[:, :terms], rows[:, terms]
        coefficients = np.linalg.lstsq(before, after, rcond=None)[0]
        left_over = before @ coefficients - after
        residual = float(np.linalg.norm(left_over) / np.linalg.norm(after))
        if residual > (LESS * fit.residual if fit else RESIDUAL):
            if fit:
                break
            continue
        roots = np.roots([1.0, *-coefficients[::-1]]).astype(complex)
        poles = _poles_with_amplitude(samples, roots)
        error = STANDARD_ERRORS * _formal_error(before, left_over, coefficients, poles[0])
        error += _off_if_two(roots, poles[0], residual, len(samples))
        if fit:  # a shorter one has fitted, too
            error += abs(poles[0] - fit.pole)
        fit = Fit(poles, residual, start, len(samples), error)
    return fit


def _formal_error(before: FloatArray, left_over: FloatArray, coefficients: FloatArray, pole: complex) -> float:
    """Return the standard error of a root of z^p - c_(p-1) z^(p-1) - ... - c_0 if what least squares left is noise.

    A change dc of the coefficients moves a root by sum_j dc_j z^j / p'(z).
    """
    terms = len(coefficients)
    slope = np.polyval(np.polyder(np.array([1.0, *-coefficients[::-1]])), pole)
    deviation = np.linalg.norm(left_over) / np.sqrt(len(left_over) - terms)
    response = (pole ** np.arange(terms) / slope) @ np.linalg.pinv(before)
    return float(deviation * np.linalg.norm(response))


def _off_if_two(roots: ComplexArray, pole: complex, residual: float, samples: int) -> float:
    """Return how far the largest of the roots may be off as two close poles look like one, or one like two.

    Of (a + b k) z^k neighbours have a ratio that changes by (b / a)^2 from row to row, and so deviates by that times
    samples / sqrt(12): that is hidden where it comes to less than what is left over. Two roots whose powers part by
    less than a factor e^PARTING over the window, or by less than PARTING radians, may be one pole twice.
    """
    hidden = STANDARD_ERRORS * abs(pole) * np.sqrt(np.sqrt(12) * residual / samples)
    distances = np.abs(roots - pole)
    close = distances[distances * samples < PARTING * abs(pole)]
    return float(hidden + close.max())


def _poles_with_amplitude(samples: FloatArray, z: ComplexArray) -> tuple[complex, ...]:
    """Return those of the roots z that carry an amplitude in the samples, largest first, of the upper half plane."""
    amplitudes = np.abs(fitted_powers(samples, z, np.log(np.abs(z).max()) * np.arange(len(samples)))[0])
    carrying = z[(amplitudes > NEGLIGIBLE * amplitudes.max()) & (z.imag >= 0)]
    return tuple(sorted(carrying.tolist(), key=abs, reverse=True))


def fitted_powers(samples: FloatArray, z: ComplexArray, log_sizes: FloatArray) -> tuple[ComplexArray, float]:
    """Return the amplitudes with which powers of z leave least of the samples over, and how much, relative.

    `samples` have the shape (samples, *responses), amplitudes (poles, *responses). Each sample, and the powers beside
    it, count in units of a size, whose logarithm is given, (samples,): so that neither overflows and none is hidden by
    others. Not a number where powers leave float64 even so.
    """
    k, largest = np.arange(len(samples))[:, np.newaxis], np.abs(z).max()
    with np.errstate(all="ignore"):
        powers = (z / largest) ** k * np.exp(k * np.log(largest) - log_sizes[:, np.newaxis])
        scaled = (samples.T * np.exp(-log_sizes)).T
    if not (np.isfinite(powers).all() and np.isfinite(scaled).all()):
        return np.full((len(z), *samples.shape[1:]), np.nan), np.nan
    amplitudes = np.linalg.lstsq(powers, scaled, rcond=None)[0]
    return amplitudes, float(np.linalg.norm(powers @ amplitudes - scaled) / np.linalg.norm(scaled))
