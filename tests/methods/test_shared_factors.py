from fractions import Fraction

import pytest

from bezstab.methods import (
    REGISTRY,
    LinearMultistep,
    Method,
    closed_loop_table,
    fixed_poles,
    lookup,
    recipe,
    reduced_table,
    without_shared_factor,
)
from tests.methods.random_recipes import VERLET
from tests.reference.known_roots import product

F = Fraction


def with_factor(*factor: Fraction) -> Method:
    """AB2 with rho and sigma multiplied by one polynomial."""
    scheme = lookup("AB2").scheme
    assert isinstance(scheme, LinearMultistep)
    rho, sigma = (tuple(product([polynomial, factor])) for polynomial in (scheme.rho, scheme.sigma))
    return Method("shared", LinearMultistep(rho, sigma), "")


@pytest.mark.parametrize("name", REGISTRY)
def test_no_method_of_the_registry_has_a_fixed_pole(name: str) -> None:
    assert fixed_poles(lookup(name)) == ()
    assert without_shared_factor(lookup(name)) is lookup(name)
    assert reduced_table(lookup(name)) == closed_loop_table(lookup(name))


@pytest.mark.parametrize(
    ("factor", "poles"),
    [((F(1), F(-9, 10)), [0.9]), ((F(1), F(0), F(1)), [1j, -1j]), ((F(1), F(1), F(1, 4)), [-0.5]), ((F(1), F(0)), [])],
)
def test_what_rho_and_sigma_share_is_found_and_cancelled(factor: tuple[Fraction, ...], poles: list[complex]) -> None:
    method = with_factor(*factor)
    assert fixed_poles(method) == pytest.approx(tuple(poles))
    if poles:
        assert without_shared_factor(method).scheme == lookup("AB2").scheme


@pytest.mark.parametrize(
    ("text", "poles"),
    [("9/10 w[0]", [0.9]), ("0 x0 - w[0]", [-1.0]), ("x0", []), ("w[0] - 1/2 w[-1]", [0.5 + 0.5j, 0.5 - 0.5j])],
)
def test_what_no_feedback_moves_in_a_second_order_scheme_is_found_and_cancelled(
    text: str, poles: list[complex]
) -> None:
    """Velocity Verlet with a helper w that nobody needs."""
    method = Method("helped", recipe(VERLET | {"w": text}), "")
    assert fixed_poles(method) == pytest.approx(tuple(poles))
    assert reduced_table(method) == closed_loop_table(lookup("verlet-half"))
    assert without_shared_factor(method) == method  # whose equations stay as they are
