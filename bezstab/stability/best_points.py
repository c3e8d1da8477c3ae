r"""The smallest |z_p| a method can reach, and where: the lowest points of a map, narrowed until rounding decides.

Of a method that has a mu the poles are those of both mu. Of two real ones the worse decides, so that both are as good
where the better one is double. The least lies over conjugate mu, then, or over a double one:

      |mu| |         +                          x: a kink, where two poles have one modulus
           |   x     |                          +: a kink on the edge, damping ratio 1, where both mu are one;
           |         |                             grids around the lowest points of a map narrow it
           +---------' damping ratio 0 to 1

Of any other method three poles and more may meet, next to which |z_p| rises like a cube root: no grid of points narrows
that. But on a line of constant alpha_hat the least level that has a stable stretch is known from few eigenvalues,
whatever meets there: lines narrow it.

Far out |z_p| may be lower than anywhere, and then no point has the least. All is dimensionless.
"""

import math
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
from numpy.polynomial.polynomial import polyder, polyroots, polyval2d, polyval3d

from bezstab.errors import NumericalError
from bezstab.methods.schemes import Method
from bezstab.rationals import exact
from bezstab.stability.arrays import DOUBLE, ROUNDING, SAME, FloatArray
from bezstab.stability.closed_loop import converges, largest_at_mu, mu_table, poles, spectral_radius
from bezstab.stability.root_finding import roots_of_rows
from bezstab.stability.searches import lowest_minima, zoom_on_minimum
from bezstab.stability.stretches import ALONG_BETA, float_table, middle_of, paths

SIZES: FloatArray = np.geomspace(1e-4, 1e4, 129)  # of alpha h, beta h: 15 % from one to the next
FAR_OUT = 1e3  # of beta h: what is there as low as the limit comes near it
RATIOS: FloatArray = np.linspace(0, np.pi / 2, 33)  # arcsines of damping ratios
STARTS = 8  # of a map's minima, the lowest
ROUGH, ROUNDS, SHRINK = 8, 45, 0.4  # grids of a zoom, at first and then to 1e-16 of the first
HOPEFUL = 0.02  # above the lowest: a zoom has not stopped so far short after its first grids
NEAR = 0.03  # of logarithms: starts so near lead to one place
LINES, LINE_ROUNDS = 17, 18  # the same over lines, each an eighth of the last
OFFSETS: FloatArray = np.linspace(-1, 1, LINES)
WELL_INSIDE = 0.9  # of the reach: a best line further out says that the valley may lead on
REACH = 0.3  # of alpha_hat: within it a line as good as any lies, where a start is
HOPEFUL_ZERO = 0.1  # |z_p| from which all poles may be led to zero
NEWTON_STEPS, NEWTON_TOLERANCE = 60, 1e-11  # a double zero is come to by halves, and to the root of rounding
CLUSTER = 0.05  # of |z_p|: three poles so near each other are one, which rounding parts by its cube root
SHORTEST = 1e-11  # of a stretch: a level at which none is longer is off by up to the root of it
ENOUGH = 1e-13  # of a level, to which its bisection goes on
AT_ZERO = 1e-7  # |z_p|: where two poles meet at zero, a rounding of the place parts them by so much
FAR = 500.0  # so far out, in natural logarithms, the highest powers of P stay in the range of float64
VANISHES = 1e-30  # of P's coefficients: a leading one that is so small so far out leaves a pole beyond all sizes
WAYS: FloatArray = np.linspace(0, np.pi / 2, 1441)  # angles of log beta_hat to log alpha_hat
DIRECTIONS = sorted(
    ((p, q) for p in range(7) for q in range(7) if math.gcd(p, q) == 1), key=lambda way: (sum(way), way)
)


Place = tuple[float, float]
"""alpha_hat and beta_hat."""

Found = tuple[Place, float]
"""A place, and |z_p| there."""


