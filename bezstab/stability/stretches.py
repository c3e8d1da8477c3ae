r"""What is stable along a path through the plane: all its stable stretches, from eigenvalues of a few small matrices.

A path is the points (s^i alpha_hat, s^j beta_hat), s > 0. Lines of constant alpha_hat or beta_hat are paths; so are all
steps h at one alpha and beta, and all alpha, or all beta, alone:

      beta_hat |   |          .--x             (i, j) = (0, 1): a line of constant alpha_hat     (1, 0): of beta_hat
               |   |  edge .-'  /  .                    (1, 2): all steps h at one alpha and beta
               |   x     .'    / .'
               |   |    '  ---o-x------        o: s = 1     x: places where a root may pass |z| = level
               +----------------------- alpha_hat

With z = level (1 + w) / (1 - w) the disc |z| < level is the half-plane Re w < 0, and P becomes a polynomial in w, with
coefficients a_k that are polynomials in s. Near weak feedback, where poles crowd at z = 1, they keep all their digits,
which those in z lose. A root passes the circle only where one of three expressions vanishes, and their zeros are the
path's *places*:

    a_0, that is P(level)     a_n, that is P(-level)     two polynomials in s: their roots
    det H(s),  H_ij = a_(n - 1 - 2 j + i)  (0 <= i, j < n - 1)       a matrix of polynomials: a companion's eigenvalues

The determinant, Hurwitz's, is a_n^(n-1) times the product of all -(w_i + w_j), i < j: it vanishes with a pair +-i omega
(L. Orlando, Math. Ann. 71, 1911; F. R. Gantmacher, The Theory of Matrices, 1959, chapter XV).

Between two neighbours the verdict is one, and one point tells it (Routh's scheme):

      s  0--------x--------x------x----------x-------->       A place where the verdict stays is no end: the
           stable   stable    not    stable     not           determinant also vanishes where w_i = -w_j are real.
         [== a stretch ===]      [ another ]

Area, extent, margins, limits by damping ratio and the least |z_p| are all read off such stretches.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from itertools import zip_longest
from math import comb, inf

import numpy as np
from numpy.polynomial.polynomial import polymul, polypow, polyval
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import NumericalError
from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.root_finding import roots_of_rows
from bezstab.stability.searches import bisected

Powers = tuple[int, int]
"""(i, j) of a path (s^i alpha_hat, s^j beta_hat)."""

ALONG_BETA: Powers = (0, 1)
"""Of lines of constant alpha_hat, on which s multiplies beta_hat."""
ALONG_ALPHA: Powers = (1, 0)
"""Of lines of constant beta_hat."""
ALONG_H: Powers = (1, 2)
"""Of all steps h at one alpha and beta."""

EXPANDED_AT = -0.03
"""Of a path's size: the determinant is expanded there, as at s = 0 it vanishes, and no place is negative."""

FAR_APART = 1e4
"""Of a path's sizes: eigenvalues for the least then lose the digits of places of the largest, and are asked twice."""

NEARLY_REAL = 1e-2
"""|Im| over |s| of an eigenvalue that is taken for a real place: m that meet part by eps^(1/m). One place too many does
no harm, as verdicts tell what is beside it."""

ZERO = 1e-11
"""Of a path's size: a place so near to s = 0 is rounding of zero."""

END_ACCURACY = 1e-10
"""Of an end: within it the verdict must turn, or the end is bisected."""

SHORT = 4 * END_ACCURACY
"""Of its place: whether there is a stretch, or a gap, so short, rounding decides; none is told."""


