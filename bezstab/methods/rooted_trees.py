r"""The conditions of order of Runge-Kutta methods, one for each rooted tree.

The derivatives of y along y' = f(y) are sums of products of derivatives of f, one for each rooted tree: a vertex is an
f, its branches are the arguments of that derivative of f (Hairer, Norsett & Wanner I, section II.2).

    y'' = f' f   o        y''' = f''(f, f)   o   o     +   f' f' f   o
                 |                            \ /                    |
                 o                             o                     o
                                                                     |
                                                                     o

A Runge-Kutta method's result has the same products with other factors. It is of order p if and only if they agree
for every tree t of up to p vertices: sum_i b_i Phi_i(t) = 1 / gamma(t), where gamma(t) is the product over the vertices
of the size of the subtree that each is the root of. Only linear problems have nothing but tall trees, which is why
R(mu) alone does not tell the order.

A tree of several vertices is a smaller one with another tree put on its root, as one more branch (Butcher's product).
"""

from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from operator import mul

from bezstab.rationals import ONE

Coefficients = tuple[Fraction, ...]


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
