from fractions import Fraction

import numpy as np
from hypothesis import given, settings

from bezstab.rationals import whole_multiples
from bezstab.stability import region, verdict
from tests.reference.known_roots import Factor, inside, on_circle, outside, product, several, squared_modulus
from tests.reference.proven_verdicts import all_inside, proven_stable
from tests.reference.random_methods import other_random_method
from tests.reference.sliced_areas import stable


@settings(deadline=None, max_examples=60)
@given(several(inside | on_circle | outside))
def test_whole_numbers_give_the_verdict_of_the_known_roots(factors: list[Factor]) -> None:
    whole, _ = whole_multiples(product(factors)[::-1])
    column = np.array(whole, dtype=object)[:, np.newaxis]
    assert all_inside(column).tolist() == [all(squared_modulus(factor) < 1 for factor in factors)]


def test_where_four_roots_nearly_meet_float64_errs_and_the_proof_does_not() -> None:
    method = other_random_method(4786)  # a sliver of area 1.2e-7: all along its edge two pairs lie within 0.03 of z = 1
    (curve,) = region(method).boundary
    centre = curve.mean(axis=0)
    edge = curve[20:-20:10]
    places = np.concatenate([centre + (edge - centre) * (1 + offset) for offset in (-1e-8, 1e-8)])
    exact = [verdict(method, *map(Fraction, place)) == "converges" for place in places]
    assert proven_stable(method, 1.0, *places.T).tolist() == exact
    assert (stable(method, 1.0, *places.T) != exact).sum() > 5
