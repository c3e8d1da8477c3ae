"""Where lines of constant q are stable: a region by another route, without arcs, branches or intervals.

The feedback is mu^2 + p mu + q = 0. On a line of constant q the verdict changes only where a root z of pi lies on the
circle |z| = level: for a conjugate pair of mu, whose |mu|^2 is q, or for one real mu.

      q |      . - - .
        |    /         \\            the marks x are all the places where a root lies on the circle: zeros of a real
        |---x-----x-----x-----      polynomial in cos(theta), eigenvalues of its colleague matrix. Nothing is followed,
        |  (             )          sampled or searched, so none is missed; there may be one too many, which is no harm
        |   \\          /
        +-------------------- p

Between two neighbours the verdict is constant, and Schur's recursion, which computes no pole, decides it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from math import comb

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.pencils import Pencil, all_inside, deadbeat_mu

COSINE_SLACK = 1e-6  # a double zero splits by sqrt(eps) = 1e-8 into the complex plane; more candidates do no harm
TRUE_DEGREE = 1e-12  # relative: Chebyshev coefficients of a polynomial of lower degree are rounding, 1e-16 or so
SHARED = 1e-4  # of |mu|: a shared root is good to the root of rounding; more candidates do no harm
QUADRATIC_SAMPLES = 2600  # of theta for PECE, besides the graded ends: another grid than the arcs'
QUADRATIC_ZOOMS = 8  # each by 1/8: a turn to 1e-10 rad, where the modulus is flat to rounding
ILLINOIS = 14  # false positions from one sample to the next: the seventh is exact but next to a turn
REFINEMENTS = 5  # of Newton's method, from eight digits or more
TO_ANOTHER = 0.2  # of theta: a longer step could reach another zero
FAR = 1e300  # a finite stand-in for an infinite mu
LEADING = 1e-14  # of the largest coefficient: a leading coefficient below it is rounding of a zero


def mu_bound(pencil: Pencil, level: float) -> float:
    """Return a radius that holds every mu whose roots z all have |z| < level, of an explicit method.

    The coefficient of z^(n-i) is at most comb(n, i) level^i; each that depends on mu bounds mu by Cauchy's rule
    (|x| <= 2 max |c_j / c_d|^(1/(d-j))).
    """
    table = pencil.table
    degree = len(table) - 1
    bounds = []
    for i in range(1, degree + 1):
        row = np.trim_zeros(np.abs(table[degree - i]), "b")
        if len(row) < 2:
            continue
        row[0] += comb(degree, i) * level**i
        highest = len(row) - 1
        bounds.append(2 * max((row[j] / row[-1]) ** (1 / (highest - j)) for j in range(highest)))
    return float(min(bounds))


def _cosine_zeros(values_at: Callable[[FloatArray], FloatArray], degree: int, rows: int) -> FloatArray:
    """Return every zero in [-1, 1] of polynomials of a cosine; shape (rows, degree), nan where there are fewer.

    values_at takes the Chebyshev nodes, shape (degree + 1,), and returns shape (rows, degree + 1).  Zeros are the
    eigenvalues of the colleague matrix (Good, Quart. J. Math. 12, 1961).
    """
    if degree == 0:
        return np.full((rows, 1), np.nan)
    nodes = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    transform = 2 / (degree + 1) * np.cos(np.outer(np.arange(degree + 1), np.arccos(nodes)))
    transform[0] /= 2
    coefficients = values_at(nodes) @ transform.T
    size = np.abs(coefficients).max(axis=1)
    # Trailing zeros of rho and sigma lower the degree for every row; a zero kept at 1e14 would spoil the others.
    present = (np.abs(coefficients) > TRUE_DEGREE * size[:, np.newaxis]).any(axis=0)
    degree = int(np.flatnonzero(present).max(initial=0))
    if degree == 0:
        return np.full((rows, 1), np.nan)
    coefficients = coefficients[:, : degree + 1]
    floor = np.where(size > 0, LEADING * size, 1.0)
    leading = coefficients[:, -1]
    # A leading coefficient that is rounding of zero puts a zero at infinity; the floor keeps it far outside [-1, 1].
    leading = np.where(np.abs(leading) < floor, floor, leading)
    if degree == 1:
        zeros = (-coefficients[:, :1] / leading[:, np.newaxis]).astype(complex)
    else:
        colleague = np.zeros((rows, degree, degree))
        index = np.arange(degree - 1)
        colleague[:, index, index + 1] = 0.5
        colleague[:, index + 1, index] = 0.5
        colleague[:, 0, 1] = 1.0
        colleague[:, -1, :] -= coefficients[:, :-1] / (2 * leading[:, np.newaxis])
        zeros = np.linalg.eigvals(colleague)
    real = (np.abs(zeros.imag) < COSINE_SLACK) & (np.abs(zeros.real) < 1 + COSINE_SLACK)
    return np.where(real, np.clip(zeros.real, -1, 1), np.nan)


def real_events(pencil: Pencil, level: float) -> FloatArray:
    """Return every real mu at which a root z has |z| = level (and perhaps others), ascending; shape (events,)."""
    table = pencil.table
    found: list[float] = []
    for z in (level, -level):
        zeros = np.roots(np.trim_zeros(np.atleast_1d(polyval(z, table)), "b")[::-1])
        found += zeros[np.abs(zeros.imag) <= COSINE_SLACK * np.abs(zeros)].real.tolist()
    if pencil.steps > 1:
        found += _with_a_pair_on_the_circle(pencil, level)
    return np.unique(found)


def _with_a_pair_on_the_circle(pencil: Pencil, level: float) -> list[float]:
    """Return every real mu with a conjugate pair of roots z on the circle: there pi and its conjugate share a root mu.

    With pi = c_0 + c_1 mu (+ c_2 mu^2) and I_jk = Im(c_j conj(c_k)) that is I_01 = 0, or I_20^2 = I_21 I_10.
    """
    powers_of_mu = pencil.table.shape[1] - 1

    def eliminated(cosine: FloatArray) -> FloatArray:
        c = _coefficients_on_the_circle(pencil, level, cosine)
        sine = np.sqrt(1 - cosine**2)
        if powers_of_mu == 1:
            return np.asarray((c[0] * c[1].conj()).imag / sine)[np.newaxis]
        i20 = (c[2] * c[0].conj()).imag / sine
        i21 = (c[2] * c[1].conj()).imag / sine
        i10 = (c[1] * c[0].conj()).imag / sine
        return np.asarray(i20**2 - i21 * i10)[np.newaxis]

    cosine = _cosine_zeros(eliminated, (pencil.steps - 1) * powers_of_mu, 1)[0]
    found: list[float] = []
    for in_mu in _coefficients_on_the_circle(pencil, level, cosine[np.isfinite(cosine)]).T:
        mu = np.roots(np.trim_zeros(in_mu, "b")[::-1])
        found += mu[np.abs(mu.imag) <= SHARED * np.abs(mu)].real.tolist()
    return found


def _coefficients_on_the_circle(pencil: Pencil, level: float, cosine: FloatArray) -> ComplexArray:
    """Return the coefficients in mu of pi at z = level e^(i theta), theta in [0, pi]; shape (powers, *cosine.shape)."""
    z = level * (cosine + 1j * np.sqrt(np.maximum(0, 1 - cosine**2)))
    return np.asarray(polyval(z, pencil.table))


def island_radii(pencil: Pencil, level: float) -> FloatArray:
    """Return radii |mu| about each part of S_r of a one-step method; shape (radii,).

    Every part holds a zero c of R (maximum principle). Its size is about level / |R'(c)|, however small: the radii are
    |c| and multiples of that size beside it.
    """
    table = pencil.table
    zero = deadbeat_mu(pencil)
    with np.errstate(all="ignore"):
        size = np.abs(level * polyval(zero, table[1]) / polyval(zero, polyder(table[0])))
    size = np.minimum(size, np.abs(zero))
    beside = np.array([-4, -2, -1, -0.5, 0, 0.5, 1, 2, 4])
    return np.asarray(np.abs(np.abs(zero) + beside[:, np.newaxis] * size).ravel())


def turning_radii(pencil: Pencil, level: float) -> FloatArray:
    """Return |mu| where the locus turns towards or away from zero, for a multistep method; else nothing.

    There d log|mu| / d theta = -Im(z (rho'/rho - sigma'/sigma)) = 0, times |rho sigma|^2 / sin(theta) a polynomial in
    cos(theta).  A slice length has a square root there, and a part of S_r too thin to be met begins or ends there.
    """
    table = pencil.table
    if pencil.steps == 1 or table.shape[1] != 2:
        return np.zeros(0)
    slope = polyder(table)

    def values(cosine: FloatArray) -> FloatArray:
        sine = np.sqrt(1 - cosine**2)
        z = level * (cosine + 1j * sine)
        (a, b), (da, db) = polyval(z, table), polyval(z, slope)
        return np.asarray((z * (da * b - a * db) * (a * b).conj()).imag / sine)[np.newaxis]

    cosine = _cosine_zeros(values, 2 * (len(table) - 1), 1)[0]
    cosine = np.append(cosine[np.isfinite(cosine)], [-1, 1])
    a, b = polyval(level * np.exp(1j * np.arccos(cosine)), table)
    with np.errstate(all="ignore"):
        return np.asarray(np.abs(a / b))


def paired_crossings(pencil: Pencil, level: float, radius: FloatArray) -> FloatArray:
    """Return Re mu of every conjugate pair with |mu| = radius and a root z on |z| = level; shape (radii, candidates).

    radius: shape (radii,), > 0. Rows are padded with nan.
    """
    if pencil.steps == 1:
        return _one_step_crossings(pencil, level, radius)
    if pencil.table.shape[1] == 2:
        return _multistep_crossings(pencil, level, radius)
    return _quadratic_locus(pencil, level).crossings(radius)


def _one_step_crossings(pencil: Pencil, level: float, radius: FloatArray) -> FloatArray:
    """Return paired_crossings for z = R(mu): on |mu| = radius |R|^2 = level^2 is a polynomial in cos phi."""
    around = radius[:, np.newaxis]
    minus_r = pencil.table[0]
    slope = polyder(minus_r)

    def growth(cosine: FloatArray) -> FloatArray:
        mu = around * (cosine + 1j * np.sqrt(1 - cosine**2))
        return np.asarray(np.abs(polyval(mu, minus_r)) ** 2 - level**2)

    def step_at(phi: FloatArray) -> FloatArray:
        mu = around * np.exp(1j * phi)
        r = polyval(mu, minus_r)
        rate = (1j * mu * polyval(mu, slope) / r).real
        return np.asarray(np.log(np.abs(r) / level) / rate)

    return around * np.cos(_refined(_cosine_zeros(growth, pencil.table.shape[1] - 1, len(radius)), step_at))


def _multistep_crossings(pencil: Pencil, level: float, radius: FloatArray) -> FloatArray:
    """Return paired_crossings for mu = rho / sigma: |rho|^2 = radius^2 |sigma|^2 is a polynomial in cos theta.

    Near z = 1 a cosine keeps only half the digits of theta: each zero is refined in theta itself.
    """
    around = radius[:, np.newaxis]

    def balance(cosine: FloatArray) -> FloatArray:
        squared = np.abs(_coefficients_on_the_circle(pencil, level, cosine)) ** 2
        return np.asarray(squared[0] - around**2 * squared[1])

    def step_at(theta: FloatArray) -> FloatArray:
        z = level * np.exp(1j * theta)
        rho, minus_sigma = polyval(z, pencil.table)
        rho_slope, minus_sigma_slope = polyval(z, pencil.table_by_z)
        rate = (1j * z * (rho_slope / rho - minus_sigma_slope / minus_sigma)).real  # d log|mu| / d theta
        return np.asarray(np.log(np.abs(rho / minus_sigma) / around) / rate)

    theta = _refined(_cosine_zeros(balance, pencil.steps, len(radius)), step_at)
    with np.errstate(all="ignore"):
        rho, minus_sigma = polyval(level * np.exp(1j * theta), pencil.table)
        return np.asarray(np.clip((-rho / minus_sigma).real, -around, around))


def _refined(cosine: FloatArray, step_at: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return the angles of cosines after some of Newton's steps, but for those that would lead to another zero."""
    angle = np.arccos(cosine)
    with np.errstate(all="ignore"):
        for _ in range(REFINEMENTS):
            step = step_at(angle)
            angle = angle - np.where(np.abs(step) < TO_ANOTHER * angle, step, 0)
    return angle


