"""The smallest |z_p| a method can reach, and where, from the equations that define it.

|z_p| over conjugate mu is f(mu) = max |z| over the roots of pi(., mu), and a real pair does no better. log f is a
maximum of harmonic functions, so away from z = 0 and from double roots it has its least value at a kink: two roots of
equal modulus whose gradients oppose each other, or three whose gradients surround zero.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial.polynomial import polyder, polyval2d

from bezstab.errors import NumericalError
from bezstab.methods import Method, feedback_matrix
from bezstab.stability.closed_loop import ComplexArray, FloatArray, dominant_root, float_table, roots_in_mu, roots_in_z
from bezstab.stability.regions import region

ROUNDING = 1e-9  # relative; a solved kink's moduli agree to about 1e-15, neighbouring candidates differ far more
DOUBLE = 1e-6  # relative; two roots closer than this are one double root, which float64 splits by sqrt(eps) = 1e-8
REACH = 1e150  # of mu, whose square is beta_hat; one zero of R is always within its degree, as R(0) = R'(0) = 1
NEWTON_STEPS = 30
STARTS = 6  # local minima of the sampled f that are followed up


@dataclass(frozen=True)
class BestPoint:
    """The smallest |z_p|, one point that has it, and the poles of that modulus there (Im >= 0, dimensionless).

    `double`: those poles are double, because the two mu coincide. `elsewhere` has the other points (alpha_hat,
    beta_hat) with the same |z_p|; with `arc` they are the two ends of a curve along which it is constant.
    """

    method: Method
    z_abs: float
    alpha_hat: float
    beta_hat: float
    meeting: tuple[complex, ...]
    double: bool
    elsewhere: tuple[tuple[float, float], ...]
    arc: bool


@cache
def best_point(method: Method) -> BestPoint | None:
    """Return the smallest |z_p| and its place, to about 1e-12; None if no parameters have |z_p| < 1.

    NumericalError if no solution of the defining equations is as small as a sampled |z_p|.
    """
    if len(float_table(method)) == 2:  # one step: z = R(mu), and the zeros of R are deadbeat
        zeros: list[complex] = []
        for mu in map(_upper, np.sort_complex(roots_in_mu(method, np.zeros(1, complex))[:, 0])):  # most damped first
            if abs(mu) < REACH and all(abs(mu - other) > DOUBLE * abs(mu) for other in zeros):
                zeros.append(mu)
        return _described(method, 0.0, zeros, arc=False)
    if not region(method).boundary:
        return None
    z_abs, mu = _smallest(method)
    end = _other_end(method, z_abs, mu)
    return _described(method, z_abs, [mu] if end is None else [mu, end], arc=end is not None)


def _described(method: Method, z_abs: float, mus: list[complex], arc: bool) -> BestPoint:
    """Return the optimum at the first of mus, with its poles in the plane of the user's parameters."""
    places = np.array(mus)
    to_user = np.linalg.inv(np.array(feedback_matrix(method), float))
    points = np.stack([-2 * places.real, np.abs(places) ** 2], axis=-1) @ to_user.T
    z = roots_in_z(method, places[:1])[:, 0]
    largest = z[np.abs(z) >= z_abs * (1 - DOUBLE)] if z_abs else np.zeros(1, complex)
    upper = np.where(np.abs(largest.imag) < DOUBLE * z_abs, largest.real, largest.real + 1j * np.abs(largest.imag))
    meeting: list[complex] = []
    for pole in sorted(upper, key=lambda pole: (-pole.real, pole.imag)):
        if all(abs(pole - other) > DOUBLE * z_abs for other in meeting):
            meeting.append(complex(pole))
    (alpha_hat, beta_hat), *elsewhere = [(float(a), float(b)) for a, b in points]
    return BestPoint(
        method, z_abs, alpha_hat, beta_hat, tuple(meeting), bool(places[0].imag == 0), tuple(elsewhere), arc
    )


def _smallest(method: Method) -> tuple[float, complex]:
    """Return min f and a mu that has it, a real one if there is one."""
    sampled = list(_local_minima(method))
    lowest = min(f for f, _ in sampled)
    solved = [solution for _, mu in sampled for solution in _solutions(method, mu)]
    best = min((f for f, _ in solved), default=np.inf)
    if not best <= lowest * (1 + ROUNDING):
        raise NumericalError(f"{method.name}: |z_p| = {lowest:.6g} was sampled, but no kink as low could be solved for")
    return min((s for s in solved if s[0] <= best * (1 + ROUNDING)), key=lambda s: (abs(s[1].imag), s[0]))


