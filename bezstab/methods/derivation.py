"""From a method's exact coefficients, by sympy: s->z mapping, closed-loop polynomial, order of accuracy.

With y' = lambda y and mu = h lambda every method becomes a polynomial pi(z, mu) = 0. Feedback asks for
mu^2 + alpha_hat mu + beta_hat = 0. Eliminating mu from the two by a resultant gives P(z; alpha_hat, beta_hat).
"""

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement, count
from math import factorial, prod

import sympy as sp

from bezstab.methods.registry import Coefficients, LinearMultistep, Method, Partitioned, PredictorCorrector, RungeKutta

Z, MU, ALPHA_HAT, BETA_HAT, S, H = sp.symbols("z mu alpha_hat beta_hat s h")

Table = tuple[Coefficients, ...]
Tree = tuple["Tree", ...]


def _in_z(coefficients: Coefficients) -> sp.Expr:
    """Return the polynomial in z with these coefficients in descending powers."""
    return sp.Add(*(a * Z**i for i, a in enumerate(reversed(coefficients))))


def _multistep(scheme: LinearMultistep) -> sp.Expr:
    return _in_z(scheme.rho) - MU * _in_z(scheme.sigma)


@cache
def characteristic_polynomial(method: Method) -> sp.Poly:
    """Return pi(z, mu), monic in z, of one step on y' = lambda y, mu = h lambda, h the length of that step.

    Multistep: rho - mu sigma. Runge-Kutta: z - R(mu), R = 1 + mu b^T (I - mu A)^-1 1. PECE: the corrector's pi with
    the predictor's value in place of the new one. Partitioned: that of the velocity map.
    """
    match method.scheme:
        case LinearMultistep() as scheme:
            expression = _multistep(scheme)
        case PredictorCorrector(predictor, corrector):
            expression = _multistep(corrector) + corrector.sigma[0] * MU * _multistep(predictor)
        case RungeKutta(tableau, weights):
            stages: list[sp.Expr] = []
            for row in tableau:
                known = zip(row, stages, strict=False)
                stages.append(sp.expand(1 + MU * sp.Add(*(a * stage for a, stage in known))))
            expression = Z - 1 - MU * sp.Add(*(b * stage for b, stage in zip(weights, stages, strict=True)))
        case Partitioned(velocity=velocity):
            expression = _multistep(velocity)
    return sp.Poly(expression, Z, MU, domain="QQ")


@cache
def feedback_polynomial(method: Method) -> sp.Poly:
    """Return what stabilisation asks of mu: mu^2 + alpha_hat mu + beta_hat with a step of step_multiple h.

    Coefficients in QQ[alpha_hat, beta_hat]. Position and velocity maps s_1 and s_2 of a partitioned method differ:
    there it is the numerator of (h s_1)(mu + alpha_hat) + beta_hat with z eliminated by the velocity map.
    """
    position: sp.Expr = MU * (MU + ALPHA_HAT) + BETA_HAT
    if isinstance(method.scheme, Partitioned):
        rho, sigma = _in_z(method.scheme.position.rho), _in_z(method.scheme.position.sigma)
        position = sp.resultant(_multistep(method.scheme.velocity), rho * (MU + ALPHA_HAT) + BETA_HAT * sigma, Z)
    m = method.step_multiple
    scaled = position.subs({ALPHA_HAT: m * ALPHA_HAT, BETA_HAT: m**2 * BETA_HAT}, simultaneous=True)
    return sp.Poly(sp.expand(scaled), MU, domain=sp.QQ[ALPHA_HAT, BETA_HAT]).monic()


@cache
def closed_loop_polynomial(method: Method) -> sp.Poly:
    """Return P(z; alpha_hat, beta_hat) = Res_mu(pi, feedback), monic in z; the constraint error's poles are its roots.

    Paper Eq. 17 for B2; for a multistep method it is rho^2 + alpha_hat rho sigma + beta_hat sigma^2.
    """
    pi = characteristic_polynomial(method).as_expr()
    resultant = sp.resultant(feedback_polynomial(method).as_expr(), pi, MU)
    return sp.Poly(sp.expand(resultant), Z, domain=sp.QQ[ALPHA_HAT, BETA_HAT]).monic()


def closed_loop_at(method: Method, alpha_hat: Fraction, beta_hat: Fraction) -> list[Fraction]:
    """Return the exact coefficients of P(z), in descending powers, at one point.

    There the resultant is the norm A^2 - p A B + q B^2 of pi = A(z) + B(z) mu modulo the feedback mu^2 + p mu + q.
    """
    p, q = (a * alpha_hat + b * beta_hat for a, b in feedback_matrix(method))
    table = coefficient_table(method)[::-1]
    powers = [(Fraction(1), Fraction(0))]  # (u, v) with mu^j = u + v mu
    for _ in table[0][1:]:
        u, v = powers[-1]
        powers.append((-q * v, u - p * v))
    reduced = [
        [sum((c * power[i] for c, power in zip(row, powers, strict=True)), Fraction(0)) for row in table]
        for i in (0, 1)
    ]
    n = len(table)
    norm = [Fraction(0)] * (2 * n - 1)
    for i, (a, b) in enumerate(zip(*reduced, strict=True)):
        for k, (c, d) in enumerate(zip(*reduced, strict=True)):
            norm[i + k] += a * c - p * a * d + q * b * d
    return norm


def feedback_matrix(method: Method) -> Table:
    """Return the 2x2 matrix that takes (alpha_hat, beta_hat) to the coefficients of mu^1 and mu^0 in the feedback.

    The identity for most; it holds the step multiple, and for a partitioned method the difference of its two maps.
    """
    _, *coefficients = (sp.Poly(c, ALPHA_HAT, BETA_HAT) for c in feedback_polynomial(method).all_coeffs())
    return tuple(tuple(Fraction(c.coeff_monomial(x)) for x in (ALPHA_HAT, BETA_HAT)) for c in coefficients)


