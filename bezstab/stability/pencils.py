"""A pencil: everything that float64 needs to know of a method, made once and handed on.

A pencil is to a method what a compiled mechanism is to a scene. It is the polynomial pi(z, mu) of one step on
y' = lambda y, mu = h lambda, whose roots z at a given mu, and mu at a given z, are what this room is about.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property

import numpy as np
from numpy.polynomial.polynomial import polyder, polymul, polyroots, polysub, polyval, polyval2d

from bezstab.errors import NumericalError
from bezstab.methods import Method, branch_polynomial, coefficient_table, feedback_matrix
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.exact_sums import ExactMatrix
from bezstab.stability.root_finding import roots_of_table


@dataclass(frozen=True, eq=False, repr=False)
class Pencil:
    """A method's polynomial pi(z, mu) = sum_kj table[k, j] z^k mu^j in float64, and what follows from it.

    `steps` is its degree in z. `table_by_z` and `table_by_mu` are the tables of its derivatives. The feedback asks for
    mu^2 + p mu + q = 0: `feedback` is the exact 2x2 matrix from (alpha_hat, beta_hat) to (p, q), `to_feedback` the
    same in float64, `to_user` its inverse. Everything is dimensionless.
    """

    method: Method
    steps: int
    table: FloatArray
    table_by_z: FloatArray
    table_by_mu: FloatArray
    feedback: ExactMatrix
    to_feedback: FloatArray
    to_user: FloatArray

    def __repr__(self) -> str:
        return f"Pencil({self.method.name})"

    @cached_property
    def branch_points(self) -> ComplexArray:
        """Every mu at which two roots z of pi(., mu) meet; shape (points,).

        Beyond the nearest of them a root's power series diverges. Found on first use: the resultant takes longer than
        a pole. NumericalError if it leaves the range of float64.
        """
        z = polyroots(np.trim_zeros(_floats(self.method, branch_polynomial(self.method)), "b")).astype(complex)
        mu = roots_in_mu(self, z)
        slope = np.abs(polyval2d(np.broadcast_to(z, mu.shape), mu, self.table_by_z))
        flattest = np.argmin(slope, axis=0)  # of all mu with a root at this z, the one whose root is double
        met: ComplexArray = np.take_along_axis(mu, flattest[np.newaxis], axis=0)[0]
        return met[np.isfinite(met)]

    @cached_property
    def branch_points_in_z(self) -> ComplexArray:
        """Every z at which two roots mu of pi(z, .) meet, or one is infinite; shape (points,), none for a multistep.

        Multistep: mu = rho / sigma has one value. One step, z = R(mu): R at the zeros of R'. PECE, a quadratic in mu:
        the zeros of its discriminant and of its leading coefficient.
        """
        if self.table.shape[1] == 2:
            return np.zeros(0, complex)
        if self.steps == 1:
            growth = -self.table[0] / self.table[1, 0]
            with np.errstate(all="ignore"):
                values = polyval(polyroots(polyder(growth)).astype(complex), growth)
            return np.asarray(values[np.isfinite(values)], complex)
        constant, linear, quadratic = self.table.T
        discriminant = polysub(polymul(linear, linear), 4 * polymul(constant, quadratic))
        zeros = [np.zeros(0)]
        for polynomial in (discriminant, quadratic):
            trimmed = np.trim_zeros(polynomial, "b")
            if len(trimmed) > 1:
                zeros.append(polyroots(trimmed))
        return np.concatenate(zeros).astype(complex)


@cache
def pencil_of(method: Method) -> Pencil:
    """Return the pencil of a method; NumericalError if its coefficients leave the range of float64."""
    table = _floats(method, coefficient_table(method))
    feedback = feedback_matrix(method)
    to_feedback = _floats(method, feedback)
    return Pencil(
        method=method,
        steps=len(table) - 1,
        table=table,
        table_by_z=np.asarray(polyder(table, axis=0), float),
        table_by_mu=np.asarray(polyder(table, axis=1), float),
        feedback=feedback,
        to_feedback=to_feedback,
        to_user=np.asarray(np.linalg.inv(to_feedback), float),
    )


def _floats(method: Method, exact: Sequence[Fraction | Sequence[Fraction]]) -> FloatArray:
    """Return exact coefficients as float64: the one place where they become so."""
    try:
        return np.array(exact, float)
    except OverflowError:
        raise NumericalError(f"{method.name}: products of its coefficients leave the range of float64") from None


def roots_in_z(pencil: Pencil, mu: ComplexArray) -> ComplexArray:
    """Return all z with pi(z, mu) = 0; complex, shape (steps, mu.size) for a row of mu, dimensionless.

    NumericalError if one leaves the range of float64.
    """
    z = roots_of_table(pencil.table, mu)
    finite = np.isfinite(z).all(axis=0)
    if not finite.all():
        worst = mu[~finite][0]
        raise NumericalError(f"{pencil.method.name}: at mu = {worst:.6g} a pole leaves the range of float64")
    return z


def roots_in_mu(pencil: Pencil, z: ComplexArray) -> ComplexArray:
    """Return all mu with pi(z, mu) = 0, the locus of a root at z; shape (degree of pi in mu, z.size) for a row of z.

    Not finite where one of them is at infinity.
    """
    return roots_of_table(pencil.table.T, z)
