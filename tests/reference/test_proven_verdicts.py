import numpy as np
from hypothesis import given, settings

from bezstab.rationals import whole_multiples
from tests.reference.known_roots import Factor, inside, on_circle, outside, product, several, squared_modulus
from tests.reference.proven_verdicts import all_inside


@settings(deadline=None, max_examples=60)
@given(several(inside | on_circle | outside))
def test_whole_numbers_give_the_verdict_of_the_known_roots(factors: list[Factor]) -> None:
    whole, _ = whole_multiples(product(factors)[::-1])
    column = np.array(whole, dtype=object)[:, np.newaxis]
    assert all_inside(column).tolist() == [all(squared_modulus(factor) < 1 for factor in factors)]
