"""From a method's exact coefficients, by sympy: characteristic polynomial, closed-loop polynomial, s->z mapping.

With y' = lambda y and mu = h lambda every method becomes a polynomial pi(z, mu) = 0. Feedback asks for
mu^2 + alpha_hat mu + beta_hat = 0. Eliminating mu from the two by a resultant gives P(z; alpha_hat, beta_hat).
"""

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from math import lcm
from operator import mul

import sympy as sp
from sympy.polys.matrices import DomainMatrix
from sympy.polys.rings import PolyElement, ring

from bezstab.methods.schemes import (
    ONE,
    ZERO,
    Coefficients,
    LinearMultistep,
    Method,
    PredictorCorrector,
    RungeKutta,
)
from bezstab.methods.second_order import PlaneTable, SecondOrder
from bezstab.rationals import whole_multiples

Z, MU, ALPHA_HAT, BETA_HAT, S, H = sp.symbols("z mu alpha_hat beta_hat s h")

RING, RING_Z, RING_MU, RING_ALPHA, RING_BETA = ring("z, mu, alpha_hat, beta_hat", sp.QQ)
"""Exact polynomials by their coefficients: sums of sympy's symbols would do, but take a tenth of a second to begin."""

Table = tuple[Coefficients, ...]


def _in_z(coefficients: Coefficients) -> PolyElement:
    """Return the polynomial in z with these coefficients in descending powers."""
    polynomial = RING.zero
    for a in coefficients:
        polynomial = polynomial * RING_Z + _in_ring(a)
    return polynomial


def _in_ring(a: Fraction) -> PolyElement:
    return RING.ground_new(sp.QQ(a.numerator, a.denominator))


def multistep_polynomial(scheme: LinearMultistep) -> PolyElement:
    """Return rho(z) - mu sigma(z)."""
    return _in_z(scheme.rho) - RING_MU * _in_z(scheme.sigma)


@cache
def characteristic_polynomial(method: Method) -> sp.Poly:
    """Return pi(z, mu) of one step on y' = lambda y, mu = h lambda, h the length of that step.

    Multistep: rho - mu sigma. Runge-Kutta: z - R(mu), R = 1 + mu b^T (I - mu A)^-1 1, times det(I - mu A), which is one
    for an explicit method. PECE: the corrector's pi with the predictor's value in place of the new one. Monic in z for
    mu = 0; for every mu unless implicit.
    TypeError for a second-order scheme, which treats position and velocity differently and has no mu.
    """
    match method.scheme:
        case LinearMultistep() as scheme:
            pi = multistep_polynomial(scheme)
        case PredictorCorrector(predictor, corrector):
            new_weight = _in_ring(corrector.sigma[0])
            pi = multistep_polynomial(corrector) + new_weight * RING_MU * multistep_polynomial(predictor)
        case RungeKutta(tableau, weights):
            # det(I - mu A + mu 1 b^T) / det(I - mu A) = R(mu) (Hairer & Wanner II, Proposition IV.3.2)
            less_weights = [[a - b for a, b in zip(row, weights, strict=True)] for row in tableau]
            above, below = _determinant_less_mu_times(less_weights), _determinant_less_mu_times(tableau)
            unused = above.gcd(below)  # a factor of stages that the step does not depend on
            unused = unused.quo_ground(unused.const())
            pi = RING_Z * below.quo(unused) - above.quo(unused)
        case SecondOrder():
            raise TypeError(f"{method.name}: a second-order scheme has no pi(z, mu)")
    return sp.Poly.from_dict({(k, j): c for (k, j, _, _), c in pi.items()}, Z, MU, domain=sp.QQ)


def _determinant_less_mu_times(matrix: Sequence[Sequence[Fraction]]) -> PolyElement:
    """Return det(I - mu M), the characteristic polynomial of M backwards."""
    size = len(matrix)
    rows = [[sp.QQ(c.numerator, c.denominator) for c in row] for row in matrix]
    coefficients = DomainMatrix(rows, (size, size), sp.QQ).charpoly()
    return RING.from_dict({(0, k, 0, 0): c for k, c in enumerate(coefficients) if c})


