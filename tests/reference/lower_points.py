"""Whether a best point is one: no sampled point of the quadrant, however far out, is proven to have a lower |z_p|."""

import numpy as np

from bezstab.methods import Method
from bezstab.stability import BestPoint, FloatArray
from tests.reference.companion_poles import polynomial_at, radius
from tests.reference.proven_verdicts import proven_stable

ALPHAS = np.concatenate([[0], np.geomspace(1e-3, 1e9, 64)])
BETAS = ALPHAS**2
STARTS = 6  # of the lowest samples, about each of which finer grids follow
ROUNDS, POINTS, SHRINK = 24, 9, 0.6
LOWER = 1e-6  # relative: a value so much lower is no rounding
AS_GOOD_AS_DEADBEAT = 1e-3  # of |z_p|: below it float64's multiple poles tell nothing
FARTHER = np.array([(1, 100), (10, 100), (10, 1)])  # times a point: |z_p| leaves zero on the way there, or falls on
FALLEN = 0.1  # of |z_p|: by 1e9 it has come so near to what it is said to fall towards


def contradictions(method: Method, best: BestPoint | None, limit: float | None) -> list[str]:
    """Return in words what is wrong with a best point, or with what |z_p| falls towards (None: not told)."""
    claimed = best.z_abs if best else 1.0 if limit is None else limit
    values, points = _low_points(method)
    found = []
    below = claimed * (1 - LOWER)
    if below > AS_GOOD_AS_DEADBEAT:
        lower = proven_stable(method, below, *points.T) & (values < below)
        found += [
            f"|z_p| is {z_abs:.9g} at ({a:.9g}, {b:.9g})"
            for z_abs, (a, b) in zip(values[lower], points[lower], strict=True)
        ]
    if best and best.z_abs < AS_GOOD_AS_DEADBEAT:
        point = np.array([best.alpha_hat, best.beta_hat])
        moved = point * FARTHER
        farther = _z_abs(method, moved[(moved != point).any(axis=1)])  # not along an axis on which the point lies
        if farther.min(initial=1.0) < AS_GOOD_AS_DEADBEAT:
            found.append(f"|z_p| is {farther.min():.3g} farther out: it is zero in the limit alone")
    if best is None and limit is not None and values.min() > limit + FALLEN:
        found.append(f"|z_p| nowhere falls below {values.min():.6g}")
    return found


def _low_points(method: Method) -> tuple[FloatArray, FloatArray]:
    """Return low |z_p|, and where: the best of finer and finer grids about the lowest of samples in all decades."""
    samples = np.stack(np.meshgrid(ALPHAS, BETAS), axis=-1).reshape(-1, 2)
    z_abs = _z_abs(method, samples)
    lowest = np.argsort(z_abs)[:STARTS]
    step = ALPHAS[-1] / ALPHAS[-2]
    found = [_lowest_about(method, samples[k], float(z_abs[k]), step) for k in lowest]
    return np.array([value for value, _ in found]), np.array([point for _, point in found])


def _lowest_about(method: Method, point: FloatArray, value: float, step: float) -> tuple[float, FloatArray]:
    """Return the lowest |z_p| of grids of factors of both coordinates, each grid narrower than the last."""
    for _ in range(ROUNDS):
        factors = step ** np.linspace(-1, 1, POINTS)
        grid = point * np.stack(np.meshgrid(factors, factors**2), axis=-1).reshape(-1, 2)
        z_abs = _z_abs(method, grid)
        least = int(np.argmin(z_abs))
        if z_abs[least] < value:
            value, point = float(z_abs[least]), grid[least]
        step = step**SHRINK
    return value, point


def _z_abs(method: Method, points: FloatArray) -> FloatArray:
    """Return |z_p|, infinite where a step has no solution."""
    c = polynomial_at(method, *points.T)
    with np.errstate(all="ignore"):
        solvable = np.isfinite(c / c[0]).all(axis=0)
    z_abs = np.full(len(points), np.inf)
    z_abs[solvable] = radius(method, *points[solvable].T)
    return z_abs