@dataclass(frozen=True, repr=False)
class BestPoint:
    """The smallest |z_p|, one point that has it, and others (alpha_hat, beta_hat) at which all poles are zero, too."""

    method: Method
    z_abs: float
    alpha_hat: float
    beta_hat: float
    elsewhere: tuple[tuple[float, float], ...] = ()

    def __repr__(self) -> str:
        place = f"alpha_hat = {self.alpha_hat:.6g}, beta_hat = {self.beta_hat:.6g}"
        return f"BestPoint({self.method.name}: |z_p| = {self.z_abs:.6g} at {place})"


@dataclass(frozen=True)
class FarLimit:
    """A value that |z_p| tends to as the parameters grow without end, and along which way.

    The way is alpha_hat = x t^p, beta_hat = y t^q as t grows, `direction` = (p, q). `ratio` is that of alpha_hat^q to
    beta_hat^p, None if any will do.
    """

    z_abs: float
    direction: tuple[int, int]
    ratio: float | None = None


def best_point(method: Method) -> BestPoint | None:
    """Return the smallest |z_p|, to 1e-7, and its place; None if nothing has |z_p| < 1, or if it falls on far out.

    In the latter case `falls_towards` says so. Of the poles of paper Eq. 17, among alpha_hat, beta_hat >= 0.
    NumericalError if a pole leaves the range of float64.
    """
    found = _best_or_limit(method)
    return found if isinstance(found, BestPoint) else None


def falls_towards(method: Method) -> FarLimit | None:
    """Return the value that |z_p| falls towards as parameters grow, along which way, where no point has one as low.

    Zero for implicit Euler and BDF. None if some point has the least |z_p|, or none is stable. Errors as best_point.
    """
    found = _best_or_limit(method)
    return found if isinstance(found, FarLimit) else None


def best_point_or_reason(method: Method) -> tuple[BestPoint | None, str | None]:
    """Return `best_point`, and why it is not known where its search ended in NumericalError, else None."""
    try:
        return best_point(method), None
    except NumericalError as error:
        return None, str(error)


@cache
def _best_or_limit(method: Method) -> BestPoint | FarLimit | None:
    limit = _far_limit(method)
    found = _over_mu(method) if mu_table(method).size else _over_plane(method, limit)
    least, lowest = min(((level, place) for place, level in found), default=(math.inf, (math.inf, math.inf)))
    far_out = math.sqrt(lowest[1]) * float(method.step_multiple) > FAR_OUT
    if least > AT_ZERO and limit.z_abs < least * (1 + (DOUBLE if far_out else -DOUBLE)):
        return limit
    # of several alike, as along an arc of B2, the most damped
    alike = [place for place, level in found if level <= max(AT_ZERO, least * (1 + SAME))]
    (alpha_hat, beta_hat), *others = sorted(alike, key=lambda place: -place[0] / math.sqrt(place[1]))
    if not converges(method, exact(alpha_hat), exact(beta_hat)):
        return None
    if least > AT_ZERO:
        return BestPoint(method, least, alpha_hat, beta_hat)
    zeros = [(alpha_hat, beta_hat)]
    for place in others:
        if not any(np.allclose(place, other, rtol=DOUBLE, atol=DOUBLE) for other in zeros):
            zeros.append(place)
    return BestPoint(method, 0.0, alpha_hat, beta_hat, tuple(zeros[1:]))