@dataclass(frozen=True)
class _QuadraticLocus:
    """The moduli of both mu at |z| = level for PECE, sorted: two continuous functions of theta, no branch is followed.

    theta: shape (samples,), ascending from 0 to pi, with every turn of either function and every angle at which both
    are equal, and have a kink; moduli: shape (2, samples).
    (The resultant in the cosine, of degree 4 steps and a square near z = 1, keeps too few digits in float64.)
    """

    table: FloatArray
    level: float
    theta: FloatArray
    moduli: FloatArray

    def both(self, theta: FloatArray) -> ComplexArray:
        """Return both mu, the smaller first; shape (2, *theta.shape)."""
        with np.errstate(all="ignore"):
            c = polyval(self.level * np.exp(1j * theta), self.table)
            root = np.sqrt(c[1] ** 2 - 4 * c[0] * c[2])
            far = -(c[1] + np.where((c[1].conj() * root).real >= 0, root, -root)) / 2
            mu = np.stack([c[0] / far, far / c[2]])
        return np.where(np.isfinite(mu), mu, FAR)

    def _excess(self, which: int, target: FloatArray, theta: FloatArray) -> FloatArray:
        """Return by how much the smaller or larger mu (`which`) exceeds a radius in modulus; shapes of one kind."""
        excess: FloatArray = np.abs(self.both(theta)[which]) - target
        return excess

    def crossings(self, radius: FloatArray) -> FloatArray:
        """Return Re mu wherever either modulus equals a radius, nan padded; shape (rows, candidates)."""
        order = np.argsort(radius)
        levels = radius[order]
        rows, real_parts = [], []
        for which in range(2):
            values = self.moduli[which]
            first = np.searchsorted(levels, np.minimum(values[1:], values[:-1]), "right")
            count = np.searchsorted(levels, np.maximum(values[1:], values[:-1]), "right") - first
            cell = np.repeat(np.arange(len(count)), count)
            row = np.arange(count.sum()) + np.repeat(first - np.cumsum(count) + count, count)
            angle = false_position(
                partial(self._excess, which, levels[row]),
                (self.theta[cell], values[cell] - levels[row]),
                (self.theta[cell + 1], values[cell + 1] - levels[row]),
                rounds=ILLINOIS,
            )
            real_parts.append(self.both(angle)[which].real)
            rows.append(row)
        row, real = np.concatenate(rows), np.concatenate(real_parts)
        by_row = np.argsort(row, kind="stable")
        row, real = row[by_row], real[by_row]
        place = np.arange(len(row)) - np.searchsorted(row, row)
        found = np.full((len(radius), int(place.max(initial=0)) + 1), np.nan)
        found[order[row], place] = np.clip(real, -radius[order[row]], radius[order[row]])
        return found


