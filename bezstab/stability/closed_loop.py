"""Closed-loop poles over any broadcastable alpha_hat and beta_hat, and the proven verdict at one exact point.

The poles are the roots of pi(z, mu) at the two roots mu of the feedback. Compared with eigenvalues of P's companion
that halves the degree, needs one solve where the mu are conjugate, and keeps all digits on beta_hat = alpha_hat^2/4,
where the roots of P pair up.
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import cache

import numpy as np
from numpy.polynomial.polynomial import polyder, polyroots, polyval2d
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import NumericalError
from bezstab.methods import (
    Method,
    Verdict,
    branch_polynomial,
    closed_loop_at,
    coefficient_table,
    feedback_matrix,
    recursion_verdict,
)

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

CHUNK = 16384  # points at a time: all the work arrays of one chunk stay in a core's cache
BLOCK = 8 * CHUNK  # points whose roots are followed in one go: enough to outweigh the calls for one in STRIDE
STRIDE = 16  # of a row of points one in so many has all its roots solved for, the others start from them
ITERATIONS = 200  # Aberth's iteration needs about ten; a multiple root, where it is linear, about sixty
HUGE = 1e280  # beyond, exact products would overflow on the way to a result that fits
FAR = 1e15  # |z| whose 16th power still fits float64
NEAR = 0.2  # relative distance of x within which the roots of a neighbour are better starts than the polygon's
EPS = float(np.finfo(float).eps)
NUDGE = 1e-3  # about a step of a map's grid, so it costs no iteration
CONVERGED = 1e-9  # relative correction after which a quadratically convergent iterate is exact to rounding
FOLLOWED = 4  # Newton steps: from a start that is off by the square of a map's spacing two suffice


def verdict(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> Verdict:
    """Return 'converges', 'marginal' or 'diverges', proven by the Schur-Cohn test on P in exact arithmetic."""
    return recursion_verdict(closed_loop_at(method, alpha_hat, beta_hat))


def poles(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return all closed-loop poles; complex, shape of alpha_hat and beta_hat broadcast plus (2 n,), dimensionless.

    Descending by modulus. Roots of paper Eq. 17. NumericalError if a root leaves the range of float64.
    """
    alpha_hat, beta_hat = np.broadcast_arrays(np.asarray(alpha_hat, float), np.asarray(beta_hat, float))
    mu = np.stack(_mu(method, alpha_hat.ravel(), beta_hat.ravel()))
    z = roots_in_z(method, mu.ravel()).reshape(-1, *mu.shape)
    z = np.moveaxis(z, -1, 0).reshape(*alpha_hat.shape, -1)
    order = np.lexsort((-z.imag, -np.abs(z)), axis=-1)
    return _tidy(np.take_along_axis(z, order, axis=-1))


