from fractions import Fraction

import pytest

from bezstab.methods import REGISTRY, LinearMultistep, Method, fixed_poles, lookup, without_shared_factor

F = Fraction


def with_factor(*factor: Fraction) -> Method:
    """AB2 with rho and sigma multiplied by one polynomial."""
    scheme = lookup("AB2").scheme
    assert isinstance(scheme, LinearMultistep)
    parts = []
    for polynomial in (scheme.rho, scheme.sigma):
        product = [F(0)] * (len(polynomial) + len(factor) - 1)
        for i, a in enumerate(polynomial):
            for k, b in enumerate(factor):
                product[i + k] += a * b
        parts.append(tuple(product))
    return Method("shared", LinearMultistep(parts[0], parts[1]), "")


@pytest.mark.parametrize("name", REGISTRY)
def test_no_method_of_the_registry_has_a_fixed_pole(name: str) -> None:
    assert fixed_poles(lookup(name)) == ()
    assert without_shared_factor(lookup(name)) is lookup(name)


@pytest.mark.parametrize(
    ("factor", "poles"),
    [((F(1), F(-9, 10)), [0.9]), ((F(1), F(0), F(1)), [1j, -1j]), ((F(1), F(1), F(1, 4)), [-0.5]), ((F(1), F(0)), [])],
)
def test_what_rho_and_sigma_share_is_found_and_cancelled(factor: tuple[Fraction, ...], poles: list[complex]) -> None:
    method = with_factor(*factor)
    assert fixed_poles(method) == pytest.approx(tuple(poles))
    if poles:
        assert without_shared_factor(method).scheme == lookup("AB2").scheme
