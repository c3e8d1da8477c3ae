"""Factors that rho and sigma share: roots that pi(z, mu) has for every mu, poles that no feedback moves."""

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

    The greatest common divisor of the coefficients of the powers of mu, by Euclid's algorithm, exact; of a second-order
    scheme, of those of P's powers of alpha_hat and beta_hat. A root of it at zero, an unused past value, is left out:
    it never decides.
    """
    if isinstance(method.scheme, SecondOrder):
        columns = zip(*([c for row in in_plane for c in row] for in_plane in closed_loop_table(method)), strict=True)
    else:
        columns = zip(*coefficient_table(method), strict=True)
    shared: list[Fraction] = []
    for column in columns:
        descending = list(column)[::-1]
        if any(descending):
            shared = polynomial_gcd(shared, descending) if shared else descending
    shared = polynomial_gcd(shared, [ZERO])
    while len(shared) > 1 and shared[-1] == 0:
        shared.pop()
    return tuple(shared)


@cache
def fixed_poles(method: Method) -> tuple[complex, ...]:
    """Return the different poles other than zero that no feedback moves, the largest first; each is at least double.

    They are the roots of the factor that rho and sigma share; dimensionless. None for an ordinary method. (In P of a
    second-order scheme such a root need not be double.)
    """
    factor = sp.Poly([sp.Rational(c.numerator, c.denominator) for c in shared_factor(method)], Z)
    poles: list[complex] = []
    if factor.degree() > 0:
        for part, _ in factor.sqf_list()[1]:  # without its multiple roots, which float64 would split
            poles += [complex(root) for root in part.nroots()]
    return tuple(sorted(poles, key=lambda pole: (-round(abs(pole), 12), -pole.real, -pole.imag)))


@cache
def free_table(method: Method) -> PlaneTable:
    """Return P of a second-order scheme without the factor that no parameters move; as closed_loop_table has it."""
    table = closed_loop_table(method)
    factor = shared_factor(method)
    if len(factor) == 1:
        return table
    quotients = [
        [quotient_and_remainder([in_plane[i][j] for in_plane in reversed(table)], factor)[0] for j in range(len(row))]
        for i, row in enumerate(table[0])
    ]
    degree = len(table) - len(factor)
    return tuple(tuple(tuple(q[degree - k] for q in row) for row in quotients) for k in range(degree + 1))


@cache
def without_shared_factor(method: Method) -> Method:
    """Return the method with the shared factor cancelled: the same poles but for the fixed ones."""
    factor = shared_factor(method)
    if len(factor) == 1:
        return method
    scheme: Scheme = method.scheme
    match method.scheme:
        case LinearMultistep() as multistep:
            scheme = _cancelled(multistep, factor)
        case PredictorCorrector(predictor, corrector):
            scheme = PredictorCorrector(_cancelled(predictor, factor), _cancelled(corrector, factor))
    return Method(method.name, scheme, method.source, method.step_multiple, method.family)


def _cancelled(scheme: LinearMultistep, factor: tuple[Fraction, ...]) -> LinearMultistep:
    """Return a scheme with rho and sigma divided by a factor of both."""
    quotients = []
    for polynomial in (scheme.rho, scheme.sigma):
        leading_zeros = next(i for i, coefficient in enumerate(polynomial) if coefficient)
        quotient, _ = quotient_and_remainder(polynomial[leading_zeros:], factor)
        quotients.append((*[ZERO] * leading_zeros, *quotient))
    rho, sigma = quotients
    return LinearMultistep(rho, sigma)
