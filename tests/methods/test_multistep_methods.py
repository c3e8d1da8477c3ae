"""Bezier methods against another route to their weights; of others order and number of steps determine them."""

import pytest

from bezstab.methods.multistep_methods import is_bezier
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import LinearMultistep
from tests.reference.bezier_curves import de_casteljau_weights


@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_step_integrates_the_curve_of_de_casteljau(n: int) -> None:
    scheme = lookup(f"B{n}").scheme
    assert isinstance(scheme, LinearMultistep)
    assert scheme.rho == (1, -1, *[0] * (n - 1))
    assert list(scheme.sigma) == [0, *de_casteljau_weights(n)]


def test_bezier_schemes_are_known_by_their_coefficients() -> None:
    known = [name for name in REGISTRY if is_bezier(lookup(name).scheme)]
    assert known == [f"B{n}" for n in range(3, 13)]  # B1 and B2 are Adams and Bashforth's
