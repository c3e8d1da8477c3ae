from fractions import Fraction

import pytest
from hypothesis import given, settings

from bezstab.methods.registry import lookup
from bezstab.stability.quadrant_proofs import stable_for_all
from tests.reference.rationals import rationals

PROVEN = ("bdf2", "trapezoid", "dirk3", "gauss4", "radau5", "hht(-1/3)", "generalized-alpha(1/2)")
LIMITED = ("bdf3", "bdf6", "am3", "SYM", "B12", "AB8", "RK4", "ABM4", "imex-euler", "verlet-implicit", "fox-goodwin")


@pytest.mark.parametrize(
    ("name", "known"),
    [*(pytest.param(name, "proven", marks=pytest.mark.slow) for name in PROVEN), *((name, "no") for name in LIMITED)],
)
def test_what_is_known_to_be_stable_for_all_steps_or_not_is_so_here(name: str, known: str) -> None:
    assert stable_for_all(lookup(name)) == known


@settings(max_examples=10, deadline=None)
@given(rationals(Fraction(2, 5), 1, max_denominator=20), rationals(Fraction(1, 20), 1, max_denominator=20))
def test_newmark_is_stable_for_all_where_hughes_says_so(velocity: Fraction, position: Fraction) -> None:
    # T. J. R. Hughes, The Finite Element Method, section 9.1.2: gamma >= 1/2 and 2 beta >= gamma
    expected = "proven" if velocity >= Fraction(1, 2) and 2 * position >= velocity else "no"
    assert stable_for_all(lookup(f"newmark({position},{velocity})")) == expected
