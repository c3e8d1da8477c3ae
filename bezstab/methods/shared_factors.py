"""Factors that rho and sigma share: roots that pi(z, mu) has for every mu, poles that no feedback moves.

Of a second-order scheme: roots that P(z; alpha_hat, beta_hat) has for every alpha_hat and beta_hat.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import sympy as sp

from bezstab.methods.derivation import Z, closed_loop_table, coefficient_table
from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, Scheme
from bezstab.methods.schur import polynomial_gcd, quotient_and_remainder
from bezstab.methods.second_order import PlaneTable, SecondOrder

ZERO = Fraction(0)


@cache
def shared_factor(method: Method) -> tuple[Fraction, ...]:
    """Return the monic polynomial in z, descending powers, that divides pi(z, mu) for every mu; (1,) if none does.

    For a second-order scheme: that divides P(z; alpha_hat, beta_hat) for every alpha_hat and beta_hat. The greatest
    common divisor of the coefficients of the powers of mu, or of those of alpha_hat and beta_hat, by Euclid's
    algorithm, exact. A root of it at zero, an unused past value, is left out: it never decides.
    """
    shared: list[Fraction] = []
    for ascending in _coefficients_in_z(method):
        descending = ascending[::-1]
        if any(descending):
            shared = polynomial_gcd(shared, descending) if shared else descending
    shared = polynomial_gcd(shared, [ZERO])
    while len(shared) > 1 and shared[-1] == 0:
        shared.pop()
    return tuple(shared)


def _coefficients_in_z(method: Method) -> list[list[Fraction]]:
    """Return the polynomials in z, ascending powers, that the powers of mu, or of the parameters, are multiplied by."""
    if isinstance(method.scheme, SecondOrder):
        by_power = [[c for row in in_plane for c in row] for in_plane in closed_loop_table(method)]
    else:
        by_power = [list(row) for row in coefficient_table(method)]
    return [list(column) for column in zip(*by_power, strict=True)]


@cache
def reduced_table(method: Method) -> PlaneTable:
    """Return `closed_loop_table` with the factor cancelled that all its coefficients share: without the fixed poles.

    Exact, of the same layout; dimensionless.
    """
    table = closed_loop_table(method)
    factor = shared_factor(method) if isinstance(method.scheme, SecondOrder) else (Fraction(1),)
    if len(factor) == 1:
        return table
    quotients = [
        [
            quotient_and_remainder([in_plane[i][j] for in_plane in reversed(table)], factor)[0][::-1]
            for j in range(len(table[0][i]))
        ]
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
    factor = sp.Poly([sp.Rational(c.numerator, c.denominator) for c in shared_factor(method)], Z)
    poles: list[complex] = []
    if factor.degree() > 0:
        for part, _ in factor.sqf_list()[1]:  # without its multiple roots, which float64 would split
            poles += [complex(root) for root in part.nroots()]
    return tuple(sorted(poles, key=lambda pole: (-round(abs(pole), 12), -pole.real, -pole.imag)))


@cache
def without_shared_factor(method: Method) -> Method:
    """Return the method with the shared factor cancelled: the same poles but for the fixed ones.

    A second-order scheme's equations stay as they are: it is returned unchanged, and what is cancelled is in
    `reduced_table`.
    """
    factor = shared_factor(method)
    if len(factor) == 1 or isinstance(method.scheme, SecondOrder):
        return method
    scheme: Scheme = method.scheme
    match method.scheme:
        case LinearMultistep() as multistep:
            scheme = _cancelled(multistep, factor)
        case PredictorCorrector(predictor, corrector):
            scheme = PredictorCorrector(_cancelled(predictor, factor), _cancelled(corrector, factor))
    return replace(method, scheme=scheme)


def _cancelled(scheme: LinearMultistep, factor: tuple[Fraction, ...]) -> LinearMultistep:
    """Return a scheme with rho and sigma divided by a factor of both."""
    quotients = []
    for polynomial in (scheme.rho, scheme.sigma):
        leading_zeros = next(i for i, coefficient in enumerate(polynomial) if coefficient)
        quotient, _ = quotient_and_remainder(polynomial[leading_zeros:], factor)
        quotients.append((*[ZERO] * leading_zeros, *quotient))
    rho, sigma = quotients
    return LinearMultistep(rho, sigma)
