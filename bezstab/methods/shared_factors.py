"""Factors that rho and sigma share: roots that pi(z, mu) has for every mu, poles that no feedback moves.

Of a second-order scheme: roots that P(z; alpha_hat, beta_hat) has for every alpha_hat and beta_hat.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache, reduce

import sympy as sp

from bezstab.methods.derivation import Z, closed_loop_table
from bezstab.methods.polynomials import PlaneTable, polynomial_gcd, quotient_and_remainder
from bezstab.methods.schemes import LinearMultistep, Method


@cache
def shared_factor(method: Method) -> tuple[Fraction, ...]:
    """Return the monic polynomial in z that divides pi(z, mu) for every mu; (1,) if none does.

    For a second-order scheme: that divides P(z; alpha_hat, beta_hat) for every alpha_hat and beta_hat. The greatest
    common divisor of the coefficients of the powers of mu, or of those of alpha_hat and beta_hat, by Euclid's
    algorithm, exact. A root of it at zero, an unused past value, is left out: it never decides.
    """
    scheme = method.scheme
    coefficients = scheme.mu_table or [[c for row in in_plane for c in row] for in_plane in scheme.second_order.table]
    shared: list[Fraction] = reduce(polynomial_gcd, filter(any, zip(*coefficients, strict=True)), [])
    while len(shared) > 1 and shared[0] == 0:
        del shared[0]
    return tuple(shared)


@cache
def reduced_table(method: Method) -> PlaneTable:
    """Return `closed_loop_table` with the factor cancelled that all its coefficients share: without the fixed poles.

    Exact, of the same layout; dimensionless.
    """
    method = without_shared_factor(method)
    table, factor = closed_loop_table(method), shared_factor(method)
    if len(factor) == 1:
        return table
    quotients = [
        [quotient_and_remainder([in_plane[i][j] for in_plane in table], factor)[0] for j in range(len(table[0][i]))]
        for i in range(len(table[0]))
    ]
    degree = len(table) - len(factor)
    return tuple(tuple(tuple(quotient[k] for quotient in in_beta) for in_beta in quotients) for k in range(degree + 1))


@cache
def fixed_poles(method: Method) -> tuple[complex, ...]:
    """Return the different poles other than zero that no feedback moves, the largest first.

    They are the roots of the factor that rho and sigma share, each at least a double pole, or that all coefficients of
    a second-order scheme's P share; dimensionless. None for an ordinary method.
    """
    factor = sp.Poly(shared_factor(method)[::-1], Z, domain=sp.QQ)
    poles = map(complex, factor.sqf_part().nroots())  # without its multiple roots, which float64 would split
    return tuple(sorted(poles, key=lambda pole: (-round(abs(pole), 12), -pole.real, -pole.imag)))


@cache
def without_shared_factor(method: Method) -> Method:
    """Return the method with the shared factor cancelled: the same poles but for the fixed ones.

    Only a linear multistep method is written with factors that all of pi share. A second-order scheme's equations stay
    as they are: it is returned unchanged, and what is cancelled is in `reduced_table`.
    """
    scheme, factor = method.scheme, shared_factor(method)
    if len(factor) == 1 or not isinstance(scheme, LinearMultistep):
        return method
    rho, sigma = (quotient_and_remainder(part[::-1], factor)[0][::-1] for part in (scheme.rho, scheme.sigma))
    return replace(method, scheme=LinearMultistep(tuple(rho), tuple(sigma)))
