from fractions import Fraction

import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy.polys.rings import ring

from bezstab.methods.root_isolation import real_roots
from tests.reference.rationals import rationals


@settings(deadline=None, max_examples=20)  # exact arithmetic has no bounded time
@given(st.sets(rationals(-20, 20, max_denominator=9), min_size=1, max_size=5))
def test_rational_roots_are_found_exactly(roots: set[Fraction]) -> None:
    _, x = ring("x", sp.QQ)
    polynomial = sp.prod(root.denominator * x - root.numerator for root in roots) * (x**2 + 1)
    assert real_roots(polynomial) == sorted(roots)