def _over_mu(method: Method) -> list[Found]:
    """Return places of lowest |z_p| of a method that has a mu."""

    def modulus(points: FloatArray) -> FloatArray:
        """Return the largest |z| over points (log |mu|, arcsine of the damping ratio)."""
        mu = np.exp(points[..., 0]) * (1j * np.cos(points[..., 1]) - np.sin(points[..., 1]))
        return np.abs(largest_at_mu(method, mu.ravel())).reshape(mu.shape)

    def on_edge(points: FloatArray) -> FloatArray:
        return modulus(np.concatenate([points, np.full_like(points, np.pi / 2)], axis=-1))

    def in_plane(log_size: float, ratio: float) -> Place:
        size = math.exp(log_size) / float(method.step_multiple)
        return 2 * size * math.sin(ratio if ratio > ROUNDING else 0), size**2

    axis, within = np.log(SIZES), partial(np.clip, a_min=[-np.inf, 0], a_max=[np.inf, np.pi / 2])
    starts, rough = lowest_minima(modulus, [axis, RATIOS], STARTS, rounds=ROUGH, shrink=SHRINK, fold=within)
    ((edge,), *_), (at_edge, *_) = lowest_minima(on_edge, [axis], 1, rounds=ROUNDS, shrink=SHRINK)
    found = [(in_plane(edge, np.pi / 2), float(at_edge))]
    for start, _ in _hopeful(starts, rough):
        point, zoomed = zoom_on_minimum(
            modulus, start, np.full(2, SHRINK**ROUGH), rounds=ROUNDS, shrink=SHRINK, fold=within
        )
        place, least = in_plane(*point.tolist()), float(zoomed)
        # valleys that are curved and narrower than a grid's spacing hold grids of points fast
        found.append(
            _narrowed(method, *place, least, NEAR) if AT_ZERO < least < at_edge * (1 - SAME) else (place, least)
        )
    return found


def _over_plane(method: Method, limit: FarLimit) -> list[Found]:
    """Return the same of a method without a mu; nothing where only zeros are lower than a limit."""
    multiple = float(method.step_multiple)

    def modulus(points: FloatArray) -> FloatArray:
        return spectral_radius(method, points[..., 0], np.exp(points[..., 1]))

    axes = [np.array([0.0, *(2 * SIZES / multiple)]), 2 * np.log(SIZES / multiple)]
    starts, rough = lowest_minima(
        modulus, axes, STARTS, rounds=ROUGH, shrink=SHRINK, fold=partial(np.clip, a_min=[0, -np.inf], a_max=np.inf)
    )
    hopeful = [((float(start[0]), float(np.exp(start[1]))), level) for start, level in _hopeful(starts, rough)]
    all_poles = len(float_table(method)) - 1
    near_zero = [_multiple_pole(method, all_poles, place) for place, level in hopeful if level < HOPEFUL_ZERO]
    zeros = [(found[0], 0.0) for found in near_zero if found]
    if zeros or not limit.z_abs:
        return zeros
    return [_narrowed(method, *place, level, REACH * place[0] or REACH) for place, level in hopeful]


def _multiple_pole(method: Method, times: int, near: Place, pole: float | None = None) -> Found | None:
    """Return the place near another one where a real pole is so many times a root of P, and it: near `pole`, or zero.

    P and its derivatives vanish there, which is smooth though poles part like a root. Newton's method; None without.
    """
    derivatives = [polyder(float_table(method), k) for k in range(times)]
    found = np.array([pole or 0.0, *near])
    free = slice(1 if pole is None else 0, None)
    for _ in range(NEWTON_STEPS):
        z, a, b = found.tolist()
        values = [polyval3d(z, a, b, each) for each in derivatives]
        slopes = np.array([[polyval3d(z, a, b, polyder(each, axis=k)) for k in range(3)] for each in derivatives])
        change = np.linalg.lstsq(slopes[:, free], values, rcond=SAME)[0]
        found[free] -= change
        if np.abs(change).max() <= NEWTON_TOLERANCE * np.abs(found).max():
            place = abs(float(found[1])), abs(float(found[2]))
            close = np.allclose(place, near, rtol=0.1, atol=0.1 * max(near))
            return (place, float(found[0])) if close and np.abs(values).max() <= DOUBLE else None
    return None


def _hopeful(starts: FloatArray, rough: FloatArray) -> list[tuple[FloatArray, float]]:
    """Return the places from which to go on, and their values: near the least, and no two of them near each other."""
    kept: list[tuple[FloatArray, float]] = []
    for k in np.argsort(rough, kind="stable"):
        if rough[k] <= rough.min() + HOPEFUL and all(np.abs(starts[k] - start).max() > NEAR for start, _ in kept):
            kept.append((starts[k], float(rough[k])))
    return kept


