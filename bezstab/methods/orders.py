"""Order of accuracy and error constant, from a method's exact coefficients."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations_with_replacement, count
from math import factorial, prod

from bezstab.methods.derivation import coefficient_table
from bezstab.methods.polynomials import MuTable
from bezstab.methods.schemes import Method, RungeKutta
from bezstab.methods.second_order import SecondOrder, defect
from bezstab.rationals import ONE, ZERO

Tree = tuple["Tree", ...]
"""A rooted tree: the subtrees of its root, in a fixed order. () is a single vertex, ((),) one with a leaf on it."""


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
    scheme, rounding = method.scheme, _rounding(method)
    if isinstance(scheme, RungeKutta):
        p = _runge_kutta_order(scheme, rounding)
        return p, _local_error(coefficient_table(method), p + 1)
    if method.has_mu:
        return _leading_error(coefficient_table(method))
    p = next(p for p in count() if not _is_exact(scheme.second_order, p + 1, rounding, _any_force))
    by_force = accuracy_by_force(method)
    return p, min((by_force.position, by_force.velocity), key=_goodness)[1]


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
    if method.has_mu:
        return ForceAccuracy(accuracy(method), accuracy(method))
    scheme = method.scheme.second_order
    rounding = _rounding(method)
    return ForceAccuracy(
        position=_error_under(scheme, rounding, _force_of_position),
        velocity=_error_under(scheme, rounding, _force_of_velocity),
    )


LeftOver = Sequence[Fraction]
"""What is left over on exact motions: entry i belongs to mu^(n - i) alpha_hat^i, beta_hat = -mu (alpha_hat + mu)."""


def _any_force(left_over: LeftOver) -> Fraction:
    """Return the largest coefficient."""
    return max(map(abs, left_over))


def _force_of_position(left_over: LeftOver) -> Fraction:
    """Return the coefficient of mu^n where alpha_hat = 0: mu^2 = -beta_hat."""
    return left_over[0]


def _force_of_velocity(left_over: LeftOver) -> Fraction:
    """Return the coefficient of mu^n where beta_hat = 0: mu = -alpha_hat."""
    return sum((c * (-1) ** i for i, c in enumerate(left_over)), ZERO)


Force = Callable[[LeftOver], Fraction]


def _is_exact(scheme: SecondOrder, power: int, rounding: Fraction, force: Force) -> bool:
    """Return whether neither z nor the ratio of v to x errs in mu^power, relative to one and to mu^2."""
    return abs(force(_growth_error(scheme, power))) <= rounding and abs(force(_ratio_error(scheme, power))) <= rounding


def _error_under(scheme: SecondOrder, rounding: Fraction, force: Force) -> Accuracy:
    """Return order and constant for one kind of force."""
    p = next(p for p in count() if not _is_exact(scheme, p + 1, rounding, force))
    growth, ratio = force(_growth_error(scheme, p + 1)), force(_ratio_error(scheme, p + 1))
    if abs(growth) > rounding:
        # P(e^mu) = (e^mu - z) (mu - mu_2) ... is so much, mu_2 the other root: -mu, or 0 without a force of position
        return p, growth / (2 if force is _force_of_position else 1)
    return p, ratio


def _growth_error(scheme: SecondOrder, power: int) -> LeftOver:
    """Return what e^mu leaves over in P, of degree power + 1, relative to the roots that stay."""
    at_one = sum((_second_derivative(k) * in_plane[0][0] for k, in_plane in enumerate(scheme.table)), ZERO)
    return [c / at_one for c in defect(scheme.table, power + 1)]


def _second_derivative(k: int) -> Fraction:
    """Return that of z^k at one, halved: of (z - 1)^2 R(z) it is R(1)."""
    return Fraction(k * (k - 1), 2)


def _ratio_error(scheme: SecondOrder, power: int) -> LeftOver:
    """Return v - mu x on exact motions, of degree `power`, relative to x."""
    position, velocity = scheme.responses
    at_one = sum((in_plane[0][0] for in_plane in position), ZERO)
    times_mu = [*defect(position, power - 1), ZERO]
    return [(v - x) / at_one for v, x in zip(defect(velocity, power), times_mu, strict=True)]


def _rounding(method: Method) -> Fraction:
    """Return how far an order condition may be off: not at all where the coefficients are the method's own."""
    return ZERO if method.digits is None else Fraction(100, 10**method.digits)


