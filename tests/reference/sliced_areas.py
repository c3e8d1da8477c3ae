"""The area of a region by a second route: stable intervals on lines of constant alpha_hat, integrated.

No mu, no locus, no resultant in theta: Schur's recursion and determinant on P's own coefficients.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from bezstab.methods import Method
from bezstab.stability import FloatArray, region, window
from tests.reference.companion_poles import closed_loop_tables, polynomial_at
from tests.reference.proven_verdicts import proven_stable

BoolArray = NDArray[np.bool_]
Verdict = Callable[[Method, float, FloatArray, FloatArray], BoolArray]
EPS = float(np.finfo(float).eps)
MOST_ROUGH = 1_000  # panels that still disagree: then by rounding, which no halving mends
SMOOTH = 1e-9  # of the area: what the halves of a panel may differ by, where ends are proven to CLOSE
HALVINGS = 52  # of a bracket of an interval's end: to rounding
CLOSE = 1e-8  # of a slice's length: so near its ends are proven, a hundredth of what the campaign asks of an area
ROOM = 1.1  # times the extent of a region: around it panels lie closer and zeros are looked for once more
NEAR_ZERO = (1, 1e-2, 1e-4)  # of where the region was found in beta_hat: zeros are good to rounding of their range
FARTHER = (1, 16, 256, 4096)  # times that far from where float64 has an end a proof is tried before the middle is


@dataclass(frozen=True)
class Integral:
    """An integral, and by how much its panels and their halves differed in all."""

    value: float
    error: float


def stable(method: Method, level: float, alpha_hat: FloatArray, beta_hat: FloatArray) -> BoolArray:
    """Return where P's roots are inside |z| < level: every reflection coefficient of Schur's recursion below one."""
    c = polynomial_at(method, alpha_hat, beta_hat, level)
    inside = np.ones(c.shape[1:], bool)
    while len(c) > 1:
        k = np.where(inside, c[-1] / c[0], 0)
        inside &= np.abs(k) < 1
        c = c[:-1] - np.where(inside, k, 0) * c[:0:-1]
    return inside


def schur_determinant(c: FloatArray) -> FloatArray:
    """Return det(X - Y) = +-prod over i < j of (1 - z_i z_j), zero wherever a complex pair is on the unit circle.

    X is upper triangular Toeplitz of c_0 .. c_(n-2), Y lower anti-triangular Hankel of c_n .. c_2 (Jury 1964).
    """
    n = len(c) - 1
    matrix = np.zeros((*c.shape[1:], n - 1, n - 1))
    for i in range(n - 1):
        for j in range(n - 1):
            if j >= i:
                matrix[..., i, j] += c[j - i]
            if i + j >= n - 2:
                matrix[..., i, j] -= c[2 * n - 2 - i - j]
    return np.asarray(np.linalg.det(matrix))


def slice_lengths(method: Method, level: float, alpha_hat: FloatArray, beta_range: tuple[float, float]) -> FloatArray:
    """Return the length of the stable set in beta_hat at each alpha_hat, a sum of intervals, to rounding of the range.

    A zero too many splits an interval in two and changes nothing.
    """
    beta = sorted_with_ends(event_zeros(method, level, alpha_hat, beta_range), beta_range)
    middle = (beta[:, 1:] + beta[:, :-1]) / 2
    is_stable = stable(method, level, np.broadcast_to(alpha_hat[:, None], middle.shape), middle)
    return np.asarray(np.where(is_stable, np.diff(beta), 0.0).sum(axis=1))


def proven_slice_lengths(
    method: Method,
    level: float,
    alpha_hat: FloatArray,
    beta_range: tuple[float, float],
    where_found: tuple[float, float],
) -> FloatArray:
    """Return the same to CLOSE of each length: the ends are where proven verdicts turn, zeros are where to look.

    They are looked for in the whole range, once more where the region was found, which may be far smaller, and nearer
    to the origin, where a large region may be thin.
    """
    low, high = where_found
    ranges = [beta_range, *((low * part, high * part) for part in NEAR_ZERO)]
    zeros = np.hstack([event_zeros(method, level, alpha_hat, each) for each in ranges])
    beta = sorted_with_ends(zeros, beta_range)
    middle = (beta[:, 1:] + beta[:, :-1]) / 2
    is_stable = proven_stable(method, level, np.broadcast_to(alpha_hat[:, None], middle.shape), middle)
    row, interval = np.nonzero(is_stable[:, 1:] != is_stable[:, :-1])
    turns = Turns(method, level, alpha_hat[row], is_stable[row, interval])
    before, after = middle[row, interval], middle[row, interval + 1]
    beta[row, interval + 1] = found = turning_points(turns, before, after)
    close = CLOSE * np.where(is_stable, np.diff(beta), 0.0).sum(axis=1)[row]
    beta[row, interval + 1] = proven_turning_points(turns, before, after, found, close)
    return np.asarray(np.where(is_stable, np.diff(beta), 0.0).sum(axis=1))


def event_zeros(
    method: Method, level: float, fixed: FloatArray, free_range: tuple[float, float], transposed: bool = False
) -> FloatArray:
    """Return where in beta_hat a root may cross the circle, a row for each alpha_hat; the range's end fills the rows.

    `fixed` are the alpha_hat, `free_range` is that of beta_hat; transposed, the contrary. These are the zeros of
    P(level), P(-level) and Schur's determinant, each interpolated without error by its degree.
    """
    tables = closed_loop_tables(method)
    n, low, high = len(tables) - 1, *free_range
    size = (max(tables.shape[1:]) - 1) * (n - 1) + 1
    nodes = chebyshev.chebpts1(size)
    fixed_nodes, free_nodes = np.broadcast_arrays(fixed[:, None], (low + high + (high - low) * nodes) / 2)
    points = (free_nodes, fixed_nodes) if transposed else (fixed_nodes, free_nodes)
    c = polynomial_at(method, *points, level)
    signs = (-1.0) ** np.arange(n + 1)
    events = np.stack([schur_determinant(c), c.sum(axis=0), np.tensordot(signs, c, 1)])
    transform = np.linalg.inv(chebyshev.chebvander(nodes, size - 1)).T
    series = events @ transform
    zeros = np.concatenate([chebyshev_zeros(each) for each in series], axis=1)
    inside = np.where(np.abs(zeros) < 1, zeros, 1.0)
    return np.asarray((low + high + (high - low) * inside) / 2)


def sorted_with_ends(zeros: FloatArray, beta_range: tuple[float, float]) -> FloatArray:
    """Return each row of zeros in ascending order between the ends of the range."""
    ends = np.broadcast_to(beta_range, (len(zeros), 2))
    return np.sort(np.hstack([zeros, ends]).clip(*beta_range), axis=1)


@dataclass(frozen=True)
class Turns:
    """Intervals of beta_hat, one at each alpha_hat, within which the verdict turns from what it is at first."""

    method: Method
    level: float
    alpha_hat: FloatArray
    stable_at_first: BoolArray

    def narrowed(
        self, verdict: Verdict, before: FloatArray, after: FloatArray, tried: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Return the intervals from `before` to `after`, cut at `tried` where that lies within one."""
        within = (before < tried) & (tried < after)
        unchanged = np.zeros(tried.shape, bool)
        there = verdict(self.method, self.level, self.alpha_hat[within], tried[within])
        unchanged[within] = there == self.stable_at_first[within]
        return np.where(unchanged, tried, before), np.where(within & ~unchanged, tried, after)