@cache
def closed_loop_polynomial(method: Method) -> sp.Poly:
    """Return P(z; alpha_hat, beta_hat); the constraint error's poles are its roots.

    P = Res_mu(pi, feedback) is zero exactly at those z for which some mu satisfies both: in other words it is, up to a
    factor, the product of pi(z, mu) over the two mu that the feedback asks for. Paper Eq. 17 for B2; for a multistep
    method it is rho^2 + alpha_hat rho sigma + beta_hat sigma^2. For a second-order scheme it is the determinant of its
    equations. Monic in z for an explicit method; else its leading coefficient is one at alpha_hat = beta_hat = 0.
    """
    if isinstance(method.scheme, SecondOrder):
        return sp.Poly(_expression_of(closed_loop_table(method)), Z, domain=sp.QQ[ALPHA_HAT, BETA_HAT])
    return _over_the_plane(_closed_loop(method), variable=0, symbol=Z)


@cache
def _closed_loop(method: Method) -> PolyElement:
    """Return P of a method with mu as `closed_loop_at` does, for all parameters at a time."""
    (p_alpha, p_beta), (q_alpha, q_beta) = feedback_matrix(method)
    p = _in_ring(p_alpha) * RING_ALPHA + _in_ring(p_beta) * RING_BETA
    q = _in_ring(q_alpha) * RING_ALPHA + _in_ring(q_beta) * RING_BETA
    table = coefficient_table(method)
    A, B = RING.zero, RING.zero
    u, v = RING.one, RING.zero  # mu^j = u + v mu
    for column in zip(*table, strict=True):
        in_z = _in_z(column[::-1])
        A, B = A + in_z * u, B + in_z * v
        u, v = -q * v, u - p * v
    P = A**2 - p * A * B + q * B**2
    highest = max(k for k, *_ in P)
    return P.quo_ground(P[(highest, 0, 0, 0)])


def _over_the_plane(polynomial: PolyElement, variable: int, symbol: sp.Symbol) -> sp.Poly:
    """Return a polynomial in one of RING's first two variables over QQ[alpha_hat, beta_hat]."""
    plane = sp.QQ[ALPHA_HAT, BETA_HAT]
    by_power: dict[tuple[int], PolyElement] = {}
    for powers, c in polynomial.items():
        power = (powers[variable],)
        by_power[power] = by_power.get(power, plane.zero) + plane.ring.term_new(powers[2:], c)
    return sp.Poly.from_dict(by_power, symbol, domain=plane)


def _expression_of(table: PlaneTable) -> sp.Expr:
    return sp.Add(*(
        coefficient * Z**k * ALPHA_HAT**i * BETA_HAT**j
        for k, in_plane in enumerate(table)
        for i, in_beta in enumerate(in_plane)
        for j, coefficient in enumerate(in_beta)
    ))  # fmt: skip


@cache
def closed_loop_table(method: Method) -> PlaneTable:
    """Return C with P = sum_kij C[k][i][j] z^k alpha_hat^i beta_hat^j (paper Eq. 17), exact, in the user's parameters.

    Dimensionless; one plane for each power of z, ascending, all of one shape.
    """
    if isinstance(method.scheme, SecondOrder):
        m = method.step_multiple
        return tuple(
            tuple(tuple(c * m ** (i + 2 * j) for j, c in enumerate(row)) for i, row in enumerate(in_plane))
            for in_plane in method.scheme.table
        )
    terms = {(k, i, j): _fraction(c) for (k, _, i, j), c in _closed_loop(method).items()}
    most_z, most_alpha, most_beta = (max(powers[axis] for powers in terms) for axis in range(3))
    return tuple(
        tuple(tuple(terms.get((k, i, j), ZERO) for j in range(most_beta + 1)) for i in range(most_alpha + 1))
        for k in range(most_z + 1)
    )