def _leading_error(table: MuTable) -> tuple[int, Fraction]:
    """Return p and the first coefficient of the local error that is not zero, that of mu^(p+1)."""
    p = next(p for p in count() if _local_error(table, p + 1))  # e^mu is no algebraic function of mu: there is one
    return p, _local_error(table, p + 1)


def _local_error(table: MuTable, power: int) -> Fraction:
    """Return the coefficient of mu^power in pi(e^mu, mu) / (d pi/dz)(1, 0).

    On y' = lambda y the exact solution grows by e^mu in a step: pi(e^mu, mu) is what is left when it is put into the
    method. z^k mu^j contributes c e^(k mu) mu^j, in which mu^power has the coefficient c k^(power-j) / (power-j)!.
    """
    left_over = ZERO
    slope = ZERO
    for k, row in enumerate(table):
        slope += k * row[0]
        for j, c in enumerate(row[: power + 1]):
            left_over += c * Fraction(k ** (power - j), factorial(power - j))
    return left_over / slope


# Rooted trees. The derivatives of y along y' = f(y) are sums of products of derivatives of f, one for each rooted
# tree: a vertex is an f, its branches are the arguments of that derivative of f.
#
#     y'' = f' f   o        y''' = f''(f, f)   o   o     +   f' f' f   o
#                  |                            \ /                    |
#                  o                             o                     o
#                                                                      |
#                                                                      o
#
# A Runge-Kutta method's result has the same products with other factors. It is of order p if and only if they agree
# for every tree t of up to p vertices: sum_i b_i Phi_i(t) = 1 / gamma(t). Only linear problems have nothing but tall
# trees, which is why R(mu) alone does not tell the order.


def _runge_kutta_order(scheme: RungeKutta, rounding: Fraction) -> int:
    """Return the largest p with sum_i b_i Phi_i(t) = 1 / gamma(t) for every rooted tree t of up to p vertices."""
    return next(p for p in count(1) if not all(_satisfied(scheme, tree, rounding) for tree in _trees(p + 1)))


def _satisfied(scheme: RungeKutta, tree: Tree, rounding: Fraction) -> bool:
    stage_weights = _stage_weights(scheme, tree)
    total = sum((b * phi for b, phi in zip(scheme.weights, stage_weights, strict=True)), ZERO)
    return abs(total * _density(tree) - 1) <= rounding


def _stage_weights(scheme: RungeKutta, tree: Tree) -> list[Fraction]:
    """Return Phi_i(t) for every stage i: the product over the root's subtrees t' of sum_j a_ij Phi_j(t')."""
    product = [ONE] * len(scheme.weights)
    for subtree in tree:
        inner = _stage_weights(scheme, subtree)
        for i, row in enumerate(scheme.tableau):
            product[i] *= sum((a * phi for a, phi in zip(row, inner, strict=True)), ZERO)
    return product


def _vertices(tree: Tree) -> int:
    return 1 + sum(_vertices(subtree) for subtree in tree)


def _density(tree: Tree) -> int:
    """Return gamma(t): the product over the vertices of the size of the subtree each is root of."""
    return _vertices(tree) * prod(_density(subtree) for subtree in tree)


def _trees(order: int) -> Iterator[Tree]:
    """Yield the rooted trees with `order` vertices, each once: 1, 1, 2, 4, 9, 20, ... of them."""
    yield from _forests(order - 1, order - 1)


def _forests(vertices: int, largest: int) -> Iterator[Tree]:
    """Yield the unordered collections of trees with so many vertices together, none of more than `largest`.

    Those of the largest size are chosen first, then what remains is filled with smaller ones: so each comes once.
    """
    if vertices == 0:
        yield ()
    for size in range(min(vertices, largest), 0, -1):
        for copies in range(1, vertices // size + 1):
            for chosen in combinations_with_replacement(list(_trees(size)), copies):
                for rest in _forests(vertices - size * copies, size - 1):
                    yield chosen + rest
