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
"""

from collections.abc import Iterator, Sequence
from fractions import Fraction
from functools import cache

from bezstab.methods.polynomials import Polynomial
from bezstab.rationals import ONE, ZERO

Tableau = Sequence[Polynomial]

Tree = tuple["Tree", ...]
"""A rooted tree: the subtrees of its root, sorted. () is a single vertex, ((),) one with a leaf on it."""


def tree_errors(tableau: Tableau, weights: Polynomial, vertices: int) -> Iterator[Fraction]:
    """Yield gamma(t) sum_i b_i Phi_i(t) - 1 for every rooted tree t of so many vertices."""
    for tree in _trees(vertices):
        terms = zip(weights, _stage_weights(tableau, tree), strict=True)
        yield vertices * sum((b * psi for b, psi in terms), ZERO) - 1


def _stage_weights(tableau: Tableau, tree: Tree) -> list[Fraction]:
    """Return psi_i(t) = gamma(t) Phi_i(t) / |t| for every stage i, |t| being the number of vertices.

    It is the product over the root's subtrees t' of |t'| sum_j a_ij psi_j(t'), as gamma(t) is |t| times those of t'.
    """
    product = [ONE] * len(tableau)
    for subtree in tree:
        size, inner = _vertices(subtree), _stage_weights(tableau, subtree)
        for i, row in enumerate(tableau):
            product[i] *= size * sum((a * psi for a, psi in zip(row, inner, strict=True)), ZERO)
    return product


def _vertices(tree: Tree) -> int:
    return 1 + sum(_vertices(subtree) for subtree in tree)


@cache
def _trees(order: int) -> frozenset[Tree]:
    """Return the rooted trees with `order` vertices: 1, 1, 2, 4, 9, 20, ... of them."""
    if order == 1:
        return frozenset({()})
    return frozenset(larger for tree in _trees(order - 1) for larger in _with_another_leaf(tree))


def _with_another_leaf(tree: Tree) -> Iterator[Tree]:
    """Yield the trees that a leaf makes of a tree, at its root or anywhere above; subtrees are sorted."""
    yield ((), *tree)
    for i, subtree in enumerate(tree):
        for larger in _with_another_leaf(subtree):
            yield tuple(sorted([*tree[:i], larger, *tree[i + 1 :]]))
