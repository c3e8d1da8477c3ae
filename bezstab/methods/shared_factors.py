"""Factors that rho and sigma share: roots that pi(z, mu) has for every mu, poles that no feedback moves."""

from fractions import Fraction
from functools import cache

import sympy as sp

from bezstab.methods.derivation import Z, coefficient_table
from bezstab.methods.schemes import LinearMultistep, Method, PredictorCorrector, Scheme
from bezstab.methods.schur import polynomial_gcd, quotient_and_remainder

ZERO = Fraction(0)


@cache
def shared_factor(method: Method) -> tuple[Fraction, ...]:
    """Return the monic polynomial in z, descending powers, that divides pi(z, mu) for every mu; (1,) if none does.

    The greatest common divisor of the coefficients of the powers of mu, by Euclid's algorithm, exact. A root of it at
    zero, an unused past value, is left out: it never decides.
    """
    shared: list[Fraction] = []
    for column in zip(*coefficient_table(method), strict=True):
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

    They are the roots of the factor that rho and sigma share; dimensionless. None for an ordinary method.
    """
    factor = sp.Poly([sp.Rational(c.numerator, c.denominator) for c in shared_factor(method)], Z)
    poles: list[complex] = []
    if factor.degree() > 0:
        for part, _ in factor.sqf_list()[1]:  # without its multiple roots, which float64 would split
            poles += [complex(root) for root in part.nroots()]
    return tuple(sorted(poles, key=lambda pole: (-round(abs(pole), 12), -pole.real, -pole.imag)))


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