@dataclass(frozen=True, eq=False)
class Stretches:
    """The stable stretches of some paths: which path, and from which s to which; `high` may be infinite.

    Three arrays of one shape (stretches,), in the order of the paths and, on each, ascending.
    """

    path: NDArray[np.intp]
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True, eq=False)
class Paths:
    """P along some paths as a polynomial in w, whose coefficients are polynomials in s, without dimension.

    `coefficients` has the shape (powers of w, powers of s, paths), powers ascending.
    """

    coefficients: FloatArray

    def within(self, s: FloatArray) -> BoolArray:
        """Return whether |z_p| < level at places s of each path; shape of s: (paths, places)."""
        with np.errstate(all="ignore"):  # far out nothing finite is left, and nothing is within
            return in_left_half_plane([polyval(s.T, row[:, np.newaxis], tensor=False) for row in self.coefficients]).T

    def places(self) -> FloatArray:
        """Return, ascending, all s > 0 where a root may pass |z| = level; shape (paths, most), filled up with inf."""
        with np.errstate(all="ignore"):
            least, largest = _sizes(self.coefficients)
            sizes = [least, largest] if (largest > FAR_APART * least).any() else [least]
            of_pairs = [self._of_pairs(size) for size in sizes]
            found = np.concatenate([_roots(self.coefficients[0]), _roots(self.coefficients[-1]), *of_pairs]).T
        nearly_zero = ZERO * least[:, np.newaxis]
        real = np.isfinite(found) & (np.abs(found.imag) <= NEARLY_REAL * np.abs(found)) & (found.real > nearly_zero)
        return np.sort(np.where(real, found.real, inf), axis=1)

    def _of_pairs(self, size: FloatArray) -> ComplexArray:
        """Return the zeros s of Hurwitz's determinant, complex, shape (zeros, paths), those of a size best."""
        a = self.coefficients
        n, most = len(a) - 1, a.shape[1]
        centre = EXPANDED_AT * size
        around = [sum(a[:, m] * (comb(m, k) * centre ** (m - k)) for m in range(k, most)) for k in range(most)]
        padded = np.concatenate([np.stack(around, axis=1), np.zeros((1, most, len(centre)))])
        i, j = np.indices((n - 1, n - 1))
        k = n - 1 - 2 * j + i
        hurwitz = padded[np.where((k >= 0) & (k <= n), k, n + 1)]
        return centre + _singular_places(np.moveaxis(hurwitz, (2, 3), (1, 0)))

    def stretches(self, short: float = SHORT) -> Stretches:
        """Return all stable stretches of all paths, but for those that are `short`, a share of their place.

        Their ends are those of eigenvalues, held against verdicts, and bisected where these turn elsewhere.
        """
        places = np.pad(self.places(), ((0, 0), (1, 0)))
        ends = np.pad(places, ((0, 0), (0, 1)), constant_values=inf)
        low, high = ends[:, :-1], ends[:, 1:]
        between = middle_of(low, high)
        stable = self.within(between) & np.isfinite(low)
        turns = np.diff(np.pad(stable, ((0, 0), (1, 1))).astype(int), axis=1)
        path, first = np.nonzero(turns == 1)
        _, beyond = np.nonzero(turns == -1)
        last = between.shape[1] - 1
        lower = self._held(path, ends[path, first], between[path, np.maximum(first - 1, 0)], between[path, first])
        upper = self._held(path, ends[path, beyond], between[path, np.minimum(beyond, last)], between[path, beyond - 1])
        return _joined(path, lower, upper, short)

    def _held(self, path: NDArray[np.intp], end: FloatArray, outside: FloatArray, inside: FloatArray) -> FloatArray:
        """Return ends at which the verdict turns, from those of eigenvalues and a point to either side of each."""
        found = end.copy()
        asked = np.flatnonzero((end > 0) & np.isfinite(end))
        on_path = Paths(self.coefficients[:, :, path[asked]])
        end, outside, inside = end[asked], outside[asked], inside[asked]

        def stable(s: FloatArray) -> BoolArray:
            return on_path.within(s[:, np.newaxis])[:, 0]

        near_out, near_in = (
            end + np.sign(side - end) * np.minimum(END_ACCURACY * end, np.abs(side - end)) for side in (outside, inside)
        )
        right = stable(near_in) & ~stable(near_out)
        if not right.all():
            wrong = np.flatnonzero(~right)
            on_path = Paths(on_path.coefficients[:, :, wrong])
            _, bisected_ends = bisected(stable, outside[wrong], inside[wrong])
            end[wrong] = bisected_ends
        found[asked] = end
        return found


def middle_of(low: ArrayLike, high: ArrayLike) -> FloatArray:
    """Return a point between two ends, of which the upper one may be infinite."""
    low, high = np.asarray(low), np.asarray(high)
    with np.errstate(over="ignore"):  # of levels next to 0 ends are next to float64's largest number
        return np.where(np.isinf(high), 2 * low + 1, (low + high) / 2)


def paths(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, powers: Powers, level: float = 1.0) -> Paths:
    """Return the paths (s^i alpha_hat, s^j beta_hat) of |z_p| < level, (i, j) the powers, at most two.

    alpha_hat and beta_hat are dimensionless, of one shape (paths,). P is that of paper Eq. 17, or of any other method.
    NumericalError if its coefficients leave the range of float64.
    """
    return Paths(np.stack([_in_s(plane, alpha_hat, beta_hat, powers) for plane in table_in_w(method, level)]))


@cache
def float_table(method: Method) -> FloatArray:
    """Return P in float64: entry [k, i, j] belongs to z^k alpha_hat^i beta_hat^j. Errors as `paths`."""
    return rounded(method, np.array(closed_loop_table(method)))


@lru_cache  # the least |z_p| is looked for by hundreds of levels
def table_in_w(method: Method, level: float = 1.0) -> FloatArray:
    """Return P(level (1 + w) / (1 - w)) (1 - w)^n by powers of w, as `float_table`: exact until it is rounded.

    So what vanishes without feedback is zero, however near to z = 1 poles come.
    """
    table = np.array(closed_loop_table(method))
    powers = np.array([exact(level) ** k for k in range(len(table))])  # a Fraction to the power of an array is a float
    return rounded(method, np.tensordot(in_w(len(table) - 1) * powers, table, axes=1))