def dominant_pole(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> ComplexArray:
    """Return the pole z_p of largest modulus; complex, Im >= 0, shape of alpha_hat and beta_hat broadcast.

    Of poles equal in modulus to rounding, one is taken. NumericalError if a root leaves the range of float64.
    """
    alpha_hat, beta_hat = np.broadcast_arrays(np.asarray(alpha_hat, float), np.asarray(beta_hat, float))
    dominant = np.empty(alpha_hat.size, complex)
    for start in range(0, alpha_hat.size, BLOCK):
        part = dominant[start : start + BLOCK]
        second = np.empty_like(part)
        for i in range(0, part.size, CHUNK):
            here, there = slice(i, i + CHUNK), slice(start + i, start + min(i + CHUNK, part.size))
            part[here], second[here] = _mu(method, alpha_hat.flat[there], beta_hat.flat[there])
        real = np.flatnonzero(part.imag == 0)
        part[:] = dominant_root(method, part)
        if real.size:
            other = dominant_root(method, second[real])
            larger = np.abs(other) > np.abs(part[real])
            part[real[larger]] = other[larger]
        part.imag = np.abs(part.imag)
        _tidy(part)
    return dominant.reshape(alpha_hat.shape)


def _tidy(z: ComplexArray) -> ComplexArray:
    """Return z with the imaginary parts that are its rounding taken off."""
    z.imag[np.abs(z.imag) < EPS * np.abs(z.real)] = 0
    return z


def spectral_radius(method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike) -> FloatArray:
    """Return |z_p|; shape of alpha_hat and beta_hat broadcast, dimensionless; below one the constraint error decays."""
    return np.abs(dominant_pole(method, alpha_hat, beta_hat))


def dominant_root(method: Method, mu: ComplexArray) -> ComplexArray:
    """Return the root of pi(., mu) of largest modulus for each of a row of mu.

    Where neighbours in the row are close, as on a map, the dominant root of one is followed to the others by Newton's
    method, unless another root could overtake it on the way. That a root z(mu) stays within |z'| r / (1 - r/R)^2 of
    where it is, up to r below the distance R of the next branch point, is Koebe's distortion theorem, as mu is a
    function of z (for PECE, where it is one of two, an estimate). NumericalError as for roots_in_z.
    """
    if len(table := float_table(method)) == 2 or mu.size < STRIDE**2:
        return _largest(roots_in_z(method, mu))
    blocks = mu[: mu.size - mu.size % STRIDE].reshape(-1, STRIDE)
    found = np.full(mu.size, np.nan, complex)
    followed = found[: blocks.size].reshape(blocks.shape)
    centre = blocks[:, STRIDE // 2]
    z = roots_in_z(method, centre)
    same = np.broadcast_to(centre, z.shape)
    with np.errstate(all="ignore"):  # what is not finite is not followed
        by_z, by_mu = (polyval2d(z, same, polyder(table, axis=axis)) for axis in (0, 1))
        slope, modulus = -by_mu / by_z, np.abs(z)
        lead = np.argmax(modulus, axis=0)[np.newaxis]
        first, drift = (np.take_along_axis(x, lead, axis=0)[0] for x in (z, slope))
        spread = np.abs(blocks - centre[:, np.newaxis]).max(axis=1)
        share = spread / np.abs(centre[:, np.newaxis] - branch_points(method)).min(axis=1, initial=np.inf)
        moved = np.abs(slope) * np.where(share < 1, spread / (1 - share) ** 2, np.inf)
        bound = modulus + moved
        twin = np.abs(z - first.conj()) < CONVERGED * np.abs(first)  # as large throughout, where it stays a twin
        twin &= (blocks.imag == 0).all(axis=1) & (np.abs(z.imag) > moved)
        np.put_along_axis(bound, lead, 0, axis=0)
        bound = np.where(twin, 0, bound).max(axis=0)
        alone = np.flatnonzero(bound < np.abs(first))
        for i in range(0, alone.size, CHUNK // STRIDE):
            chosen = alone[i : i + CHUNK // STRIDE]
            near, least = blocks[chosen], bound[chosen, np.newaxis]
            start = first[chosen, np.newaxis] + drift[chosen, np.newaxis] * (near - centre[chosen, np.newaxis])
            followed[chosen] = _followed(table, near, start, least)
    rest = np.flatnonzero(np.isnan(found))
    found[rest] = _largest(roots_in_z(method, mu[rest]))
    return found


def _largest(z: ComplexArray) -> ComplexArray:
    """Return the entry of largest modulus along the first axis."""
    largest: ComplexArray = np.take_along_axis(z, np.argmax(np.abs(z), axis=0)[np.newaxis], axis=0)[0]
    return largest


def _followed(table: FloatArray, mu: ComplexArray, z: ComplexArray, bound: FloatArray) -> ComplexArray:
    """Return the roots that Newton's method reaches from z; nan where it has not settled, or not above the bound."""
    a = [_horner(row, mu) if row[1:].any() else row[0] for row in table]
    for _ in range(FOLLOWED):
        value, slope = a[-1] * z + a[-2], a[-1]
        for c in a[-3::-1]:
            slope = slope * z + value
            value = value * z + c
        step = value / slope
        z = z - step
        settled = np.abs(step) <= CONVERGED * np.abs(z)
        if settled.all():
            break
    return np.where(settled & (np.abs(z) > bound), z, np.nan)


def roots_in_z(method: Method, mu: ComplexArray) -> ComplexArray:
    """Return all z with pi(z, mu) = 0; complex, shape (n, mu.size) for a row of mu.

    NumericalError if one leaves the range of float64.
    """
    z = _roots(float_table(method), mu)
    if not np.isfinite(z).all():
        worst = mu[~np.isfinite(z).all(axis=0)][0]
        raise NumericalError(f"{method.name}: at mu = {worst:.6g} a pole leaves the range of float64")
    return z


def roots_in_mu(method: Method, z: ComplexArray) -> ComplexArray:
    """Return all mu with pi(z, mu) = 0, the locus of a root at z; shape (degree of pi in mu, z.size) for a row of z.

    Not finite where one of them is at infinity.
    """
    return _roots(float_table(method).T, z)


@cache
def float_table(method: Method) -> FloatArray:
    """Return C with pi(z, mu) = sum_kj C[k, j] z^k mu^j; NumericalError if that leaves the range of float64."""
    return _floats(method, coefficient_table(method))


def _floats(method: Method, exact: Sequence[Fraction | Sequence[Fraction]]) -> FloatArray:
    """Return exact coefficients as float64: the one place where they become so."""
    try:
        return np.array(exact, float)
    except OverflowError:
        raise NumericalError(f"{method.name}: products of its coefficients leave the range of float64") from None


@cache
def branch_points(method: Method) -> ComplexArray:
    """Return every mu at which two roots z of pi(., mu) meet; beyond the nearest a root's power series diverges."""
    z = polyroots(np.trim_zeros(_floats(method, branch_polynomial(method)), "b")).astype(complex)
    table = float_table(method)
    mu = roots_in_mu(method, z)
    slope = np.abs(polyval2d(np.broadcast_to(z, mu.shape), mu, polyder(table)))
    met: ComplexArray = np.take_along_axis(mu, np.argmin(slope, axis=0)[np.newaxis], axis=0)[0]
    return met[np.isfinite(met)]


def _roots(table: FloatArray, x: ComplexArray) -> ComplexArray:
    """Return the roots y of sum_kj table[k, j] y^k x^j for each x, by chunks that fit a core's cache."""
    with np.errstate(all="ignore"):  # whatever is not finite is for the caller to judge
        blocks = [_polynomial_roots(table, x[i : i + CHUNK]) for i in range(0, x.size, CHUNK)]
    return np.concatenate(blocks, axis=1) if blocks else np.empty((len(table) - 1, 0), complex)


def _horner(ascending: FloatArray, x: ComplexArray) -> ComplexArray:
    total = np.full_like(x, ascending[-1])
    for c in ascending[-2::-1]:
        total *= x
        total += c
    return total


def _polynomial_roots(table: FloatArray, x: ComplexArray) -> ComplexArray:
    """Return the roots as _roots does, the polynomials scaled by x^-d where |x| > 1."""
    if len(table) == 2 and table[1, 0] == 1 and not table[1, 1:].any():  # y = R(x)
        return -_horner(table[0], x)[np.newaxis]
    large = np.abs(x) > 1
    small, inverse = np.where(large, 0, x), np.divide(1, x, out=np.zeros_like(x), where=large)
    a = np.stack([np.where(large, _horner(row[::-1], inverse), _horner(row, small)) for row in table])
    if len(table) == 2:
        single: ComplexArray = -a[:1] / a[1]
        return single
    coarse = _aberth(a[:, ::STRIDE], _newton_polygon_starts(a[:, ::STRIDE]))
    # Nudged apart: coinciding starts would never part, and real ones never leave the axis of a real polynomial.
    coarse += NUDGE * np.abs(coarse) * _spread(len(coarse))
    starts = np.repeat(coarse, STRIDE, axis=1)[:, : x.size]
    solved = np.repeat(x[::STRIDE], STRIDE)[: x.size]
    alone = (np.abs(x - solved) >= NEAR * np.abs(x)) | (a[0] == 0)  # an exact zero starts, and stays, at 0
    starts[:, alone] = _newton_polygon_starts(a[:, alone])
    return _aberth(a, starts)


def _spread(n: int) -> ComplexArray:
    """Return n directions around the circle, none the conjugate of another; shape (n, 1)."""
    directions: ComplexArray = np.exp(1j * (2 * np.pi * np.arange(n) / n + 0.7))[:, np.newaxis]
    return directions


def _newton_polygon_starts(a: ComplexArray) -> ComplexArray:
    """Return starting points on circles whose radii are the slopes of the upper hull of (k, log|a_k|).

    Shape (n, points). D. A. Bini, Numer. Algorithms 13, 1996: so every root, however small, has a start of its size.
    """
    n = len(a) - 1
    size = np.maximum(np.log(np.abs(a)), -1e300)  # a finite stand-in for log 0
    radii = np.empty((n, a.shape[1]))
    for i in range(n):  # minus the hull's slope between i and i + 1, by its max-min characterisation
        below = [
            np.min([(size[lower] - size[upper]) / (upper - lower) for upper in range(i + 1, n + 1)], axis=0)
            for lower in range(i + 1)
        ]
        radii[i] = np.exp(np.max(below, axis=0))
    return radii * _spread(n)


def _aberth(a: ComplexArray, z: ComplexArray) -> ComplexArray:
    """Return the roots of sum_k a[k] z^k, a of shape (n + 1, points), from starts z of shape (n, points).

    Aberth's simultaneous Newton iteration (O. Aberth, Math. Comp. 27, 1973), cubic at simple roots; points leave as
    they converge. At a multiple root the last digits cannot settle: there ITERATIONS ends the walk.
    """
    solution, active = z.copy(), np.arange(z.shape[1])
    step_of = _far_aberth_step if np.abs(z).max(initial=0.0) > FAR else _aberth_step
    for _ in range(ITERATIONS):
        step = step_of(a, z)
        settled = np.all(np.abs(step) <= CONVERGED * np.abs(z), axis=0)
        z = z - step
        solution[:, active[settled]] = z[:, settled]
        if settled.all():
            return solution
        if settled.any():
            keep = ~settled
            a, z, active = a[:, keep], z[:, keep], active[keep]
    solution[:, active] = z
    return solution


def _aberth_step(a: ComplexArray, z: ComplexArray) -> ComplexArray:
    value, slope = np.broadcast_to(a[-1], z.shape).copy(), np.zeros_like(z)
    for c in a[-2::-1]:
        slope *= z
        slope += value
        value *= z
        value += c
    # Newton's correction N = p/p' repelled by the other roots: N / (1 - N sum 1/(z_i - z_j))
    return _quotient(value, slope - value * _repulsion(z))


def _far_aberth_step(a: ComplexArray, z: ComplexArray) -> ComplexArray:
    """Return the same step where powers of z may overflow: for |z| > 1 by q with p(z) = z^n q(1/z), relative to z."""
    n, far = len(z), np.abs(z) > 1
    w = np.divide(1, z, out=z.copy(), where=far)
    value, slope = np.zeros_like(z), np.zeros_like(z)
    for c, reverse in zip(a[::-1], a, strict=True):
        slope = slope * w + value
        value = value * w + np.where(far, reverse, c)
    repulsion = _repulsion(z)
    near_step = _quotient(value, slope - value * repulsion)
    return np.where(far, z * _quotient(value, n * value - w * slope - value * (z * repulsion)), near_step)


def _quotient(x: ComplexArray, y: ComplexArray) -> ComplexArray:
    """Return x / y, and 0 where x is 0."""
    quotient: ComplexArray = np.divide(x, y, out=np.zeros_like(x), where=x != 0)
    return quotient


def _repulsion(z: ComplexArray) -> ComplexArray:
    """Return the sums of 1 / (z_i - z_j) over the other roots j, coinciding ones left out."""
    repulsion = np.zeros_like(z)
    for i in range(len(z)):
        for j in range(i):
            difference = z[i] - z[j]
            reciprocal = np.divide(1, difference, out=np.zeros_like(difference), where=difference != 0)
            repulsion[i] += reciprocal
            repulsion[j] -= reciprocal
    return repulsion


def _mu(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Return both roots mu of the feedback mu^2 + p mu + q: a conjugate pair, upper first, or two real numbers.

    The discriminant is exact until rounded: in plain float64 it would cost half the digits on alpha_hat^2 = 4 beta_hat.
    """
    (a, b), (c, d) = feedback_matrix(method)
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        shift = 64 if max(np.abs(alpha_hat).max(), np.abs(beta_hat).max()) > HUGE else 0
        if shift:
            alpha_hat, beta_hat = np.ldexp(alpha_hat, -shift), np.ldexp(beta_hat, -shift)
        (p, p_low), (q, q_low) = _combination(a, alpha_hat, b, beta_hat), _combination(c, alpha_hat, d, beta_hat)
        exponent = np.maximum(np.frexp(p)[1] + shift, (np.frexp(q)[1] + (shift + 1)) // 2)  # no square leaves the range
        half, half_low = np.ldexp(p, shift - exponent - 1), np.ldexp(p_low, shift - exponent - 1)
        single = np.ldexp(q, shift - exponent)  # where q scaled twice underflows, the nearer mu need not
        q, q_low = np.ldexp(q, shift - 2 * exponent), np.ldexp(q_low, shift - 2 * exponent)
        square, square_low = _two_product(half, half)
        high, low = _two_sum(square, -q)
        discriminant = high + (low + (square_low + 2 * half * half_low - q_low))
        root, real = np.sqrt(np.abs(discriminant)), discriminant >= 0
        far = -(half + np.copysign(root, half))
        near = np.divide(single, far, out=np.zeros_like(far), where=far != 0)
        first, second = np.empty_like(p, complex), np.empty_like(p, complex)
        pair = np.ldexp(-half, exponent)
        first.real, second.real = np.where(real, np.ldexp(far, exponent), pair), np.where(real, near, pair)
        first.imag = np.where(real, 0, np.ldexp(root, exponent))
        second.imag = -first.imag
    return first, second


def _combination(a: Fraction, x: FloatArray, b: Fraction, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return a x + b y as an unevaluated sum of two float64."""
    (ax, ax_low), (by, by_low) = _two_product(float(a), x), _two_product(float(b), y)
    total, total_low = _two_sum(ax, by)
    rounded = float(a - Fraction(float(a))) * x + float(b - Fraction(float(b))) * y
    return total, total_low + (ax_low + by_low + rounded)


def _two_sum(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return x + y rounded, and its rounding error, exactly (D. E. Knuth, TAOCP 2, Theorem 4.2.2B)."""
    total = x + y
    virtual = total - x
    return total, (x - (total - virtual)) + (y - virtual)


def _two_product(x: FloatArray | float, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return x y rounded, and its rounding error, exactly (T. J. Dekker, Numer. Math. 18, 1971)."""
    product = x * y
    (x_high, x_low), (y_high, y_low) = _halves(x), _halves(y)
    return product, x_low * y_low - (((product - x_high * y_high) - x_low * y_high) - x_high * y_low)


def _halves(x: FloatArray | float) -> tuple[FloatArray | float, FloatArray | float]:
    """Return two numbers of at most 26 bits with sum x."""
    shifted = 134217729.0 * x  # 2^27 + 1
    high = shifted - (shifted - x)
    return high, x - high