def turning_points(turns: Turns, before: FloatArray, after: FloatArray) -> FloatArray:
    """Return where between `before` and `after` the verdict turns, to float64's rounding of P."""
    for _ in range(HALVINGS):
        before, after = turns.narrowed(stable, before, after, (before + after) / 2)
    return (before + after) / 2


def proven_turning_points(
    turns: Turns, before: FloatArray, after: FloatArray, found: FloatArray, close: FloatArray
) -> FloatArray:
    """Return the same to within `close`, proven; that the verdict does turn near where it was found is asked first.

    Where poles nearly meet on the circle it turns elsewhere: it is looked for farther and farther from there.
    """
    for times in FARTHER:
        for side in (-1, 1):
            before, after = turns.narrowed(proven_stable, before, after, found + side * times * close)
    for _ in range(HALVINGS):
        tried = np.where(after - before > 2.5 * close, (before + after) / 2, before)  # nothing is asked at an end
        before, after = turns.narrowed(proven_stable, before, after, tried)
    return (before + after) / 2


def chebyshev_zeros(series: FloatArray) -> FloatArray:
    """Return the real parts of the zeros of Chebyshev series, one a row, a row each; inf where one has fewer.

    They are the eigenvalues of the series' companion matrix in its symmetric scaling (numpy's chebcompanion), for all
    series of one degree at once. Coefficients that are rounding alone are not taken for a degree.
    """
    rows, most = len(series), series.shape[1] - 1
    zeros = np.full((rows, most), np.inf)
    counts = np.abs(series) > 10 * EPS * np.abs(series).max(axis=1, keepdims=True)
    degrees = most - np.argmax(counts[:, ::-1], axis=1)
    for degree in set(degrees[counts.any(axis=1)].tolist()) - {0}:
        own = degrees == degree
        c = series[own, : degree + 1]
        if degree == 1:
            zeros[own, 0] = -c[:, 0] / c[:, 1]
            continue
        scale = np.full(degree, np.sqrt(0.5))
        scale[0] = 1.0
        beside = np.full(degree - 1, 0.5)
        beside[0] = np.sqrt(0.5)
        companion = np.tile(np.diag(beside, 1) + np.diag(beside, -1), (len(c), 1, 1))
        companion[:, :, -1] -= c[:, :-1] / c[:, -1:] * (scale / scale[-1]) * 0.5
        zeros[own, :degree] = np.linalg.eigvals(companion[:, ::-1, ::-1]).real  # turned round: fewer roundings
    return zeros


