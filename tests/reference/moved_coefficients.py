"""How far a root moves when coefficients do, by moving them one after the other."""

from collections.abc import Sequence

import mpmath as mp

Table = Sequence[Sequence[mp.mpf]]


def larger_root(table: Table, mu: complex) -> mp.mpc:
    """Return a root of the quadratic sum table[k][j] z^k mu^j by its formula."""
    c, b, a = (mp.polyval(list(row)[::-1], mp.mpc(mu)) for row in table)
    return (-b + mp.sqrt(b * b - 4 * a * c)) / (2 * a)


def largest_relative_move(table: Table, mu: complex, share: float) -> mp.mpf:
    """Return |dz / z| / share, at worst, where every coefficient may be off by that share, to first order."""
    z = larger_root(table, mu)
    moves = mp.mpf(0)
    for k, row in enumerate(table):
        for j in range(len(row)):
            moved = [list(entries) for entries in table]
            moved[k][j] *= 1 + mp.mpf(share)
            moves += abs(larger_root(moved, mu) - z)
    return moves / abs(z) / share
