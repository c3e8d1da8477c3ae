"""The area of a region by a second route: stable intervals on lines of constant alpha_hat, integrated.

No mu, no locus, no resultant in theta: Schur's recursion and determinant on P's own coefficients.
"""

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from bezstab.methods import Method
from bezstab.stability import FloatArray, region, window
from tests.reference.companion_poles import closed_loop_tables, polynomial_at

BoolArray = NDArray[np.bool_]
EPS = float(np.finfo(float).eps)
MOST_ROUGH = 5_000  # panels that still disagree: then by rounding, which no halving mends
HALVINGS = 52  # of a bracket of an interval's end: to rounding


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


def slice_lengths(
    method: Method, level: float, alpha_hat: FloatArray, beta_range: tuple[float, float], bisected: bool = False
) -> FloatArray:
    """Return the length of the stable set in beta_hat at each alpha_hat, a sum of intervals.

    Their ends are zeros in beta_hat of P(level), P(-level) and Schur's determinant, each interpolated without error by
    its degree; a zero too many splits an interval in two and changes nothing. Zeros are good to rounding of the whole
    range; `bisected` ends, where the verdict of Schur's recursion turns, to their own.
    """
    tables = closed_loop_tables(method)
    n, low, high = len(tables) - 1, *beta_range
    size = (tables.shape[2] - 1) * (n - 1) + 1
    nodes = chebyshev.chebpts1(size)
    alpha_nodes, beta_nodes = np.broadcast_arrays(alpha_hat[:, None], (low + high + (high - low) * nodes) / 2)
    c = polynomial_at(method, alpha_nodes, beta_nodes, level)
    signs = (-1.0) ** np.arange(n + 1)
    events = np.stack([schur_determinant(c), c.sum(axis=0), np.tensordot(signs, c, 1)])
    transform = np.linalg.inv(chebyshev.chebvander(nodes, size - 1)).T
    series = events @ transform
    zeros = np.concatenate([chebyshev_zeros(each) for each in series], axis=1)
    inside = np.where(np.abs(zeros) < 1, zeros, 1.0)  # what lies outside becomes an interval without length
    ends = np.sort(np.concatenate([inside, np.broadcast_to([-1.0, 1.0], (alpha_hat.size, 2))], axis=1), axis=1)
    beta = (low + high + (high - low) * ends) / 2
    middle = (beta[:, 1:] + beta[:, :-1]) / 2
    alpha_there = np.broadcast_to(alpha_hat[:, None], middle.shape)
    is_stable = stable(method, level, alpha_there, middle)
    if bisected:
        row, interval = np.nonzero(is_stable[:, 1:] != is_stable[:, :-1])
        before, after = middle[row, interval], middle[row, interval + 1]
        for _ in range(HALVINGS):
            between = (before + after) / 2
            unchanged = stable(method, level, alpha_hat[row], between) == is_stable[row, interval]
            before, after = np.where(unchanged, between, before), np.where(unchanged, after, between)
        beta[row, interval + 1] = (before + after) / 2
    return np.asarray(np.where(is_stable, np.diff(beta), 0.0).sum(axis=1))


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


def sliced_area(method: Method, level: float, panels: int = 8, widened: float = 1.0, bisected: bool = False) -> float:
    """Return the area as the integral of the slices' lengths: no mu, no locus, no resultant in theta.

    `bisected` as in `slice_lengths`. It is looked for in the region's window, or one so many times as wide about the
    same centre. Clenshaw-Curtis panels are halved until they agree: a corner, a vertical tangent or a jump ends at a
    width of 2^-40. Their nodes include the ends, or a jump just inside one would go unseen.
    """
    box = tuple(
        ((low + high - widened * (high - low)) / 2, (low + high + widened * (high - low)) / 2)
        for low, high in window(region(method, level))
    )
    nodes, order = chebyshev.chebpts2(13), np.arange(0, 13, 2)
    moments = np.zeros(13)
    moments[order] = 2 / (1 - order**2)  # of T_k over (-1, 1)
    weights = np.linalg.solve(chebyshev.chebvander(nodes, 12).T, moments)

    def integrals(ends: FloatArray) -> FloatArray:
        half = np.diff(ends) / 2
        alpha_hat = ends[:, :1] + half + half * nodes
        lengths = slice_lengths(method, level, alpha_hat.ravel(), box[1], bisected).reshape(alpha_hat.shape)
        return np.asarray(half[:, 0] * (lengths @ weights))

    edges = (
        np.linspace(-0.01 * box[0][1], box[0][1], panels + 1) if box[0][0] == 0 else np.linspace(*box[0], panels + 1)
    )
    ends = np.stack([edges[:-1], edges[1:]], axis=1)
    whole, total = integrals(ends), 0.0
    allowed = 1e-12 * np.diff(box[0])[0] * np.diff(box[1])[0]
    if bisected:
        allowed = min(allowed, 1e-10 * float(whole.sum()))
    for _ in range(40):
        middle = ends.mean(axis=1)
        halves = np.stack([ends[:, 0], middle, middle, ends[:, 1]], axis=1).reshape(-1, 2)
        parts = integrals(halves)
        both = parts[::2] + parts[1::2]
        rough = np.abs(both - whole) > allowed
        total += float(both[~rough].sum())
        ends, whole = halves[np.repeat(rough, 2)], parts[np.repeat(rough, 2)]
        if not rough.any() or rough.sum() > MOST_ROUGH:
            break
    return total + float(whole.sum())
