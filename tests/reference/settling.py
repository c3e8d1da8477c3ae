"""The time in which errors settle, for tests that ask for a |z_p|."""

import math
from fractions import Fraction


def settling(z_abs: float) -> Fraction:
    """Return the time (s) in which errors fall a thousandfold with a |z_p| in steps of 1 s."""
    return Fraction(math.log(1e-3) / math.log(z_abs))
