"""Second-order schemes: P is what their own step matrix has, what is implicit is found, what cannot be is refused."""

from fractions import Fraction

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from tests.methods import kinds
from tests.methods.random_recipes import RECIPES, VERLET
from tests.reference.made_methods import multistep
from tests.reference.second_order_steps import step_polynomial

F = Fraction
POINTS = [(F(3, 7), F(2, 11)), (F(-1, 3), F(5, 2)), (F(0), F(1)), (F(7, 2), F(0))]


def is_shifted(longer: list[Fraction], shorter: list[Fraction]) -> bool:
    """Return whether one polynomial is the other, made monic, times a power of z."""
    monic = [c / shorter[-1] for c in shorter]
    return longer == [F(0)] * (len(longer) - len(monic)) + monic


@pytest.mark.parametrize("name", [*kinds.SECOND_ORDER, *kinds.IMPLICIT, "RK4", "dopri5", "ABM3"])
def test_p_is_the_characteristic_polynomial_of_the_step(name: str) -> None:
    form = lookup(name).scheme.second_order
    for point in POINTS[:2]:
        polynomial = step_polynomial(form, *point)
        assert polynomial is not None
        assert is_shifted(polynomial, closed_loop_at(Method("form", form, ""), *point))


@settings(deadline=None, max_examples=60)  # the determinant's time is not bounded by its input's length
@given(RECIPES, st.sampled_from(POINTS))
@pytest.mark.slow
def test_p_of_a_random_recipe_is_that_of_its_own_step(
    equations: dict[str, str], point: tuple[Fraction, Fraction]
) -> None:
    scheme = recipe(equations)
    p = closed_loop_at(Method("own", scheme, ""), *point)
    polynomial = step_polynomial(scheme, *point)
    assert (polynomial is None) == (p[-1] == 0)
    assume(polynomial is not None)
    assert polynomial is not None
    assert is_shifted(polynomial, p)


DOUBLED = {"x1": "x0 + 1/2 v0", "v1": "v0 + 2 a0", "a0": "acceleration(x0, 1/2 v0)"}
"""A velocity in other units: its P is right."""


@pytest.mark.parametrize(
    ("equations", "why"),
    [
        (VERLET | {"x1": "x0 + v0 + 1/2 a0 + w"}, "x1: no equation gives w"),
        (VERLET | {"a1": "acceleration(x2, vh)"}, "a1: uses x2, but x1 is the latest there is"),
        (VERLET | {"a0": "acceleration(x0, v0)"}, "a0: a second equation for a"),
        (VERLET | {"x1": "x1"}, "do not determine x1 and v1"),
        (VERLET | {"v1": "vh"}, "an acceleration does not act in full"),
        (VERLET | {"a1": "acceleration(x1, 2 vh)"}, "feedback not as feedback"),
        (VERLET | {"x1": "3 x0 - 2 x[-1] - v0 + 1/2 a0"}, "zero-unstable: .* outside the unit circle"),
        (VERLET | {"w": "0 x0 - w[0] + u[0]", "u": "0 x0 - u[0]"}, "zero-unstable"),  # -1 twice; once it is allowed
        (DOUBLED, "v1 is not the velocity of x1"),
        ({"x1": "x0 + v0", "v1": "v0"}, "no equation evaluates the acceleration"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(equations: dict[str, str], why: str) -> None:
    with pytest.raises(InputError, match=why) as caught:
        recipe(equations)
    assert len(str(caught.value).splitlines()) == 1


def test_a_root_on_the_circle_that_stays_is_allowed_once() -> None:
    assert recipe(VERLET | {"w": "0 x0 - w[0]"}).table.size
    # leapfrog: rho = z^2 - 1 has the root -1 once for positions, once for velocities
    assert multistep("leapfrog", "1 0 -1", "0 2 0").scheme.second_order.table.size
