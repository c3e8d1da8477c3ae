"""The poles in a response that noise covers, by least squares, or that there is nothing but noise.

Linear prediction (`linear_prediction`) fits each sample to those before it and so takes the noise of one for signal of
the next; it believes a recursion only where next to nothing is left over. Here what is fitted is the response itself,

    d_k = a_1 z_1^k + a_2 z_2^k + ... + a_p z_p^k + e_k,        e_k white noise of one size, which nobody knows.

Poles that fit nearly come from the singular vectors of the Hankel matrix of the samples, which p poles alone would
give rank p; Gauss and Newton's method takes them to where the squares of what is left over are least, the amplitudes
eliminated. With white noise that is the likeliest answer, and its linearisation says how far off the poles may be.

How many poles there are is asked of the noise: one more must explain more than noise would let it. Where what is left
over is not white, or larger at one end than at the other, the response is no such sum, and nothing is claimed of that
stretch; a shorter one may be. But noise does not end with the stretch: a few poles fit whatever is short and smooth, so
what they leave over must be as large as the noise of the rows that follow.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from bezstab.evidence.linear_prediction import NEGLIGIBLE, SAMPLES, STANDARD_ERRORS, TIMES_FARTHEST
from bezstab.stability import EPS, ComplexArray, FloatArray

FREEDOM = 24
"""Samples more than unknowns, at least: of fewer nobody can tell whether what is left over is white."""

VISIBLE = 8
"""Samples in which a pole must stand out of the noise to be counted: of fewer, a pair is not told from a real one."""

BEYOND = 3
"""Poles more than are worth it: a pair can be where one is not, and what they would change is told as an error."""

ITERATIONS = 40
"""Of Newton's method at most: from a start that leads anywhere it settles within some twenty. Gauss and Newton's ends
before, where a change is NEGLIGIBLE beside the standard errors, or none that is not leaves less over."""

RESOLVED = 0.05
"""In the plane: a pole that is nearer to 1 changes from row to row as little as what a motion forces. Of one that is
not known to so much errors are no longer normal, and nobody is helped."""


@dataclass(frozen=True)
class NoisyFit:
    """What a stretch of a response shows beside white noise.

    `poles` are those in the closed upper half plane, per sample and by modulus, each with how far off it may be in the
    plane: STANDARD_ERRORS; none where all is noise. `noise` is the standard deviation of the noise, in the unit of the
    response, `samples` the length of the stretch.
    """

    poles: dict[complex, float]
    noise: float
    samples: int


def fit_in_noise(response: FloatArray, order: int) -> NoisyFit | None:
    """Return the poles that a response of a linear system shows beside white noise; None if what is left is no noise.

    `response` has shape (samples,), equally spaced in time; the unit is the user's. `order`: largest number of poles.
    A number that is not finite ends it. Of the stretches from the start on, each half as long as the one before, the
    first that can be explained counts. Nonlinear least squares by variable projection (Golub and Pereyra, SIAM J.
    Numer. Anal. 10, 1973), from the matrix pencil's poles (Hua and Sarkar, IEEE Trans. ASSP 38, 1990).
    """
    usable = response[: int(np.logical_and.accumulate(np.isfinite(response)).sum())]
    end = min(len(usable), SAMPLES)
    while end > FREEDOM:
        for start in (0, order):  # of long methods the first few samples belong to poles that are soon gone
            fit = _fit_stretch(usable[start:end], order)
            if fit is not None and _goes_on(fit.noise, usable[end:]):
                return fit
        end //= 2
    return None


def _goes_on(noise: float, rest: FloatArray) -> bool:
    """Return whether the rows after a stretch have noise of that size too: differences take off what is smooth.

    A difference of fourth order of white noise has 70 times its variance.
    """
    if len(rest) < FREEDOM:
        return True
    with np.errstate(all="ignore"):  # what is too large for float64 is no noise of that size
        square = float(np.mean(np.diff(rest / noise, n=4) ** 2) / 70)
    # The differences are related: the logarithm of their mean square has some 4.5 times the variance.
    return _near(square, 1.0, 9 / len(rest))


def _near(square: float, other: float, variance: float) -> bool:
    """Return whether mean squares of noise may be of one size: of n samples the logarithm has the variance 2 / n.

    `variance` is that of the logarithm of their quotient.
    """
    with np.errstate(all="ignore"):  # zero is no noise
        return bool(abs(np.log(square) - np.log(other)) < STANDARD_ERRORS * np.sqrt(variance))


def _fit_stretch(samples: FloatArray, order: int) -> NoisyFit | None:
    """Return the poles and the noise of one stretch, shape (samples,); None if what is left is no noise."""
    level = np.abs(samples).max()
    if not level:
        return None
    sums = _sums(samples / level, order)
    best = int(np.argmin([each.worth for each in sums[: order + 1]]))
    chosen, richer = sums[best], sums[best + 1 : best + BEYOND]
    if not (chosen.deviation and _unrelated(chosen.left_over) and _even(chosen.left_over)):
        return None
    return NoisyFit(_visible_poles(chosen, richer), float(chosen.deviation * level), len(samples))


def _sums(samples: FloatArray, order: int) -> "list[_Sum]":
    """Return sums of no, one, two and more poles that are fitted to a stretch, until BEYOND more are worth nothing."""
    # Singular vectors of the Hankel matrix, those of the largest values first.
    hankel = sliding_window_view(samples, len(samples) // 2)
    vectors = np.linalg.svd(hankel, full_matrices=False)[2].T
    sums = [_sum(samples, np.zeros(0, complex))]
    for count in range(1, order + BEYOND):
        # Poles that nearly fit multiply sums of powers shifted by a row.
        z = np.linalg.eigvals(np.linalg.lstsq(vectors[:-1, :count], vectors[1:, :count], rcond=None)[0])
        fitted = _fitted(samples, z.astype(complex))
        if fitted.freedom < FREEDOM:
            break
        sums.append(fitted)
        if min(each.worth for each in sums[-BEYOND:]) > min(each.worth for each in sums):
            break
    return sums


def _visible_poles(chosen: "_Sum", richer: "Sequence[_Sum]") -> dict[complex, float]:
    """Return the poles that explain more than noise, by modulus, of the closed upper half plane, and their errors.

    A pole that is too weak to be counted may still shift the others: by how much, sums of more poles say.
    """
    real = chosen.z.imag == 0
    of_pairs = np.where(real, 1, 2) * np.abs(chosen.explained.real)  # a pair counts together
    visible = (of_pairs > chosen.deviation).sum(axis=0) >= VISIBLE
    # The standard error in the plane, of a pair that of both parts together.
    errors = np.abs(chosen.z) * chosen.deviation * np.linalg.norm(np.linalg.pinv(chosen.slopes), axis=1)
    # By Cornish and Fisher's expansion as many of the errors of fewer samples are less.
    factor = STANDARD_ERRORS * (1 + (STANDARD_ERRORS**2 + 1) / (4 * chosen.freedom))
    found = {}
    for place in np.argsort(-np.abs(chosen.z), kind="stable"):
        z = complex(chosen.z[place])
        if visible[place] and z.imag >= 0:
            shift = max((float(np.abs(other.z - z).min()) for other in richer), default=0.0)
            found[z] = factor * float(errors[place]) + TIMES_FARTHEST * shift
    return found


@dataclass(frozen=True)
class _Sum:
    """A sum of powers of the poles z, conjugates too, and what it leaves over of a stretch, (samples,).

    `slopes` (samples, poles) are those of what is left over by ln z of each pole, the amplitudes eliminated.
    `explained` (samples, poles) is what each explains; of a pair the sum is real.
    """

    z: ComplexArray
    left_over: FloatArray
    slopes: ComplexArray
    explained: ComplexArray

    @property
    def squares(self) -> float:
        """The sum of squares that is left over."""
        return float(np.sum(self.left_over**2))

    @property
    def freedom(self) -> int:
        """Samples more than unknowns: poles and their amplitudes."""
        return len(self.left_over) - 2 * len(self.z)

    @property
    def deviation(self) -> float:
        """The standard deviation of the noise."""
        return float(np.sqrt(self.squares / max(self.freedom, 1)))

    @property
    def worth(self) -> float:
        """What is the less, the more likely a sum is: squares left over, and the unknowns it takes (Bayes' criterion).

        With a larger price weak poles are left out, and shift the others unseen.
        """
        samples = len(self.left_over)
        with np.errstate(divide="ignore"):
            return float(samples * np.log(self.squares) + (samples - self.freedom) * np.log(samples))


def _sum(samples: FloatArray, z: ComplexArray) -> _Sum:
    """Return the sum of powers of given poles that leaves least over."""
    # What is gone with the next row may be anything so small, but for zero, which has no logarithm.
    z = np.where(np.abs(z) < NEGLIGIBLE, NEGLIGIBLE, z)
    k = np.arange(len(samples))[:, np.newaxis]
    growth = (len(samples) - 1) * np.maximum(np.log(np.abs(z)), 0.0)  # so that what grows ends at one
    powers = np.exp(k * np.log(z) - growth)
    inverse = np.linalg.pinv(powers, rcond=EPS * len(samples))
    explained = powers * (inverse @ samples)
    slopes = -k * explained
    return _Sum(z, samples - explained.real.sum(axis=1), slopes - powers @ (inverse @ slopes), explained)


def _fitted(samples: FloatArray, z: ComplexArray) -> _Sum:
    """Return the sum that leaves least over, of as many poles as nearly fit, by Gauss and Newton's method."""
    best = _sum(samples, z)
    for _ in range(ITERATIONS):
        change = -np.linalg.lstsq(best.slopes, best.left_over, rcond=None)[0]
        following = _sum(samples, _moved(best.z, np.asarray(change)))
        gained = best.squares - following.squares
        if gained > 0:
            best = following
        if not gained > NEGLIGIBLE**2 * best.squares / max(best.freedom, 1):
            break
    return best


def _moved(z: ComplexArray, change: ComplexArray | FloatArray) -> ComplexArray:
    """Return poles whose ln z is changed, by one at most; those that are real stay real."""
    change = np.where(z.imag == 0, change.real, change / np.maximum(1, np.abs(change)))
    return np.asarray(z * np.exp(np.clip(change.real, -1, 1) + 1j * change.imag))


def _unrelated(noise: FloatArray) -> bool:
    """Return whether samples are not related to those a few before them (Ljung and Box)."""
    count = len(noise)
    lags = round(np.log(count))  # as many distances, in samples: Tsay, Analysis of Financial Time Series, section 2.2
    total = float(noise @ noise)
    related = sum((float(noise[lag:] @ noise[:-lag]) / total) ** 2 / (count - lag) for lag in range(1, lags + 1))
    return bool(count * (count + 2) * related < lags + STANDARD_ERRORS * np.sqrt(2 * lags) + STANDARD_ERRORS**2 / 2)


def _even(noise: FloatArray) -> bool:
    """Return whether both halves are of one size."""
    half = len(noise) // 2
    return _near(float(np.mean(noise[:half] ** 2)), float(np.mean(noise[half:] ** 2)), 4 / half)
