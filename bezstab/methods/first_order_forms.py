"""Second-order schemes that spell out a multistep method or a PECE: which one, from P(z; alpha_hat, beta_hat) alone.

Where a scheme does with x and v what it does with v and a, its P is a product over the two mu that the feedback asks
for, whatever its equations look like:

    P(z; alpha_hat, beta_hat) = pi(z, mu_1) pi(z, mu_2)        mu_1 + mu_2 = -alpha_hat, mu_1 mu_2 = beta_hat

For beta_hat = 0 one mu is zero and the other -alpha_hat, and pi(z, 0) = rho(z):

    P(z; 0, 0) = rho(z)^2        P(z; alpha_hat, 0) = rho(z) pi(z, -alpha_hat)

That leaves one pi at most, by a square root and a division. Whether its product is P for every beta_hat, too, is an
identity of polynomials, and is asked as such: what has a form here has the same poles, exactly.
"""

from dataclasses import replace
from fractions import Fraction
from functools import cache

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.schemes import ONE, ZERO, LinearMultistep, Method, PredictorCorrector
from bezstab.methods.schur import quotient_and_remainder
from bezstab.methods.second_order import PlaneTable, SecondOrder

FEWEST_POLES = 4  # of two or three a formula gives the largest


def first_order_form(method: Method) -> Method:
    """Return the method with the multistep or PECE scheme that its second-order scheme spells out, of the same poles.

    The method itself if it has no second-order scheme, one that spells out no such, or one of fewer than four poles,
    for which a form is of no use. Exact. Theory: the docstring of this file.
    """
    if not isinstance(method.scheme, SecondOrder):
        return method
    return _spelled_out(method, method.scheme) or method


@cache
def _spelled_out(method: Method, scheme: SecondOrder) -> Method | None:
    candidate = _candidate(scheme.table)
    if candidate is None:
        return None
    form = replace(method, scheme=candidate)
    return form if closed_loop_table(form) == closed_loop_table(method) else None


def _candidate(table: PlaneTable) -> LinearMultistep | PredictorCorrector | None:
    """Return the only scheme that P(z; alpha_hat, 0) leaves; None if it leaves none."""
    degree = len(table) - 1
    if degree < FEWEST_POLES or degree % 2:
        return None
    by_alpha = [[in_plane[i][0] for in_plane in reversed(table)] for i in range(len(table[0]))]  # descending in z
    rho = _root_of_square(by_alpha[0])
    quotients, remainders = zip(*(quotient_and_remainder(p, rho) for p in by_alpha), strict=True)
    if any(any(remainder) for remainder in remainders):
        return None
    match quotients:
        case [_, sigma]:  # pi = rho - mu sigma
            return LinearMultistep(tuple(rho), tuple(sigma))
        case [_, linear, quadratic]:
            return _predictor_corrector(rho, linear, quadratic)
    return None


def _predictor_corrector(
    rho: list[Fraction], linear: list[Fraction], quadratic: list[Fraction]
) -> PredictorCorrector | None:
    """Return the PECE with pi = rho - mu linear + mu^2 quadratic, its predictor with the corrector's rho; None if none.

    pi = (rho - mu sigma) + b mu (rho - mu sigma_p), b = sigma[0]: a predictor with another rho has the same pi as one
    with this rho, another sigma_p and another b. As that is consistent, sigma_p(1) = rho'(1) = linear(1).
    """
    b = -sum(quadratic, ZERO) / sum(linear, ZERO)
    if quadratic[0] or not b:  # the predictor would be implicit, the corrector explicit
        return None
    sigma = [b * a + c for a, c in zip(rho, linear, strict=True)]
    predictor = LinearMultistep(tuple(rho), tuple(-c / b for c in quadratic))
    return PredictorCorrector(predictor, LinearMultistep(tuple(rho), tuple(sigma)))


def _root_of_square(square: list[Fraction]) -> list[Fraction]:
    """Return the monic polynomial whose square agrees in its upper half with a monic one; descending powers."""
    root = [ONE]
    for k in range(1, len(square) // 2 + 1):
        mixed = sum((a * b for a, b in zip(root[1:], root[:0:-1], strict=True)), ZERO)
        root.append((square[k] - mixed) / 2)
    return root