def coefficient_table(method: Method) -> Table:
    """Return C with pi(z, mu) = sum_kj C[k][j] z^k mu^j, exact."""
    return _table(characteristic_polynomial(method))


def branch_polynomial(method: Method) -> tuple[Fraction, ...]:
    """Return the polynomial in z, ascending, that is zero wherever two roots of pi(., mu) meet: Res_mu(pi, d pi/dz)."""
    pi = characteristic_polynomial(method)
    meeting = sp.Poly(sp.resultant(pi.as_expr(), pi.diff(Z).as_expr(), MU), Z)
    return tuple(map(Fraction, reversed(meeting.all_coeffs())))


def _table(pi: sp.Poly) -> Table:
    return tuple(
        tuple(Fraction(pi.coeff_monomial(Z**k * MU**j)) for j in range(pi.degree(MU) + 1))
        for k in range(pi.degree(Z) + 1)
    )


def mapping_equations(method: Method) -> list[sp.Equality]:
    """Return the s->z mapping as equations between s and z (paper Eq. 14, Table 1); h is the user's step.

    One equation solved for s for a multistep method, for z for a Runge-Kutta method, left implicit for PECE, and two
    (position, then velocity) for a partitioned method.
    """
    h = method.step_multiple * H

    def solved(scheme: LinearMultistep) -> sp.Equality:
        scale, numerator = sp.factor(_in_z(scheme.rho)).as_content_primitive()
        unit, denominator = _in_z(scheme.sigma).as_content_primitive()
        return sp.Eq(S, scale / unit * numerator / (h * denominator))

    match method.scheme:
        case LinearMultistep() as scheme:
            return [solved(scheme)]
        case Partitioned(position, velocity):
            return [solved(position), solved(velocity)]
        case RungeKutta():
            return [sp.Eq(Z, (Z - characteristic_polynomial(method).as_expr()).subs(MU, h * S))]
        case PredictorCorrector():
            pi = sp.collect(sp.expand(characteristic_polynomial(method).as_expr()), MU, sp.factor)
            return [sp.Eq(pi.subs(MU, h * S), 0)]


def accuracy(method: Method) -> tuple[int, Fraction]:
    """Return the order of accuracy p and the error constant, both from the coefficients alone.

    The error constant is the coefficient of mu^(p+1) in the local error on y' = lambda y, divided by sigma(1)
    (Hairer, Norsett & Wanner I, Eq. III.2.13). A Runge-Kutta method's p is that of its rooted-tree conditions, which
    nonlinear right-hand sides need (ibid., Theorem II.2.13); a partitioned method has the worse of its two maps.
    """
    match method.scheme:
        case RungeKutta() as scheme:
            p = _runge_kutta_order(scheme)
            return p, _local_error(coefficient_table(method), p + 1)
        case Partitioned(position, velocity):
            errors = [_leading_error(_table(sp.Poly(_multistep(scheme), Z, MU))) for scheme in (velocity, position)]
            return min(errors, key=lambda error: (error[0], -abs(error[1])))
        case LinearMultistep() | PredictorCorrector():
            return _leading_error(coefficient_table(method))


def _local_error(table: Table, power: int) -> Fraction:
    """Return the coefficient of mu^power in pi(e^mu, mu) / (d pi/dz)(1, 0)."""
    slope = sum((k * row[0] for k, row in enumerate(table)), Fraction(0))
    terms = (
        c * Fraction(k ** (power - j), factorial(power - j))
        for k, row in enumerate(table)
        for j, c in enumerate(row[: power + 1])
    )
    return sum(terms, Fraction(0)) / slope


def _leading_error(table: Table) -> tuple[int, Fraction]:
    errors = ((p, _local_error(table, p + 1)) for p in count())
    return next((p, error) for p, error in errors if error)


def _trees(order: int) -> Iterator[Tree]:
    """Yield the rooted trees with `order` vertices, each as the sorted tuple of its root's subtrees."""

    def forests(vertices: int, largest: int) -> Iterator[Tree]:
        if vertices == 0:
            yield ()
        for size in range(min(vertices, largest), 0, -1):
            for copies in range(1, vertices // size + 1):
                for chosen in combinations_with_replacement(list(_trees(size)), copies):
                    yield from (chosen + rest for rest in forests(vertices - size * copies, size - 1))

    yield from forests(order - 1, order - 1)


def _vertices(tree: Tree) -> int:
    return 1 + sum(map(_vertices, tree))


def _density(tree: Tree) -> int:
    """Return gamma(t): the product over the vertices of the size of the subtree each is root of."""
    return _vertices(tree) * prod(map(_density, tree))


def _runge_kutta_order(scheme: RungeKutta) -> int:
    """Return the largest p with sum_i b_i Phi_i(t) = 1 / gamma(t) for every rooted tree t of up to p vertices."""

    def stage_weights(tree: Tree) -> list[Fraction]:
        children = [stage_weights(child) for child in tree]
        summed = [
            [sum((a * g for a, g in zip(row, child, strict=True)), Fraction(0)) for row in scheme.tableau]
            for child in children
        ]
        return [prod((child[i] for child in summed), start=Fraction(1)) for i in range(len(scheme.weights))]

    def satisfied(tree: Tree) -> bool:
        total = sum((b * g for b, g in zip(scheme.weights, stage_weights(tree), strict=True)), Fraction(0))
        return total * _density(tree) == 1

    return next(p for p in count(1) if not all(map(satisfied, _trees(p + 1))))