def closed_loop_at(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> list[Fraction]:
    """Return the exact coefficients of P(z), in descending powers, at one point.

    The same as `closed_loop_polynomial` there, up to a factor, without the cost of a symbolic resultant. The first is
    zero where a root is infinite: there an implicit step has no solution.
    """
    if isinstance(method.scheme, SecondOrder):
        planes, scale_of_planes = _whole_planes(method)
        alpha_powers = _whole_powers(alpha_hat, len(planes[0]) - 1)
        beta_powers = _whole_powers(beta_hat, len(planes[0][0]) - 1)
        scale = scale_of_planes * alpha_powers[0] * beta_powers[0]
        return [
            Fraction(
                sum(a * sum(map(mul, row, beta_powers)) for a, row in zip(alpha_powers, in_plane, strict=True)), scale
            )
            for in_plane in planes
        ]
    # The feedback is mu^2 + p mu + q = 0 with roots mu_1, mu_2. Modulo it every power of mu is u + v mu, hence
    # pi = A(z) + B(z) mu at either root, and P is the product of the two (the norm of pi):
    #     (A + B mu_1) (A + B mu_2) = A^2 - p A B + q B^2,   as mu_1 + mu_2 = -p and mu_1 mu_2 = q.
    (p_alpha, p_beta), (q_alpha, q_beta) = feedback_matrix(method)
    p = p_alpha * alpha_hat + p_beta * beta_hat
    q = q_alpha * alpha_hat + q_beta * beta_hat
    rows, scale_of_rows = _whole_rows(method)
    powers, scale_of_powers = whole_multiples(
        [part for power in _reduced_powers(p, q, len(rows[0]) - 1) for part in power]
    )
    A = [sum(c * u for c, u in zip(row, powers[::2], strict=True)) for row in rows]
    B = [sum(c * v for c, v in zip(row, powers[1::2], strict=True)) for row in rows]
    (on_AA, on_AB, on_BB), scale_of_feedback = whole_multiples([ONE, -p, q])
    scale = scale_of_feedback * (scale_of_rows * scale_of_powers) ** 2
    terms = zip(_product(A, A), _product(A, B), _product(B, B), strict=True)
    return [Fraction(on_AA * aa + on_AB * ab + on_BB * bb, scale) for aa, ab, bb in terms]


@cache
def _whole_planes(method: Method) -> tuple[list[list[list[int]]], int]:
    """Return a multiple of the closed loop's table that is whole, by descending powers of z, and the factor."""
    descending = closed_loop_table(method)[::-1]
    scale = lcm(*(c.denominator for in_plane in descending for row in in_plane for c in row))
    return [[[int(c * scale) for c in row] for row in in_plane] for in_plane in descending], scale


def _whole_powers(number: Fraction, most: int) -> list[int]:
    """Return d^most number^k for k = 0 to `most`, d its denominator: whole numbers, whose sums are fast."""
    return [number.numerator**k * number.denominator ** (most - k) for k in range(most + 1)]


@cache
def _whole_rows(method: Method) -> tuple[list[list[int]], int]:
    """Return a multiple of the coefficient table that is whole, its rows by descending powers of z, and the factor."""
    descending = coefficient_table(method)[::-1]
    width = len(descending[0])
    whole, scale = whole_multiples([c for row in descending for c in row])
    return [whole[start : start + width] for start in range(0, len(whole), width)], scale


def _reduced_powers(p: Fraction, q: Fraction, highest: int) -> list[tuple[Fraction, Fraction]]:
    """Return (u, v) with mu^j = u + v mu wherever mu^2 + p mu + q = 0, for j = 0 to `highest`."""
    powers = [(ONE, ZERO)]
    for _ in range(highest):
        u, v = powers[-1]
        powers.append((-q * v, u - p * v))  # mu (u + v mu) = u mu + v (-p mu - q)
    return powers


def _product(first: list[int], second: list[int]) -> list[int]:
    """Return the coefficients of the product of two polynomials."""
    product = [0] * (len(first) + len(second) - 1)
    for i, a in enumerate(first):
        for k, b in enumerate(second):
            product[i + k] += a * b
    return product


def feedback_matrix(method: Method) -> Table:
    """Return the 2x2 matrix that takes (alpha_hat, beta_hat) to the coefficients of mu^1 and mu^0 in the feedback.

    mu^2 + alpha_hat mu + beta_hat = 0 for a step of h, so that the parameters of the method's own step stand in it.
    """
    return (method.step_multiple, ZERO), (ZERO, method.step_multiple**2)


@cache
def coefficient_table(method: Method) -> Table:
    """Return C with pi(z, mu) = sum_kj C[k][j] z^k mu^j, exact; steps + 1 rows, one column for each power of mu.

    TypeError for a second-order scheme, as `characteristic_polynomial`.
    """
    return table_of(characteristic_polynomial(method))


def table_of(pi: sp.Poly) -> Table:
    """Return the coefficients of a polynomial in z and mu: C[k][j] belongs to z^k mu^j."""
    terms = pi.rep.to_dict()
    return tuple(
        tuple(_fraction(terms.get((k, j), 0)) for j in range(pi.degree(MU) + 1)) for k in range(pi.degree(Z) + 1)
    )


def _fraction(c: sp.Rational) -> Fraction:
    return Fraction(int(c.numerator), int(c.denominator))


def branch_polynomial(method: Method) -> tuple[Fraction, ...]:
    """Return the polynomial in z, ascending, that is zero wherever two roots of pi(., mu) meet: Res_mu(pi, d pi/dz).

    Exact. TypeError for a second-order scheme, as `characteristic_polynomial`.
    """
    if len(coefficient_table(method)[0]) == 2:  # pi = A + mu B: the resultant is A B' - A' B
        A, B = (sp.Poly(list(reversed(c)), Z, domain=sp.QQ) for c in zip(*coefficient_table(method), strict=True))
        meeting = A * B.diff(Z) - A.diff(Z) * B
        return tuple(_fraction(c) for c in reversed(meeting.rep.to_list()))
    pi = characteristic_polynomial(method).reorder(MU, Z)  # its first symbol is the one that is eliminated
    meeting = pi.resultant(pi.diff(Z))
    return tuple(_fraction(c) for c in reversed(meeting.rep.to_list()))


def mapping_equations(method: Method) -> list[sp.Equality]:
    """Return the s->z mapping as equations between s and z (paper Eq. 14, Table 1); h is the user's step.

    One equation solved for s for a multistep method, for z for a Runge-Kutta method, left implicit for PECE; none for a
    second-order scheme, which has no such mapping.
    """
    h = method.step_multiple * H
    match method.scheme:
        case LinearMultistep() as scheme:
            return [_solved_for_s(scheme, h)]
        case RungeKutta():
            pi = sp.Poly(characteristic_polynomial(method).as_expr(), Z)
            growth = -pi.nth(0) / pi.nth(1)
            return [sp.Eq(Z, growth.subs(MU, h * S))]
        case SecondOrder():
            return []
        case PredictorCorrector():
            pi = sp.collect(sp.expand(characteristic_polynomial(method).as_expr()), MU, sp.factor)
            return [sp.Eq(pi.subs(MU, h * S), 0)]


def _solved_for_s(scheme: LinearMultistep, h: sp.Expr) -> sp.Equality:
    """Return s = rho / (h sigma), rho factored, and whole numbers but for one factor in front (as the paper prints)."""
    rho_factor, numerator = sp.factor(_in_z(scheme.rho).as_expr()).as_content_primitive()
    sigma_factor, denominator = _in_z(scheme.sigma).as_expr().as_content_primitive()
    return sp.Eq(S, rho_factor / sigma_factor * numerator / (h * denominator))
