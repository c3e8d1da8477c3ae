"""The damping that a method adds to an oscillator that has none: x'' = -omega^2 x, theta = omega h.

The oscillator's pole is z = e^L, and L a power series in mu = i theta with real coefficients: those of even powers damp
or drive it. The damping ratio is -Re L / |L|.
"""

from fractions import Fraction
from functools import reduce
from typing import NamedTuple

import sympy as sp
from sympy.polys.ring_series import rs_exp, rs_mul
from sympy.polys.rings import ring

from bezstab.methods.derivation import closed_loop_table
from bezstab.methods.determinants import as_fraction
from bezstab.methods.orders import accuracy_by_force
from bezstab.methods.schemes import Method
from bezstab.rationals import ZERO

SERIES, MU = ring("mu", sp.QQ)

BEYOND_ORDER = 4
"""Powers of theta above the order of accuracy that are looked at: a damping of the truncation stands among them."""


class AddedDamping(NamedTuple):
    """The damping ratio coefficient theta^power + ..., negative where the method drives.

    `power` is None where all up to theta^highest are zero, as for methods that keep the oscillator's energy.
    """

    power: int | None
    coefficient: Fraction
    highest: int


def added_damping(method: Method) -> AddedDamping:
    """Return the leading term of the damping ratio that a method adds, theta in steps h of the user; exact.

    Of P(z; 0, theta^2) = 0 near z = 1. Where rationals stand for irrational coefficients what is zero to all but two of
    their digits is zero.
    """
    highest = accuracy_by_force(method).position[0] + BEYOND_ORDER
    in_z = [
        SERIES.from_dict({(2 * j,): (-1) ** j * c for j, c in enumerate(in_plane[0]) if c})  # beta_hat = -mu^2
        for in_plane in closed_loop_table(method)
    ]
    multiple = sp.QQ.convert(method.step_multiple)
    curvature = sum(k**2 * c.coeff(1) for k, c in enumerate(in_z))  # P(e^L) = curvature / 2 (L^2 - (m mu)^2) + ...
    exponent = multiple * MU
    for power in range(2, highest + 2):
        terms = power + 2
        growth = rs_exp(exponent, MU, terms)
        left_over = reduce(lambda value, c: rs_mul(value, growth, MU, terms) + c, reversed(in_z))
        change = left_over.coeff(MU ** (power + 1)) / (curvature * multiple)
        exponent -= change * MU**power
        if power % 2 == 0 and abs(change) > method.rounding:
            return AddedDamping(power - 1, as_fraction(change * (-1) ** (power // 2) / multiple), highest)
    return AddedDamping(None, ZERO, highest)
