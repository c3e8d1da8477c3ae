"""Multistep families against independent routes to their weights."""

from fractions import Fraction

import pytest

from bezstab.methods.multistep_methods import is_bezier
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.schemes import LinearMultistep, PredictorCorrector
from tests.reference.bezier_curves import de_casteljau_weights


def multistep(name: str) -> LinearMultistep:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    return scheme


@pytest.mark.parametrize("n", range(2, 13))
def test_bezier_step_integrates_the_curve_of_de_casteljau(n: int) -> None:
    scheme = multistep(f"B{n}")
    assert scheme.rho == (1, -1, *[0] * (n - 1))
    assert list(scheme.sigma) == [0, *de_casteljau_weights(n)]


FAMILIES = [*(("AB", n) for n in range(1, 9)), *(("am", n) for n in range(2, 7)), *(("bdf", n) for n in range(1, 7))]


@pytest.mark.parametrize(("family", "n"), FAMILIES)
def test_a_family_is_exact_for_every_polynomial_that_its_points_determine_and_no_other(family: str, n: int) -> None:
    """Which determines its weights. AB and am integrate t^p, bdf differentiates it; t = 1, 0, -1, ... in steps."""
    scheme = multistep(f"{family}{n}")
    times = [Fraction(1 - j) for j in range(len(scheme.rho))]
    for power in range(n + 2):
        of_y = sum(c * t**power for c, t in zip(scheme.rho, times, strict=True))
        of_f = sum(power * c * t ** (power - 1) for c, t in zip(scheme.sigma, times, strict=True) if power)
        assert (of_y == of_f) == (power <= n), power
    if family == "bdf":
        assert not any(scheme.sigma[1:])
    else:
        assert scheme.rho == (1, -1, *[0] * (len(times) - 2))
        assert bool(scheme.sigma[0]) == (family == "am")


@pytest.mark.parametrize("n", [2, 3, 4])
def test_abm_predicts_by_ab_and_corrects_by_am(n: int) -> None:
    scheme = lookup(f"ABM{n}").scheme
    assert isinstance(scheme, PredictorCorrector)
    corrector = multistep(f"am{n}")
    assert scheme.predictor == multistep(f"AB{n}")
    assert scheme.corrector == LinearMultistep((*corrector.rho, Fraction(0)), (*corrector.sigma, Fraction(0)))


def test_bezier_schemes_are_known_by_their_coefficients() -> None:
    known = [name for name in REGISTRY if is_bezier(lookup(name).scheme)]
    assert known == [f"B{n}" for n in range(3, 13)]  # B1 and B2 are Adams and Bashforth's