def _local_minima(method: Method) -> Iterator[tuple[float, complex]]:
    """Yield the lowest local minima of f on a grid over S_1, each narrowed by a sequence of smaller grids."""
    corners = np.abs(np.concatenate(region(method).boundary) @ np.array(feedback_matrix(method), float).T)
    reach = float(np.max(corners[:, 0] + np.sqrt(corners[:, 1])))  # of both roots of the feedback
    x, y = np.linspace(-reach, reach / 4, 151), np.linspace(0, reach, 121)
    f = np.pad(_f(method, x + 1j * y[:, np.newaxis]), 1, mode="reflect")
    neighbours = np.stack([np.roll(f, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    rows, columns = np.nonzero((f == neighbours.min(axis=0))[1:-1, 1:-1])
    lowest = np.argsort(f[1:-1, 1:-1][rows, columns])[:STARTS]
    offsets = np.linspace(-1, 1, 13)
    for row, column in zip(rows[lowest], columns[lowest], strict=True):
        mu, width = complex(x[column], y[row]), x[1] - x[0]
        for _ in range(30):
            around = mu + width * (offsets + 1j * offsets[:, np.newaxis])
            values = _f(method, around.real + 1j * np.abs(around.imag))
            k = np.argmin(values)
            mu, width = complex(around.flat[k].real, abs(around.flat[k].imag)), 0.6 * width
        yield float(values.flat[k]), mu


def _f(method: Method, mu: ComplexArray) -> FloatArray:
    return np.abs(dominant_root(method, mu.ravel())).reshape(mu.shape)


def _solutions(method: Method, start: complex) -> Iterator[tuple[float, complex]]:
    """Yield (f, mu) for every kind of least value that Newton's method finds from a nearby start.

    The unknowns are mu and the roots z that meet there, as complex numbers x[0] and x[1:].
    """
    table = float_table(method)
    table_z, table_mu = (polyder(table, axis=axis) for axis in (0, 1))

    def on_the_locus(x: ComplexArray) -> list[float]:
        return [part for z in x[1:] for part in _parts(polyval2d(z, x[0], table))]

    def two_on_the_axis(x: ComplexArray) -> list[float]:
        return [*on_the_locus(x), np.log(abs(x[1] / x[2])), x[0].imag]

    def two_opposed(x: ComplexArray) -> list[float]:
        z, mu = x[1:], np.full(2, x[0])
        first, second = -polyval2d(z, mu, table_mu) / (z * polyval2d(z, mu, table_z))  # d log z / d mu
        return [*on_the_locus(x), np.log(abs(x[1] / x[2])), (first / second).imag]

    def three(x: ComplexArray) -> list[float]:
        return [*on_the_locus(x), *np.log(np.abs(x[1:3] / x[2:4]))]

    def double_root(x: ComplexArray) -> list[float]:
        return [*on_the_locus(x), *_parts(polyval2d(x[1], x[0], table_z))]

    z = roots_in_z(method, np.array([start]))[:, 0]
    z = z[np.argsort(-np.abs(z))]
    problems = [(two_on_the_axis, [z[0], other]) for other in z[1:3]]
    problems += [(two_opposed, [*z[:2]]), (double_root, [z[:2].mean()])]
    if len(z) > 2:
        problems.append((three, [*z[:3]]))
    for equations, meeting in problems:
        x = _newton(equations, np.array([start, *meeting]))
        if not np.isfinite(x).all():
            continue
        r, others, matched = float(np.abs(x[1:]).max()), roots_in_z(method, x[:1])[:, 0], True
        for solved in [*x[1:], x[1]] if equations is double_root else x[1:]:
            k = np.argmin(np.abs(others - solved))
            matched &= bool(np.abs(others[k] - solved) <= DOUBLE * r)  # else a least-squares fit that solves nothing
            others = np.delete(others, k)
        if matched and np.all(np.abs(others) <= r * (1 + ROUNDING)):
            yield r, _upper(x[0])


def _parts(value: complex) -> tuple[float, float]:
    return value.real, value.imag


def _upper(mu: complex) -> complex:
    """Return mu or its conjugate, Im mu >= 0, on the real axis if it is there to rounding."""
    return complex(mu.real, abs(mu.imag) if abs(mu.imag) > ROUNDING * abs(mu) else 0)


def _newton(equations: Callable[[ComplexArray], list[float]], x: ComplexArray) -> ComplexArray:
    """Return a zero by Gauss-Newton steps with central differences; nan where none is reached.

    Least squares, because along an arc of equal |z_p| the equations are dependent.
    """
    scale = np.abs(x).max()
    directions = 1e-6 * scale * np.concatenate([np.eye(len(x)), 1j * np.eye(len(x))])  # truncation 1e-12, noise 1e-10
    with np.errstate(all="ignore"):
        for _ in range(NEWTON_STEPS):
            columns = [np.subtract(equations(x + d), equations(x - d)) / 2 for d in directions]
            residual = np.array(equations(x))
            if not np.isfinite([*columns, residual]).all():
                break
            step = np.linalg.lstsq(np.stack(columns, axis=1), residual, rcond=1e-9)[0] @ directions
            x = x - step
            if np.abs(step).max() < ROUNDING**1.5 * scale:
                return x
    return np.full_like(x, np.nan)


def _other_end(method: Method, z_abs: float, mu: complex) -> complex | None:
    """Return the far end of the curve through mu on which f has its least value z_abs; None if that is a point."""
    theta, far = np.linspace(-np.pi, np.pi, 4097), mu
    for narrowing in range(8):
        locus = roots_in_mu(method, z_abs * np.exp(1j * theta))
        equal = np.isfinite(locus) & (locus.imag >= 0)
        equal[equal] = _f(method, locus[equal]) <= z_abs * (1 + ROUNDING)
        if narrowing == 0 and equal.sum() < len(theta) / 10:  # a kink shows at isolated theta only
            return None
        distance = np.where(equal, np.abs(locus - mu), -1)
        branch, k = divmod(int(np.argmax(distance)), len(theta))
        far = complex(locus[branch, k])
        theta = np.linspace(theta[max(k - 1, 0)], theta[min(k + 1, len(theta) - 1)], 65)
    return far
