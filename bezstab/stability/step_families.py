"""Families of methods by their number of steps, and the limit that the Bezier family tends to."""

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.polynomial.legendre import leggauss

from bezstab.methods import Method, accuracy, adams_bashforth, bezier
from bezstab.stability.best_points import best_point
from bezstab.stability.closed_loop import ComplexArray, FloatArray
from bezstab.stability.regions import Region, first_where, region

FAMILIES: dict[str, tuple[Callable[[int], Method], int]] = {
    "bezier": (bezier, 12),
    "adams-bashforth": (adams_bashforth, 8),
}
"""What makes a member, and the largest number of steps."""

NODES = 400  # of Gauss and Legendre on half the circle: the integrand is analytic, a fourth of them is enough


@dataclass(frozen=True)
class Member:
    """One method of a family: region, smallest |z_p| (None if its region is empty), order and error constant."""

    n: int
    method: Method
    region: Region
    z_abs: float | None
    order: int
    error_constant: Fraction


@dataclass(frozen=True)
class Limit:
    """What the Bezier methods tend to as n grows; `boundary` has shape (points, 2)."""

    area: float
    alpha_hat_max: float
    beta_hat_max: float
    z_abs: float
    error_constant: Fraction
    boundary: FloatArray


def family_members(family: str, first: int, last: int) -> list[Member]:
    """Return the family's methods from `first` to `last` steps."""
    made = [FAMILIES[family][0](n) for n in range(first, last + 1)]
    return [
        Member(n, m, region(m), best.z_abs if (best := best_point(m)) else None, *accuracy(m))
        for n, m in enumerate(made, first)
    ]


def bezier_limit() -> Limit:
    """Return the limit region's area, axis limits, boundary and smallest |z_p|, to about 1e-12.

    Its locus is mu = (z - 1)^2 / (z (exp((z - 1) / z) - 1)), |z| = 1: the weights tend to int_0^1 e^x (-x)^j / j! dx.
    As for every B_n, complex mu lie inside the locus and real ones between mu(-1) and 0, and the smallest |z_p| is a
    double mu with roots z = +-r.
    """
    nodes, weights = leggauss(NODES)
    theta = np.pi / 2 * (nodes + 1)
    z = np.exp(1j * theta)
    mu = _mu(z)
    w = (z - 1) / z
    slope = 1j * z * mu * (2 / (z - 1) - 1 / z - np.exp(w) / np.expm1(w) / z**2)  # d mu / d theta
    length = -_mu(np.array([-1 + 0j]))[0].real
    area = abs(np.pi / 2 * weights @ (2 * mu.imag**2 * slope.real)) + length**3 / 6
    fine = _mu(np.exp(1j * np.linspace(0, np.pi, 100001)[1:]))
    arc = np.stack([-2 * fine.real, np.abs(fine) ** 2], axis=-1)[::100]
    edge = np.linspace(length, 0, 3)[:, np.newaxis]
    upper = np.concatenate([edge + length, edge * length], axis=1)  # one mu held at mu(-1)
    met = first_where(lambda r: _mu(r.astype(complex)).real >= _mu(-r.astype(complex)).real, np.array([0.1, 0.9]))
    assert met
    boundary = np.concatenate([[[0.0, 0.0]], arc, upper, [[0.0, 0.0]]])
    furthest = float(max(2 * length, -2 * fine.real.min()))
    return Limit(float(area), furthest, float((np.abs(fine) ** 2).max()), met[1], Fraction(1, 4), boundary)


def _mu(z: ComplexArray) -> ComplexArray:
    limit: ComplexArray = (z - 1) ** 2 / (z * np.expm1((z - 1) / z))
    return limit
