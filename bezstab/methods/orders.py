"""Order of accuracy and error constant, from a method's exact coefficients."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import count
from math import comb, factorial
from operator import mul

import numpy as np

from bezstab.methods.determinants import ExactArray, responses
from bezstab.methods.polynomials import Polynomial
from bezstab.methods.schemes import Coefficients, Method, RungeKutta
from bezstab.methods.second_order import SecondOrder
from bezstab.rationals import ONE, ZERO

Accuracy = tuple[int, Fraction]
"""Order of accuracy and error constant."""


def accuracy(method: Method) -> Accuracy:
    """Return the order of accuracy p and the error constant, both from the coefficients alone.

    The error constant is the coefficient of mu^(p+1) in the local error on y' = lambda y, divided by sigma(1)
    (Hairer, Norsett & Wanner I, Eq. III.2.13). A Runge-Kutta method's p is that of its rooted-tree conditions, which
    nonlinear right-hand sides need (ibid., Theorem II.2.13). Where rationals stand for irrational coefficients,
    a condition holds if it does to all but two of their digits.

    A second-order scheme's p is that of linear motions under forces of position and of velocity: symplectic
    compositions, whose kicks see an old velocity, have order one however many kicks they have, and what they reach
    without such forces is in `accuracy_by_force`, whose worse part the constant is.
    """
    by_force = accuracy_by_force(method)
    return _order(method, _any_force), min((by_force.position, by_force.velocity), key=_goodness)[1]


def _goodness(error: Accuracy) -> tuple[int, Fraction, Fraction]:
    """Return what is less for the worse of two; of two that differ in sign alone the positive one is shown."""
    order, constant = error
    return order, -abs(constant), -constant


@dataclass(frozen=True)
class ForceAccuracy:
    """Order of accuracy and error constant where forces depend on the position alone, and on the velocity alone."""

    position: Accuracy
    velocity: Accuracy


def accuracy_by_force(method: Method) -> ForceAccuracy:
    """Return order and error constant on x'' = -b x and on v' = -a v: of what the feedback's beta and alpha do.

    Two things err: z, whose error grows from step to step, and the ratio of v to x at that z, whose error does not. The
    order is that of the worse, over the exact motions e^(mu t); the constant is c where z = e^mu - c mu^(p+1) + ...,
    as for `accuracy`, or v = mu (1 + c mu^p + ...) x if that is what errs. Where position and velocity are stepped
    alike both are what `accuracy` returns.
    """
    return ForceAccuracy(
        position=_error_under(method, _force_of_position), velocity=_error_under(method, _force_of_velocity)
    )


def _any_force(left_over: Polynomial) -> Fraction:
    """Return the largest coefficient."""
    return max(map(abs, left_over))


def _force_of_position(left_over: Polynomial) -> Fraction:
    """Return the coefficient of mu^n where alpha_hat = 0: mu^2 = -beta_hat."""
    return left_over[0]


def _force_of_velocity(left_over: Polynomial) -> Fraction:
    """Return the coefficient of mu^n where beta_hat = 0: mu = -alpha_hat."""
    return sum((c * (-1) ** i for i, c in enumerate(left_over)), ZERO)


Force = Callable[[Polynomial], Fraction]


def _order(method: Method, force: Force) -> int:
    """Return the largest p such that nothing is left over of one kind of force up to mu^p, relative to mu."""
    return next(p for p in count() if any(abs(force(each)) > method.rounding for each in _left_over(method, p + 1)))


def _left_over(method: Method, power: int) -> Iterator[Polynomial]:
    """Yield what linear motions leave over, then nonlinear ones of a Runge-Kutta method: one for each rooted tree."""
    yield from left_over(method.scheme.second_order, power)
    if isinstance(method.scheme, RungeKutta):
        for error in tree_errors(method.scheme.tableau, method.scheme.weights, power):
            yield (error,)


def _error_under(method: Method, force: Force) -> Accuracy:
    """Return order and constant for one kind of force."""
    p = _order(method, force)
    growth, ratio = map(force, left_over(method.scheme.second_order, p + 1))
    if abs(growth) > method.rounding:
        # P(e^mu) = (e^mu - z) (mu - mu_2) ... is so much, mu_2 the other root: -mu, or 0 without a force of position
        return p, growth / (2 if force is _force_of_position else 1)
    return p, ratio


def left_over(scheme: SecondOrder, power: int) -> Iterator[Polynomial]:
    """Yield what an exact motion leaves over in P, of degree power + 1, and in v - mu x, of degree `power`.

    The one is relative to the roots that stay, the other to x. Entry i of each belongs to mu^(n - i) alpha_hat^i,
    beta_hat = -mu (alpha_hat + mu).
    """
    roots_that_stay = sum(comb(k, 2) * c for k, c in enumerate(scheme.table[:, 0, 0]))  # P''(1)/2
    yield [c / roots_that_stay for c in defect(scheme.table, power + 1)]
    position, velocity = responses(scheme.equations)
    times_mu = [*defect(position, power - 1), ZERO]
    yield [(v - x) / position[:, 0, 0].sum() for v, x in zip(defect(velocity, power), times_mu, strict=True)]


def defect(table: ExactArray, degree: int) -> list[Fraction]:
    """Return what an exact motion leaves over in P: the terms of one degree in mu_1, mu_2, as a list of coefficients.

    Feedback with roots mu_1 and mu_2 has alpha_hat = -(mu_1 + mu_2) and beta_hat = mu_1 mu_2, and exact motions
    e^(mu_1 t): P(e^mu_1; alpha_hat, beta_hat) would be zero. With beta_hat = -mu_1 (alpha_hat + mu_1) it is a
    power series in mu_1 and alpha_hat; entry i of the list belongs to mu_1^(degree - i) alpha_hat^i. An order of
    accuracy p makes all terms up to degree p + 1 vanish.
    """
    left_over = [ZERO] * (degree + 1)
    for (k, i, j), coefficient in np.ndenumerate(table):
        n = degree - i - 2 * j  # the power of mu_1 that e^(k mu_1) must give
        if n >= 0 and coefficient:
            growth = coefficient * Fraction(k**n, factorial(n)) * (-1) ** j
            for shared in range(j + 1):  # mu_1^j (alpha_hat + mu_1)^j
                left_over[i + shared] += growth * comb(j, shared)
    return left_over


# The conditions of order of Runge-Kutta methods, one for each rooted tree
#
# The derivatives of y along y' = f(y) are sums of products of derivatives of f, one for each rooted tree: a vertex is
# an f, its branches are the arguments of that derivative of f (Hairer, Norsett & Wanner I, section II.2).
#
#     y'' = f' f   o        y''' = f''(f, f)   o   o     +   f' f' f   o
#                  |                            \ /                    |
#                  o                             o                     o
#                                                                      |
#                                                                      o
#
# A Runge-Kutta method's result has the same products with other factors. It is of order p if and only if they agree for
# every tree t of up to p vertices: sum_i b_i Phi_i(t) = 1 / gamma(t), where gamma(t) is the product over the
# vertices of the size of the subtree that each is the root of. Only linear problems have nothing but tall trees, which
# is why R(mu) alone does not tell the order.
#
# A tree of several vertices is a smaller one with another tree put on its root, as one more branch (Butcher's product).


def tree_errors(tableau: tuple[Coefficients, ...], weights: Coefficients, vertices: int) -> Iterator[Fraction]:
    """Yield gamma(t) sum_i b_i Phi_i(t) - 1 for the rooted trees t of so many vertices."""
    for of_stages in stage_weights(tableau, vertices):
        yield vertices * sum(map(mul, weights, of_stages)) - 1


@cache
def stage_weights(tableau: tuple[Coefficients, ...], vertices: int) -> set[Coefficients]:
    """Return psi_i(t) = gamma(t) Phi_i(t) / |t| for all stages i, for the trees t of |t| = `vertices` vertices.

    A branch t' more at the root multiplies it by |t'| sum_j a_ij psi_j(t'), as gamma(t) is |t| times those of branches.
    """
    if vertices == 1:
        return {(ONE,) * len(tableau)}
    return {
        tuple(size * psi * sum(map(mul, row, branch)) for psi, row in zip(root, tableau, strict=True))
        for size in range(1, vertices)
        for root in stage_weights(tableau, vertices - size)
        for branch in stage_weights(tableau, size)
    }
