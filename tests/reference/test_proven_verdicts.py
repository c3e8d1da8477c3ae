from fractions import Fraction

import numpy as np

from bezstab.stability import region, verdict
from tests.reference.proven_verdicts import proven_stable
from tests.reference.random_methods import other_random_method
from tests.reference.sliced_areas import stable


def test_where_four_roots_nearly_meet_float64_errs_and_the_proof_does_not() -> None:
    method = other_random_method(4786)  # a sliver of area 1.2e-7: all along its edge two pairs lie within 0.03 of z = 1
    (curve,) = region(method).boundary
    centre = curve.mean(axis=0)
    edge = curve[20:-20:10]
    places = np.concatenate([centre + (edge - centre) * (1 + offset) for offset in (-1e-8, 1e-8)])
    exact = [verdict(method, *map(Fraction, place)) == "converges" for place in places]
    assert proven_stable(method, 1.0, *places.T).tolist() == exact
    assert (stable(method, 1.0, *places.T) != exact).sum() > 5
