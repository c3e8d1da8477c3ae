"""Order of accuracy and error constant, from a method's exact coefficients."""

from collections.abc import Iterator
from fractions import Fraction
from itertools import combinations_with_replacement, count
from math import factorial, prod

import sympy as sp

from bezstab.methods.derivation import MU, Table, Z, coefficient_table, multistep_polynomial, table_of
from bezstab.methods.schemes import (
    ONE,
    ZERO,
    LinearMultistep,
    Method,
    Partitioned,
    PredictorCorrector,
    RungeKutta,
)

Tree = tuple["Tree", ...]
"""A rooted tree: the subtrees of its root, in a fixed order. () is a single vertex, ((),) one with a leaf on it."""


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
            errors = [_multistep_error(velocity), _multistep_error(position)]
            return min(errors, key=lambda error: (error[0], -abs(error[1])))
        case LinearMultistep() | PredictorCorrector():
            return _leading_error(coefficient_table(method))


def _multistep_error(scheme: LinearMultistep) -> tuple[int, Fraction]:
    return _leading_error(table_of(sp.Poly(multistep_polynomial(scheme).as_expr(), Z, MU)))


def _leading_error(table: Table) -> tuple[int, Fraction]:
    """Return p and the first coefficient of the local error that is not zero, that of mu^(p+1)."""
    for p in count():
        error = _local_error(table, p + 1)
        if error != 0:
            return p, error
    raise AssertionError("e^mu is no algebraic function of mu: some coefficient is not zero")


def _local_error(table: Table, power: int) -> Fraction:
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


def _runge_kutta_order(scheme: RungeKutta) -> int:
    """Return the largest p with sum_i b_i Phi_i(t) = 1 / gamma(t) for every rooted tree t of up to p vertices."""
    for p in count(1):
        if not all(_satisfied(scheme, tree) for tree in _trees(p + 1)):
            return p
    raise AssertionError("s explicit stages have at most order s")


def _satisfied(scheme: RungeKutta, tree: Tree) -> bool:
    stage_weights = _stage_weights(scheme, tree)
    total = sum((b * phi for b, phi in zip(scheme.weights, stage_weights, strict=True)), ZERO)
    return total * _density(tree) == 1


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