def sliced_area(method: Method, level: float, panels: int = 8) -> float:
    """Return the area as the integral of the slices' lengths: no mu, no locus, no resultant in theta.

    It is looked for in the region's window.
    """
    return sliced_integral(method, level, panels, widened=1.0).value


def sliced_integral(method: Method, level: float, panels: int, widened: float) -> Integral:
    """Return the same with its error, from a box so many times as wide as the region's window about the same centre."""
    alpha_range, beta_range = (about(each, widened) for each in window(region(method, level)))

    def lengths(alpha_hat: FloatArray) -> FloatArray:
        return slice_lengths(method, level, alpha_hat, beta_range)

    low = alpha_range[0] or -0.01 * alpha_range[1]  # nothing begins at an end
    allowed = 1e-12 * (alpha_range[1] - alpha_range[0]) * (beta_range[1] - beta_range[0])
    return integral(lengths, np.linspace(low, alpha_range[1], panels + 1), lambda estimate: allowed)


def proven_sliced_integral(method: Method, level: float, panels: int, widened: float) -> Integral:
    """Return the same from slices whose ends are proven, with panels that lie closer where the region was found."""
    shape = region(method, level)
    assert shape.extent is not None
    alpha_range, beta_range = (about(each, widened) for each in window(shape))
    alpha_found, beta_found = (about(each, ROOM) for each in shape.extent)

    def lengths(alpha_hat: FloatArray) -> FloatArray:
        return proven_slice_lengths(method, level, alpha_hat, beta_range, beta_found)

    edges = np.concatenate([np.linspace(*alpha_range, panels + 1), np.linspace(*alpha_found, panels // 5 + 1)])
    return integral(lengths, np.unique(edges.clip(*alpha_range)), lambda estimate: SMOOTH * estimate)


def about(interval: tuple[float, float], times: float) -> tuple[float, float]:
    """Return the interval so many times as wide about the same centre."""
    low, high = interval
    return (low + high - times * (high - low)) / 2, (low + high + times * (high - low)) / 2


def integral(
    function: Callable[[FloatArray], FloatArray],
    edges: FloatArray,
    allowed_of: Callable[[float], float],
) -> Integral:
    """Return the integral over panels between edges; their halves may differ by what is allowed of a first estimate.

    Clenshaw-Curtis panels are halved until they agree: a corner, a vertical tangent or a jump ends at a width of 2^-40.
    Their nodes include the ends, or a jump just inside one would go unseen.
    """
    nodes, order = chebyshev.chebpts2(13), np.arange(0, 13, 2)
    moments = np.zeros(13)
    moments[order] = 2 / (1 - order**2)  # of T_k over (-1, 1)
    weights = np.linalg.solve(chebyshev.chebvander(nodes, 12).T, moments)

    def integrals(ends: FloatArray) -> FloatArray:
        half = np.diff(ends) / 2
        places = ends[:, :1] + half + half * nodes
        return np.asarray(half[:, 0] * (function(places.ravel()).reshape(places.shape) @ weights))

    ends = np.stack([edges[:-1], edges[1:]], axis=1)
    whole, total, error = integrals(ends), 0.0, 0.0
    allowed = allowed_of(float(whole.sum()))
    for _ in range(40):
        middle = ends.mean(axis=1)
        halves = np.stack([ends[:, 0], middle, middle, ends[:, 1]], axis=1).reshape(-1, 2)
        parts = integrals(halves)
        both = parts[::2] + parts[1::2]
        differences = np.abs(both - whole)
        rough = differences > allowed
        total += float(both[~rough].sum())
        error += float(differences[~rough].sum())
        ends, whole, differences = halves[np.repeat(rough, 2)], parts[np.repeat(rough, 2)], differences[rough]
        if not rough.any() or rough.sum() > MOST_ROUGH:
            break
    return Integral(total + float(whole.sum()), error + float(differences.sum()))