def _narrowed(method: Method, alpha_hat: float, beta_hat: float, level: float, reach: float) -> Found:
    """Return the place of the least |z_p| near one that has a level, and that least, from lines of constant alpha_hat.

    On each the least level with a stable stretch counts: it falls in leaps until no line has a lower one.
    """
    level, least = level * (1 + HOPEFUL), level  # rounding may have lowered it
    fall = level / 2
    for _ in range(LINE_ROUNDS):
        lines, before, low, start = np.abs(alpha_hat + reach * OFFSETS), alpha_hat, 0.0, level
        while level - low > ENOUGH * level and level > AT_ZERO / 2:
            tried = max(level - fall, (low + level) / 2)
            stable = paths(method, lines, np.ones_like(lines), ALONG_BETA, tried).stretches(SHORTEST)
            if stable.path.size:
                _, first = np.unique(stable.path, return_index=True)
                middle = int(first[len(first) // 2])
                alpha_hat = float(lines[stable.path[middle]])
                beta_hat = float(middle_of(stable.low[middle], stable.high[middle]))
                lines, fall, level = lines[stable.path[first]], 2 * fall, tried
                least = level
            else:
                low, fall = tried, (level - tried) / 8
        if abs(alpha_hat - before) < WELL_INSIDE * reach:
            reach *= 2 / (LINES - 1)
        fall = max(start - level, ENOUGH * level)
    z = poles(method, alpha_hat, beta_hat)
    together = np.abs(z - z[0]) <= CLUSTER * level
    if np.count_nonzero(together) > 2 and (
        found := _multiple_pole(method, 3, (alpha_hat, beta_hat), z[together].real.mean())
    ):
        return found[0], abs(found[1])
    return (alpha_hat if alpha_hat > ROUNDING else 0.0, beta_hat), least


def _far_limit(method: Method) -> FarLimit:
    """Return the least value that |z_p| tends to as parameters grow; infinite where a pole does.

    Of a method with a mu both grow as beta_hat does, at any alpha_hat, and the poles tend to the roots of what stands
    in front of the highest power of mu. Of any other a circle in the logarithms of alpha_hat and beta_hat meets all
    ways far out.
    """
    in_mu = mu_table(method)
    if in_mu.size:
        polynomial = np.trim_zeros(in_mu[:, -1], "b")
        lost = len(polynomial) < len(in_mu)
        return FarLimit(math.inf if lost else float(np.abs(polyroots(polynomial)).max(initial=0.0)), (0, 1))
    table, far = float_table(method), FAR / sum(float_table(method).shape[1:])

    def modulus(points: FloatArray) -> FloatArray:
        """Return |z_p| at angles of log beta_hat to log alpha_hat, which each zoom holds within the quadrant."""
        angles = np.clip(points[..., 0], 0, np.pi / 2)
        return at(far * np.cos(angles), far * np.sin(angles))

    def at(log_alpha: FloatArray, log_beta: FloatArray) -> FloatArray:
        rows = np.stack([polyval2d(np.exp(log_alpha), np.exp(log_beta), in_plane).ravel() for in_plane in table])
        lost = np.abs(rows[-1]) < VANISHES * np.abs(rows).max(axis=0)
        return np.where(lost, math.inf, np.abs(roots_of_rows(rows)).max(axis=0)).reshape(log_alpha.shape)

    ((angle,), *_), (value, *_) = lowest_minima(modulus, [WAYS], STARTS)
    value = 0.0 if value < AT_ZERO else float(value)
    for p, q in DIRECTIONS:  # the plainest one along which any ratio will do
        on_way = far * np.array([p, q]) / math.hypot(p, q) + np.array([(0, 0), (0, 1), (0, -1)])
        if (at(*on_way.T) <= value * (1 + DOUBLE) + AT_ZERO).all():
            return FarLimit(value, (p, q))
    p, q = min(DIRECTIONS, key=lambda way: abs(math.atan2(way[1], way[0]) - angle))
    return FarLimit(value, (p, q), math.exp(far * (q * math.cos(angle) - p * math.sin(angle))))
