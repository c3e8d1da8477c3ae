from fractions import Fraction
from itertools import combinations, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import QQ
from sympy.polys.rings import ring

from bezstab.methods.derivation import PLANE
from bezstab.methods.determinants import as_fraction
from bezstab.methods.registry import lookup
from bezstab.stability.quadrant_proofs import _positive, crossing_polynomials, stable_for_all
from tests.reference.rationals import rationals

CONSTANTS, _ = ring("x", QQ)


@pytest.mark.parametrize("name", ["bdf2", "trapezoid", "dirk3", "gauss4", "hht(-1/3)", "generalized-alpha(1/2)"])
@pytest.mark.slow
def test_what_is_known_to_be_stable_for_all_steps_is_proven_so(name: str) -> None:
    assert stable_for_all(lookup(name)) == "proven"


@pytest.mark.parametrize(
    "name",
    [
        *("bdf3", "bdf6", "am3", "SYM", "B12", "AB8", "RK4", "ABM4", "imex-euler", "verlet-implicit", "fox-goodwin"),
    ],
)
def test_what_is_known_to_have_limits_is_refuted(name: str) -> None:
    assert stable_for_all(lookup(name)) == "no"


@settings(max_examples=10, deadline=None)
@given(rationals(Fraction(2, 5), 1, max_denominator=20), rationals(Fraction(1, 20), 1, max_denominator=20))
def test_newmark_is_stable_for_all_where_hughes_says_so(velocity: Fraction, position: Fraction) -> None:
    # T. J. R. Hughes, The Finite Element Method, section 9.1.2: gamma >= 1/2 and 2 beta >= gamma
    expected = "proven" if velocity >= Fraction(1, 2) and 2 * position >= velocity else "no"
    assert stable_for_all(lookup(f"newmark({position},{velocity})")) == expected


@settings(max_examples=50, deadline=None)
@given(st.lists(st.complex_numbers(max_magnitude=1.5, allow_nan=False), min_size=1, max_size=3), st.floats(0.5, 2))
def test_the_edge_of_pairs_is_the_product_of_what_pairs_of_roots_lack_to_one(roots: list[complex], last: float) -> None:
    coefficients = last * np.poly([*roots, *np.conj(roots)]).real[::-1]
    *_, found = crossing_polynomials([CONSTANTS(Fraction(c)) for c in coefficients.tolist()])
    pairs = combinations([*roots, *np.conj(roots)], 2)
    expected = last ** (2 * len(roots) - 1) * np.prod([1 - first * second for first, second in pairs])
    assert float(as_fraction(found.const())) == pytest.approx(expected.real, rel=1e-9, abs=1e-9 * last**5 * 4**15)


def test_only_what_is_positive_on_the_whole_quadrant_passes() -> None:
    a, b = PLANE.ring.gens
    positive = [1 + a * b, a, (12 - b) ** 2 + a**2 / 3, 5 + a * (b - 1) ** 2]
    not_proven = [b - 1, (a - 1) ** 2, a * (b - 1) ** 3 + 1, -1 - a, (a - b) ** 2]
    for polynomial, expected in [*product(positive, [True]), *product(not_proven, [False])]:
        assert _positive(polynomial) is expected
