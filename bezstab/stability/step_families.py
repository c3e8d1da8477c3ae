"""Families of methods by their number of steps, and the limit that the Bezier family tends to."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.methods import STEP_FAMILIES, Method, accuracy
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.best_points import best_point
from bezstab.stability.regions import Region, region
from bezstab.stability.searches import first_where

FINE_POINTS = 100_000  # of the locus, from which its largest coordinates are taken: to (pi / 1e5)^2 of them
DRAWN_EVERY = 100  # of the fine points one in so many is drawn
LIMIT_ERROR_CONSTANT = Fraction(1, 4)  # of 1/4 + 1/(6 (n - 1)), which B_n has


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
class Limit(ReadOnlyArrays):
    """What the Bezier methods tend to as n grows, dimensionless; `boundary` has shape (points, 2)."""

    area: float
    alpha_hat_max: float
    beta_hat_max: float
    z_abs: float
    error_constant: Fraction
    boundary: FloatArray


def family_members(family: str, first: int, last: int) -> list[Member]:
    """Return the methods of a family (a key of STEP_FAMILIES) from `first` to `last` steps, with their regions.

    KeyError for another family; NumericalError as for `region` and `best_point`. Dimensionless.
    """
    make = STEP_FAMILIES[family].make
    members = []
    for n in range(first, last + 1):
        method = make(n)
        best = best_point(method)
        order, error_constant = accuracy(method)
        members.append(Member(n, method, region(method), best.z_abs if best else None, order, error_constant))
    return members


def bezier_limit() -> Limit:
    """Return the limit region's area, axis limits, boundary and smallest |z_p|, dimensionless, to about 1e-12.

    Its locus is mu = (z - 1)^2 / (z (exp((z - 1) / z) - 1)), |z| = 1: the weights tend to int_0^1 e^x (-x)^j / j! dx.
    As for every B_n, complex mu lie inside the locus and real ones between mu(-1) and 0, and the smallest |z_p| is a
    double mu with roots z = +-r.
    """
    length = 4 / np.expm1(2)  # of the real interval: -mu(-1)
    z = np.exp(1j * np.linspace(0, np.pi, FINE_POINTS + 1)[1:])
    fine = _limit_mapping(z)
    alpha_hat, beta_hat = -2 * fine.real, np.abs(fine) ** 2
    arc = np.stack([alpha_hat, beta_hat], axis=-1)[::DRAWN_EVERY]
    edge = [[2 * length, length**2], [length, 0]]  # on which one mu is held at -length, and the other goes to zero

    opposite = first_where(lambda r: _limit_mapping(r) >= _limit_mapping(-r), np.array([0.1, 0.9]))
    assert opposite
    return Limit(
        area=_conjugate_area(z, fine) + length**3 / 6,  # of conjugate pairs, and of real ones
        alpha_hat_max=float(max(2 * length, alpha_hat.max())),
        beta_hat_max=float(beta_hat.max()),
        z_abs=opposite[1],
        error_constant=LIMIT_ERROR_CONSTANT,
        boundary=np.concatenate([[[0, 0]], arc, edge, [[0, 0]]]),
    )


def _limit_mapping(z: NDArray[Any]) -> NDArray[Any]:
    """Return mu(z) of the limit, real where z is."""
    return np.asarray((z - 1) ** 2 / (z * np.expm1((z - 1) / z)))


def _conjugate_area(z: ComplexArray, mu: ComplexArray) -> float:
    """Return the area of the conjugate pairs inside the locus, int 2 y^2 dx over mu = x + iy by Green.

    By the trapezoidal rule, good to rounding as the integrand is analytic all around; at both ends it is zero.
    """
    w = (z - 1) / z
    slope = 1j * z * mu * (2 / (z - 1) - 1 / z - np.exp(w) / np.expm1(w) / z**2)  # d mu / d theta
    return float(abs(np.pi / len(z) * (2 * mu.imag**2 * slope.real).sum()))