def rounded(method: Method, table: NDArray[np.object_]) -> FloatArray:
    """Return exact coefficients of a method in float64; NumericalError if one leaves its range."""
    try:
        return table.astype(float)
    except OverflowError:
        raise NumericalError(f"{method.name}: products of its coefficients leave the range of float64") from None


@cache
def in_w(n: int) -> NDArray[np.object_]:
    """Return the matrix that takes c_0 ... c_n of p(z) to the coefficients of p((1 + w) / (1 - w)) (1 - w)^n.

    Column k has (1 + w)^k (1 - w)^(n - k), in whole numbers. Shape (n + 1, n + 1).
    """
    above, below = np.array([1, 1], object), np.array([1, -1], object)
    return np.stack([polymul(polypow(above, k), polypow(below, n - k)) for k in range(n + 1)], axis=1)


def in_left_half_plane(ascending: Sequence[FloatArray]) -> BoolArray:
    """Return whether all roots w of polynomials have Re w < 0, by Routh's scheme; shape of each coefficient.

    Two rows of every other coefficient; each next row is what the first leaves when the second is taken off it so often
    that its first entry vanishes. All first entries have one sign if and only if every root is in the half-plane.
    """
    sign = np.sign(ascending[-1])
    row, after = [[sign * a for a in ascending[start::-2]] for start in (-1, -2)]
    inside = np.asarray(sign != 0)
    while after:
        inside = inside & (after[0] > 0)
        share = row[0] / after[0]
        row, after = after, [a - share * b for a, b in zip_longest(row[1:], after[1:], fillvalue=0.0)]
    return inside


def _in_s(plane: FloatArray, alpha_hat: FloatArray, beta_hat: FloatArray, powers: Powers) -> FloatArray:
    """Return sum_ij plane[i, j] alpha_hat^i beta_hat^j s^(..) by powers of s, ascending; shape (powers, paths)."""
    most_alpha, most_beta = plane.shape
    found = np.zeros((powers[0] * (most_alpha - 1) + powers[1] * (most_beta - 1) + 1, len(alpha_hat)))
    with np.errstate(over="ignore"):  # what leaves float64 is infinite, and proven verdicts decide
        for i, j in zip(*np.nonzero(plane), strict=True):
            found[powers[0] * i + powers[1] * j] += plane[i, j] * alpha_hat**i * beta_hat**j
    return found


def _joined(path: NDArray[np.intp], low: FloatArray, high: FloatArray, short: float) -> Stretches:
    """Return stretches without those that are short, and those joined between which the gap is."""
    long = high > low * (1 + short)
    path, low, high = path[long], low[long], high[long]
    apart = (path[1:] != path[:-1]) | (low[1:] > high[:-1] * (1 + short))
    first, last = np.append(True, apart)[: len(path)], np.append(apart, True)[: len(path)]
    return Stretches(path[first], low[first], high[last])


def _sizes(polynomials: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the least and the largest s at which a power of one of some polynomials weighs as much as its constant.

    Polynomials along axis 0, powers of s along axis 1; shape (paths,). One where there is none.
    """
    k = np.arange(1, polynomials.shape[1])[:, np.newaxis]
    sizes = np.abs(polynomials[:, :1] / polynomials[:, 1:]) ** (1 / k)
    sizes = np.where(np.isfinite(sizes) & (sizes > 0), sizes, np.nan)
    sizes = np.where(np.isnan(sizes).all(axis=(0, 1)), 1.0, sizes)
    return np.nanmin(sizes, axis=(0, 1)), np.nanmax(sizes, axis=(0, 1))


def _roots(p: FloatArray) -> ComplexArray:
    """Return the non-zero roots of polynomials, ascending along axis 0; shape (degree, paths)."""
    present = np.flatnonzero(p.any(axis=1))
    if len(present) < 2:
        return np.zeros((0, p.shape[1]), complex)
    return roots_of_rows(p[present[0] : present[-1] + 1])


def _singular_places(m: FloatArray) -> ComplexArray:
    """Return all x where sum_k m[:, k] x^k is singular, complex, from matrices of shape (paths, powers, n, n).

    They are the inverses of the eigenvalues of the block companion matrix

        | -m_0^-1 m_1   -m_0^-1 m_2   ... |
        |      1              0           |       Shape (n (powers - 1), paths), infinite where an eigenvalue is zero.
        |      0              1       0   |
    """
    count, powers, n, _ = m.shape
    size = n * (powers - 1)
    if not size:
        return np.zeros((0, count), complex)
    companion = np.zeros((count, size, size))
    companion[:, range(n, size), range(size - n)] = 1
    regular = np.linalg.slogdet(m[:, 0])[0] != 0
    rows = np.zeros(m[:, 1:].shape)  # of a path along all of which the matrix is singular no place is to be found
    rows[regular] = np.nan_to_num(np.linalg.solve(m[regular, :1], m[regular, 1:]))
    companion[:, :n] = -rows.transpose(0, 2, 1, 3).reshape(count, n, size)
    inverse: ComplexArray = np.linalg.eigvals(companion).T.astype(complex)
    return 1 / inverse
