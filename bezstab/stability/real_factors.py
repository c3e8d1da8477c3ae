"""The largest root of many real polynomials of degree four or more, by a quadratic factor followed among neighbours.

    block of points   c . . . . . . .     neighbours, their middle c first (neighbourhoods)
    at c              z^2 + p z + q has the largest root and its conjugate, or it and the nearest other real root, which
                      it may meet: p and q go on smoothly where the two become a pair
    elsewhere         Bairstow's method, Newton's for p and q, takes the factor from c to the others, starting on the
                      planes p and q over alpha_hat and beta_hat that touch c; a last step with the slopes of the one
                      before it finds them settled, and leaves what is left beside the factor

That no other root is larger is not taken on trust: what is left, divided by the factor, has all its roots within the
larger of the factor's, which Schur's recursion tells in few operations. From one middle in STRIDE, where all roots are
solved for, the others get their factors the same way.

Where the largest root is not found so, the largest real root at c is followed alone, by Newton's method: it may have no
other real one beside it, and far out a polynomial is so much steeper than at the other root of the factor that
Bairstow's method, which moves both at once, is led astray. For what that leaves, near kinks, all roots are solved for.
"""

from collections.abc import Callable, Sequence

import numpy as np

from bezstab.stability.arrays import SAME, BoolArray, ComplexArray, FloatArray
from bezstab.stability.low_degrees import largest_quadratic_root
from bezstab.stability.root_finding import CHUNK, MORE_STEPS, STEPS, STRIDE, inside_circle, roots_of_rows

STILL = 1e-11  # relative: a last change of p and q so small leaves but rounding, and what is left is far within SAME

Coefficients = Callable[[FloatArray, FloatArray], list[FloatArray]]
"""Of real polynomials in z, ascending, from alpha_hat and beta_hat; each of their shape."""

Rows = Sequence[FloatArray]
"""The same of a row of points."""