@cache
def _quadratic_locus(pencil: Pencil, level: float) -> _QuadraticLocus:
    """Return the locus of a PECE method, sampled more finely towards 0 and pi, with every turn and kink of its moduli.

    Where the moduli are equal the gap between them turns, at zero.
    """
    near = np.geomspace(1e-8, 2e-2, 160)  # towards z = 1 and -1, where mu may vanish
    even = np.linspace(2e-2, np.pi - 2e-2, QUADRATIC_SAMPLES)
    theta = np.concatenate([[0], near, even, np.pi - near[::-1], [np.pi]])
    unsampled = _QuadraticLocus(pencil.table, level, theta, np.zeros((2, 0)))

    def turning(theta: FloatArray) -> FloatArray:
        """Return both moduli and the gap between them; shape (3, *theta.shape)."""
        smaller, larger = np.abs(unsampled.both(theta))
        return np.stack([smaller, larger, larger - smaller])

    turns = []
    for which, values in enumerate(turning(theta)):
        turn = 1 + np.flatnonzero(np.diff(np.sign(np.diff(values))))
        sign = np.where(values[turn] >= np.maximum(values[turn - 1], values[turn + 1]), 1, -1)
        low, high = theta[turn - 1], theta[turn + 1]
        for _ in range(QUADRATIC_ZOOMS):
            fine = np.linspace(low, high, 17)
            best = np.argmax(sign * turning(fine.ravel())[which].reshape(fine.shape), axis=0)
            columns = np.arange(len(turn))
            low, high = fine[np.maximum(best - 1, 0), columns], fine[np.minimum(best + 1, 16), columns]
        turns.append((low + high) / 2)
    theta = np.unique(np.concatenate([theta, *turns]))
    return _QuadraticLocus(pencil.table, level, theta, np.abs(unsampled.both(theta)))


