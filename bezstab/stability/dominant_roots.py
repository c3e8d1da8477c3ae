"""The root of pi(., mu) of largest modulus for many mu, followed from neighbour to neighbour where that is safe.

A map asks for one root of a million polynomials. To solve them all for all their roots takes four times as long as
what is done here:

    block of mu   c . . . . . . . . . . . . . . .     neighbours, their middle c first (neighbourhoods)
    at c          all roots are solved for; the largest leads, the others are rivals
    elsewhere     Newton's method takes the leading root from c to the others

                  |z|   ___________x_________         what Newton finds: must stay above the rivals' bound
                        - - - - - - - - - - -         bound: how far the rivals can come within the block
                               o                      the largest rival at c

What Newton finds is a root, and if its modulus is above what every rival can reach it is no rival: so it is the leading
root, and it is the largest. Where that fails (near kinks and branch points) all roots are solved for again.

How far can a rival come? mu is a function of z, so z(mu) is one-to-one up to the distance R of the next branch point,
and Koebe's distortion theorem says |z(mu) - z(c)| <= |z'(c)| r / (1 - r/R)^2 for |mu - c| = r < R. A mu at which a root
is infinite counts as a branch point: up to there all roots are finite, as the theorem asks. (For PECE, where mu is one
of two functions of z, that is an estimate.)
"""

import numpy as np
from numpy.polynomial.polynomial import polyval, polyval2d
from numpy.typing import NDArray

from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.exact_sums import feedback_discriminant
from bezstab.stability.low_degrees import largest_quadratic_root, polynomial_of_pair
from bezstab.stability.neighbourhoods import FEWEST, blocks_of_neighbours
from bezstab.stability.pencils import Pencil, has_infinite_root, raise_not_finite
from bezstab.stability.root_finding import CHUNK, CONVERGED, followed_roots, roots_of_table

CANCELS = 1e-5  # of (b/2)^2: where a quadratic's discriminant is below it, its root would be good to 1e-13 or less
POINTS = 8192  # followed at a time: their work arrays stay in a core's cache
ORDINARY = 1e70  # of |mu|: its powers are far from the end of float64's range


def dominant_root(pencil: Pencil, mu: ComplexArray) -> ComplexArray:
    """Return the root of pi(., mu) of largest modulus for each of a row of mu; complex, dimensionless.

    Faster where neighbours in the row are close. Infinite where an implicit step has no solution. NumericalError if a
    finite root leaves the range of float64.
    """
    if pencil.steps == 1 or mu.size < FEWEST:
        return _largest_of_all(pencil, mu)
    if pencil.steps == 2:
        return _larger_of_two(pencil, mu)
    places = blocks_of_neighbours(1, mu.size)
    found = np.empty(mu.size, complex)
    found[places] = dominant_root_in_blocks(pencil, mu[places])
    return found


def dominant_root_in_blocks(pencil: Pencil, blocks: ComplexArray) -> ComplexArray:
    """Return the same of blocks of neighbours, their middle first; of their shape, (blocks, mu of a block)."""
    found = np.full(blocks.shape, np.nan, complex)
    _follow(pencil, blocks, found)
    rest = np.isnan(found)
    found[rest] = _largest_of_all(pencil, blocks[rest])
    return found


def largest_of_one_step(pencil: Pencil, alpha_hat: FloatArray, beta_hat: FloatArray, into: ComplexArray) -> None:
    """Write the larger pole, Im >= 0, of an explicit one-step method, z = R(mu), at each of a row of points.

    Of ordinary size: no product overflows.
    """
    stability_function = -pencil.table[0] / pencil.table[1, 0]
    for start in range(0, alpha_hat.size, CHUNK):
        chunk = slice(start, start + CHUNK)
        p, q, discriminant = feedback_discriminant(pencil.feedback, alpha_hat[chunk], beta_hat[chunk])
        middle, factor = polynomial_of_pair(stability_function.tolist(), p, q)
        largest_quadratic_root(-middle, factor * factor * discriminant, into[chunk])


def _larger_of_two(pencil: Pencil, mu: ComplexArray) -> ComplexArray:
    """Return what dominant_root does, of two roots: by a formula, but where that loses digits."""
    found = np.empty(mu.size, complex)
    for start in range(0, mu.size, CHUNK):
        _write_larger(pencil, mu[start : start + CHUNK], found[start : start + CHUNK])
    rest = np.flatnonzero(np.isnan(found))
    found[rest] = _largest_of_all(pencil, mu[rest])
    return found


