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
from math import comb

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval

from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.mu_pencils import MuPencil, all_inside, deadbeat_mu

COSINE_SLACK = 1e-6  # a double zero splits by sqrt(eps) = 1e-8 into the complex plane; more candidates do no harm
TRUE_DEGREE = 1e-12  # relative: Chebyshev coefficients of a polynomial of lower degree are rounding, 1e-16 or so
SHARED = 1e-4  # of |mu|: a shared root is good to the root of rounding; more candidates do no harm
REFINEMENTS = 5  # of Newton's method, from eight digits or more
TO_ANOTHER = 0.2  # of theta: a longer step could reach another zero
LEADING = 1e-14  # of the largest coefficient: a leading coefficient below it is rounding of a zero


def mu_bound(pencil: MuPencil, level: float) -> float:
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


def real_events(pencil: MuPencil, level: float) -> FloatArray:
    """Return every real mu at which a root z has |z| = level (and perhaps others), ascending; shape (events,)."""
    table = pencil.table
    found: list[float] = []
    for z in (level, -level):
        zeros = np.roots(np.trim_zeros(np.atleast_1d(polyval(z, table)), "b")[::-1])
        found += zeros[np.abs(zeros.imag) <= COSINE_SLACK * np.abs(zeros)].real.tolist()
    if pencil.steps > 1:
        found += _with_a_pair_on_the_circle(pencil, level)
    return np.unique(found)


def _with_a_pair_on_the_circle(pencil: MuPencil, level: float) -> list[float]:
    """Return every real mu with a conjugate pair of roots z on the circle: there pi and its conjugate share a root mu.

    With pi = c_0 + c_1 mu that is Im(c_0 conj(c_1)) = 0.
    """

    def eliminated(cosine: FloatArray) -> FloatArray:
        c = _coefficients_on_the_circle(pencil, level, cosine)
        return np.asarray((c[0] * c[1].conj()).imag / np.sqrt(1 - cosine**2))[np.newaxis]

    cosine = _cosine_zeros(eliminated, pencil.steps - 1, 1)[0]
    found: list[float] = []
    for in_mu in _coefficients_on_the_circle(pencil, level, cosine[np.isfinite(cosine)]).T:
        mu = np.roots(np.trim_zeros(in_mu, "b")[::-1])
        found += mu[np.abs(mu.imag) <= SHARED * np.abs(mu)].real.tolist()
    return found


def _coefficients_on_the_circle(pencil: MuPencil, level: float, cosine: FloatArray) -> ComplexArray:
    """Return the coefficients in mu of pi at z = level e^(i theta), theta in [0, pi]; shape (powers, *cosine.shape)."""
    z = level * (cosine + 1j * np.sqrt(np.maximum(0, 1 - cosine**2)))
    return np.asarray(polyval(z, pencil.table))


def island_radii(pencil: MuPencil, level: float) -> FloatArray:
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


def turning_radii(pencil: MuPencil, level: float) -> FloatArray:
    """Return |mu| where the locus turns towards or away from zero, for a multistep method; else nothing.

    There d log|mu| / d theta = -Im(z (rho'/rho - sigma'/sigma)) = 0, times |rho sigma|^2 / sin(theta) a polynomial in
    cos(theta).  A slice length has a square root there, and a part of S_r too thin to be met begins or ends there.
    """
    table = pencil.table
    if pencil.steps == 1:
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


def paired_crossings(pencil: MuPencil, level: float, radius: FloatArray) -> FloatArray:
    """Return Re mu of every conjugate pair with |mu| = radius and a root z on |z| = level; shape (radii, candidates).

    radius: shape (radii,), > 0. Rows are padded with nan.
    """
    if pencil.steps == 1:
        return _one_step_crossings(pencil, level, radius)
    return _multistep_crossings(pencil, level, radius)


def _one_step_crossings(pencil: MuPencil, level: float, radius: FloatArray) -> FloatArray:
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


def _multistep_crossings(pencil: MuPencil, level: float, radius: FloatArray) -> FloatArray:
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
class Slices:
    """Stable intervals of p = -(mu_1 + mu_2) on lines of constant q: ends of shape (lines, candidates), nan padded."""

    ends: FloatArray
    stable: BoolArray  # shape (lines, candidates - 1): whether between two neighbouring ends

    def lengths(self) -> FloatArray:
        """Return the stable length of each line; shape (lines,)."""
        return np.asarray(np.where(self.stable, np.diff(self.ends, axis=1), 0).sum(axis=1))


def slices(pencil: MuPencil, level: float, q: FloatArray, events: FloatArray, bound: float) -> Slices:
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