@dataclass(frozen=True)
class Slices:
    """Stable intervals of p = -(mu_1 + mu_2) on lines of constant q: ends of shape (lines, candidates), nan padded."""

    ends: FloatArray
    stable: BoolArray  # shape (lines, candidates - 1): whether between two neighbouring ends

    def lengths(self) -> FloatArray:
        """Return the stable length of each line; shape (lines,)."""
        return np.asarray(np.where(self.stable, np.diff(self.ends, axis=1), 0).sum(axis=1))


def slices(pencil: Pencil, level: float, q: FloatArray, events: FloatArray, bound: float) -> Slices:
    """Return where lines of constant q, shape (lines,), none zero, are stable.

    events: from real_events; bound: from mu_bound.
    """
    radius = np.sqrt(np.abs(q))[:, np.newaxis]
    positive = q > 0
    pairs = np.full((len(q), 1), np.nan)
    if positive.any():
        found = paired_crossings(pencil, level, radius[positive, 0])
        pairs = np.full((len(q), found.shape[1]), np.nan)
        pairs[positive] = -2 * found
    split = np.where(positive[:, np.newaxis], np.concatenate([-2 * radius, 2 * radius], axis=1), np.nan)
    events = events[events != 0]
    lines = -(events + q[:, np.newaxis] / events)
    furthest = bound + np.abs(q[:, np.newaxis]) / bound
    ends = np.concatenate([pairs, split, lines, -furthest, furthest], axis=1)
    ends = np.sort(np.where(np.abs(ends) <= furthest, ends, np.nan), axis=1)
    p = (ends[:, 1:] + ends[:, :-1]) / 2
    half = -p / 2
    discriminant = half**2 - q[:, np.newaxis]
    root = np.sqrt(np.abs(discriminant))
    is_pair = discriminant < 0
    far = half + np.copysign(root, half)
    with np.errstate(all="ignore"):
        first = np.where(is_pair, half + 1j * root, far)
        second = np.where(is_pair, half, q[:, np.newaxis] / far)
    stable = all_inside(pencil, first, level)
    real = np.isfinite(p) & ~is_pair & stable
    stable[real] = all_inside(pencil, second[real].astype(complex), level)
    return Slices(ends, stable & np.isfinite(p))


def false_position(
    values_at: Callable[[FloatArray], FloatArray],
    first: tuple[FloatArray, FloatArray],
    last: tuple[FloatArray, FloatArray],
    rounds: int,
) -> FloatArray:
    """Return where smooth functions are zero between two places, each given with the values there, of unlike signs.

    Arrays of one shape, one search for each entry; values_at takes and returns such arrays. Each round draws a chord
    through the ends; an end that stays twice has its value halved (Illinois algorithm: Dowell & Jarratt, BIT 11, 1971).
    It takes a handful of rounds where bisection takes fifty.
    """
    low, below = first
    high, above = last
    middle = high
    for _ in range(rounds):
        with np.errstate(divide="ignore", invalid="ignore"):  # a chord between equal values leads nowhere
            middle = low - below * (high - low) / (above - below)
        middle = np.where(np.isfinite(middle), middle, (low + high) / 2)
        off = values_at(middle)
        same = np.sign(off) == np.sign(above)
        low, below = np.where(same, low, high), np.where(same, below / 2, above)
        high, above = middle, off
    return middle