def _write_larger(pencil: Pencil, mu: ComplexArray, found: ComplexArray) -> None:
    """Write into `found` the larger root of a quadratic at each mu, by formula; nan where the formula loses digits."""
    with np.errstate(all="ignore"):  # what is not finite is for Aberth's iteration
        real = not mu.imag.any()
        last, half, leading = (polyval(mu.real if real else mu, row) for row in pencil.table)
        half = 0.5 * half
        square = half * half
        discriminant = square - last * leading
        if real:
            largest_quadratic_root(half / leading, discriminant / (leading * leading), into=found)
        else:
            root = np.sqrt(discriminant)
            same_side = half.real * root.real + half.imag * root.imag >= 0
            np.negative(root, out=root, where=~same_side)
            np.divide(-half - root, leading, out=found)
        kept = np.abs(discriminant) >= CANCELS * np.abs(square)
        kept &= np.isfinite(found) & (np.abs(mu) < ORDINARY)
    found[~kept] = np.nan


def _largest_of_all(pencil: Pencil, mu: ComplexArray) -> ComplexArray:
    """Return the root of largest modulus at each mu from all roots; infinite where one is."""
    z = roots_of_table(pencil.table, mu)
    largest: ComplexArray = np.take_along_axis(z, np.argmax(np.abs(z), axis=0)[np.newaxis], axis=0)[0]
    bad = np.flatnonzero(~np.isfinite(largest))  # argmax prefers nan
    if bad.size:
        infinite = has_infinite_root(pencil, mu[bad])
        if not infinite.all():
            raise_not_finite(pencil, mu[bad[~infinite]])
        largest[bad] = np.inf
    return largest


def _follow(pencil: Pencil, blocks: ComplexArray, found: ComplexArray) -> None:
    """Write into `found` the leading roots of blocks of mu, where they are safe to follow."""
    centre = blocks[:, 0]
    z = roots_of_table(pencil.table, centre)
    same_mu = np.broadcast_to(centre, z.shape)
    with np.errstate(all="ignore"):  # what is not finite is not followed
        slope = -polyval2d(z, same_mu, pencil.table_by_mu) / polyval2d(z, same_mu, pencil.table_by_z)  # dz/dmu
        lead = np.argmax(np.abs(z), axis=0)[np.newaxis]
        lead_z = np.take_along_axis(z, lead, axis=0)[0]
        lead_slope = np.take_along_axis(slope, lead, axis=0)[0]
        bound = _rivals_bound(pencil, blocks, z, slope, lead)
        safe = np.flatnonzero(bound < np.abs(lead_z))
        blocks_at_a_time = max(1, POINTS // blocks.shape[1])
        for i in range(0, safe.size, blocks_at_a_time):
            chosen = safe[i : i + blocks_at_a_time]
            mu = blocks[chosen]
            starts = lead_z[chosen, np.newaxis] + lead_slope[chosen, np.newaxis] * (mu - mu[:, :1])
            found[chosen] = followed_roots(pencil.table, mu, starts, bound[chosen, np.newaxis])


def _rivals_bound(
    pencil: Pencil, blocks: ComplexArray, z: ComplexArray, slope: ComplexArray, lead: NDArray[np.intp]
) -> FloatArray:
    """Return for each block the modulus that none but the leading root exceeds there; infinite near a branch point.

    `z` and `slope` have the roots at the centres and their dz/dmu, `lead` the leading root's number.
    """
    centre = blocks[:, 0]
    radius = np.abs(blocks - centre[:, np.newaxis]).max(axis=1)
    share = radius / np.abs(centre[:, np.newaxis] - pencil.branch_points).min(axis=1, initial=np.inf)
    moved = np.abs(slope) * np.where(share < 1, radius / (1 - share) ** 2, np.inf)
    bound = np.abs(z) + moved
    np.put_along_axis(bound, lead, 0, axis=0)
    lead_z = np.take_along_axis(z, lead, axis=0)[0]
    bounds: FloatArray = np.where(_twins(blocks, z, lead_z, moved), 0, bound).max(axis=0)
    return bounds


def _twins(blocks: ComplexArray, z: ComplexArray, lead_z: ComplexArray, moved: FloatArray) -> BoolArray:
    """Return which roots are the leading one's conjugate and stay so, so that they are as large but never larger.

    Along a block of real mu roots come in conjugate pairs; they stay a pair as long as they cannot reach the real axis.
    """
    conjugate = np.abs(z - lead_z.conj()) < CONVERGED * np.abs(lead_z)
    real_mu = (blocks.imag == 0).all(axis=1)
    off_the_axis = np.abs(z.imag) > moved
    twins: BoolArray = conjugate & real_mu & off_the_axis
    return twins