def largest_of_blocks(coefficients_at: Coefficients, alpha_hat: FloatArray, beta_hat: FloatArray) -> ComplexArray:
    """Return the root of largest modulus, Im >= 0, in blocks of neighbours, their middle first; (blocks, points).

    Not finite where it is infinite.
    """
    found = np.empty(alpha_hat.shape, complex)
    p, q = _factors_of_middles(_rows(coefficients_at, alpha_hat[:, 0], beta_hat[:, 0]))
    planes = _touching_planes(coefficients_at, alpha_hat, beta_hat, p, q)
    blocks_at_a_time = max(1, CHUNK // alpha_hat.shape[1])
    for start in range(0, len(found), blocks_at_a_time):
        some = slice(start, start + blocks_at_a_time)
        found[some] = _followed(coefficients_at, alpha_hat[some], beta_hat[some], planes[..., some, np.newaxis])
    blocks, places = np.nonzero(np.isnan(found))
    if blocks.size:
        kinked, of_kinked = np.unique(blocks, return_inverse=True)
        leads = _real_leads(_roots(_rows(coefficients_at, alpha_hat[kinked, 0], beta_hat[kinked, 0])))
        rows = _rows(coefficients_at, alpha_hat[blocks, places], beta_hat[blocks, places])
        z = _followed_alone(rows, leads[of_kinked])
        left = np.flatnonzero(np.isnan(z))
        z[left] = largest_in_upper_half(_roots([row[left] for row in rows]))
        found[blocks, places] = z
    return found


def largest_in_upper_half(z: ComplexArray) -> ComplexArray:
    """Return of roots of real polynomials, shape (roots, points), the largest of each point, or its conjugate."""
    largest: ComplexArray = np.take_along_axis(z, np.argmax(np.abs(z), axis=0)[np.newaxis], axis=0)[0]
    largest.imag = np.abs(largest.imag)
    return largest


def _rows(coefficients_at: Coefficients, alpha_hat: FloatArray, beta_hat: FloatArray) -> Rows:
    """Return the coefficients in rows."""
    return [coefficient.ravel() for coefficient in coefficients_at(alpha_hat, beta_hat)]


def _roots(rows: Rows) -> ComplexArray:
    """Return all roots, neighbours alike; shape (roots, points)."""
    return roots_of_rows(np.stack(rows).astype(complex))


def _factors_of_middles(rows: Rows) -> tuple[FloatArray, FloatArray]:
    """Return p and q of the factors with the largest root, of blocks' middles."""
    solved = _first_factors(_roots([row[::STRIDE] for row in rows]))
    starts = (np.repeat(each, STRIDE)[: rows[0].size] for each in solved)
    p, q, z = _followed_factors(rows, *starts)
    left = np.flatnonzero(np.isnan(z))
    p[left], q[left] = _first_factors(_roots([row[left] for row in rows]))
    return p, q


def _first_factors(z: ComplexArray) -> tuple[FloatArray, FloatArray]:
    """Return p and q of the factors with the largest of all roots z, shape (roots, points).

    nan where it is real and has no other real one beside it.
    """
    lead = np.argmax(np.abs(z), axis=0)[np.newaxis]
    largest = np.take_along_axis(z, lead, axis=0)
    real = np.abs(z.imag) <= SAME * np.abs(z)
    lead_is_real = np.take_along_axis(real, lead, axis=0)
    partner = np.where(lead_is_real, largest, largest.conj())
    distance = np.where(lead_is_real & ~real, np.inf, np.abs(z - partner))
    np.put_along_axis(distance, lead, np.inf, axis=0)
    beside = np.argmin(distance, axis=0)[np.newaxis]
    other = np.where(np.isinf(distance.min(axis=0)), np.nan, np.take_along_axis(z, beside, axis=0))
    return -(largest + other).real[0], (largest * other).real[0]


def _touching_planes(
    coefficients_at: Coefficients, alpha_hat: FloatArray, beta_hat: FloatArray, p: FloatArray, q: FloatArray
) -> FloatArray:
    """Return the planes over alpha_hat and beta_hat that touch p and q at blocks' middles: by what is beside these.

    Constant, slopes in alpha_hat and in beta_hat: shape (2, 3, blocks). A plane of unknown slope is level.
    """
    middles = np.stack([alpha_hat[:, 0], beta_hat[:, 0]])
    planes = np.zeros((2, 3, p.size))
    for k, each in enumerate((alpha_hat, beta_hat)):
        reach = each[:, -1] - each[:, 0]
        beside = middles.copy()
        beside[k] += reach
        changed = _changed(_rows(coefficients_at, *beside), p, q, MORE_STEPS)
        slopes = (np.stack(changed) - [p, q]) / reach
        planes[:, 1 + k] = np.where(np.isfinite(slopes), slopes, 0)
    planes[:, 0] = [p, q] - planes[:, 1] * middles[0] - planes[:, 2] * middles[1]
    return planes


def _followed(
    coefficients_at: Coefficients, alpha_hat: FloatArray, beta_hat: FloatArray, planes: FloatArray
) -> ComplexArray:
    """Return the larger root of the factor that is reached from the planes; nan where it is not proven the largest.

    The planes, shape (2, 3, ...), broadcast to the points.
    """
    p, q = ((constant + by_a * alpha_hat + by_b * beta_hat).ravel() for constant, by_a, by_b in planes)
    *_, z = _followed_factors(_rows(coefficients_at, alpha_hat, beta_hat), p, q)
    return z.reshape(alpha_hat.shape)


def _real_leads(z: ComplexArray) -> FloatArray:
    """Return the largest of the real ones of all roots z, shape (roots, points), of each point; nan if none is real."""
    real = np.where(np.abs(z.imag) <= SAME * np.abs(z), z.real, 0)
    largest = np.take_along_axis(real, np.argmax(np.abs(real), axis=0)[np.newaxis], axis=0)[0]
    return np.where(largest != 0, largest, np.nan)


def _followed_alone(rows: Rows, z: FloatArray) -> ComplexArray:
    """Return the real roots that Newton's method reaches; nan where not settled, or not proven the largest of all."""
    descending = rows[::-1]
    with np.errstate(all="ignore"):  # of what goes astray
        for _ in range(MORE_STEPS):
            *quotient, value = _divided_by_root(descending, z)
            *_, slope = _divided_by_root(quotient, z)
            step = value / slope
            z = z - step
        *quotient, _ = _divided_by_root(descending, z)
        proven = (np.abs(step) <= SAME * np.abs(z)) & inside_circle(quotient[::-1], np.abs(z) * (1 - SAME))
    return np.where(proven, z, np.nan).astype(complex)


def _divided_by_root(descending: Rows, root: FloatArray) -> list[FloatArray]:
    """Return the quotient by z - root, descending, and the remainder, the polynomials' value at the root."""
    quotient = [descending[0]]
    for coefficient in descending[1:]:
        quotient.append(coefficient + root * quotient[-1])
    return quotient


def _followed_factors(rows: Rows, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray, ComplexArray]:
    """Return the factors that Bairstow's method reaches, and of each the larger root z, Im >= 0.

    z is nan where the factor is not settled, or where z is not proven to be the largest of all roots.
    """
    p, q, rest, settled = _settled(rows, p, q, STEPS)
    z = _larger_if_largest(p, q, rest, settled)
    late = np.flatnonzero(~settled)
    if late.size:
        p[late], q[late], rest, settled = _settled([row[late] for row in rows], p[late], q[late], MORE_STEPS)
        z[late] = _larger_if_largest(p[late], q[late], rest, settled)
    return p, q, z


def _larger_if_largest(p: FloatArray, q: FloatArray, rest: Rows, settled: BoolArray) -> ComplexArray:
    """Return the larger root z of settled factors, Im >= 0; nan where the rest, descending, has a larger one."""
    half = 0.5 * p
    z = largest_quadratic_root(half, half * half - q)
    size = np.sqrt(np.maximum(q, z.real * z.real))  # q of a pair, and z^2 of two real ones, is the larger
    z[~(settled & inside_circle(rest[::-1], size * (1 - SAME)))] = np.nan
    return z


def _settled(rows: Rows, p: FloatArray, q: FloatArray, steps: int) -> tuple[FloatArray, FloatArray, Rows, BoolArray]:
    """Return p and q after some steps and one more with the slopes of the last, the rest, and where all are settled.

    The rest is the quotient before that one more, descending.
    """
    p, q = _changed(rows, p, q, steps - 1)
    b = _divided(rows, p, q)
    slopes = _slopes(b, p, q)
    dp, dq = _corrections(b, slopes)
    p, q = p + dp, q + dq
    *rest, b_1, b_0 = _divided(rows, p, q)
    dp, dq = _corrections([b_1, b_0], slopes)
    p, q = p + dp, q + dq
    square = p * p + np.abs(q)  # of about the size of the roots
    settled: BoolArray = (dp * dp <= STILL**2 * square) & (np.abs(dq) <= STILL * square)
    return p, q, rest, settled


def _changed(rows: Rows, p: FloatArray, q: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
    """Return p and q after some steps of Bairstow's method: Newton's for z^2 + p z + q to divide the polynomials."""
    for _ in range(steps):
        b = _divided(rows, p, q)
        dp, dq = _corrections(b, _slopes(b, p, q))
        p, q = p + dp, q + dq
    return p, q


def _slopes(divided: Rows, p: FloatArray, q: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return d_1, d_2 and d_3 by their determinant, which make corrections of a remainder.

    Division leaves b_1 (z + p) + b_0, and that of the quotient d_1, d_2, d_3 the same way. Both b vanish where
    d_2 dp + d_3 dq = b_1, d_1 dp + d_2 dq = b_0 (J. Stoer and R. Bulirsch, Introduction to Numerical Analysis, 5.8).
    """
    *_, d_3, d_2, d_1 = _divided(divided[-2::-1], p, q)
    scale = 1 / (d_2 * d_2 - d_1 * d_3)
    return d_1 * scale, d_2 * scale, d_3 * scale


def _corrections(divided: Rows, slopes: tuple[FloatArray, FloatArray, FloatArray]) -> tuple[FloatArray, FloatArray]:
    """Return the corrections of p and q that a remainder and slopes ask for."""
    *_, b_1, b_0 = divided
    by_1, by_2, by_3 = slopes
    return b_1 * by_2 - b_0 * by_3, b_0 * by_2 - b_1 * by_1


def _divided(ascending: Rows, p: FloatArray, q: FloatArray) -> list[FloatArray]:
    """Return the quotient by z^2 + p z + q, descending, and the remainder b_1 (z + p) + b_0."""
    before, last = ascending[-1], ascending[-2] - p * ascending[-1]
    quotient = [before, last]
    for coefficient in ascending[-3::-1]:
        subtracted = p * last
        subtracted += q * before
        before, last = last, np.subtract(coefficient, subtracted, out=subtracted)
        quotient.append(last)
    return quotient
