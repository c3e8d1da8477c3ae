import numpy as np
import pytest
from numpy.polynomial.polynomial import polyfromroots

from bezstab.stability import ComplexArray
from bezstab.stability.least_modulus import Active, Coefficients, solved


def from_roots(*roots: tuple[complex, complex, complex]) -> Coefficients:
    """Return the polynomial whose roots are constant + x by_x + y by_y, with its slopes."""

    def coefficients(x: float, y: float) -> ComplexArray:
        z = [constant + x * by_x + y * by_y for constant, by_x, by_y in roots]
        others = [polyfromroots(z[:k] + z[k + 1 :]) for k in range(len(z))]
        slopes = [
            -sum((root[i] * np.append(other, 0) for root, other in zip(roots, others, strict=True)), np.zeros(1))
            for i in (1, 2)
        ]
        return np.array([polyfromroots(z), *slopes], complex)

    return coefficients


def test_two_poles_that_move_against_each_other_meet_where_neither_is_larger() -> None:
    """With w = x - 1 + i (y - 2), |1 + w| and |-1 + w| are equal for x = 1 and least for y = 2."""
    poles = from_roots((-2j, 1, 1j), (-2 - 2j, 1, 1j))
    found = solved(poles, (1.1, 2.2), [Active(1.1 + 0.2j), Active(-0.9 + 0.2j)])
    assert found
    assert found.parameters == pytest.approx((1, 2), abs=1e-12)
    assert found.z == pytest.approx([1, -1])


def test_three_poles_of_one_modulus_leave_no_freedom() -> None:
    """1 - x, -(1 + y) and i (2 - y): 1 + y = 2 - y, and 1 - x as much."""
    found = solved(
        from_roots((1, -1, 0), (-1, 0, -1), (2j, 0, -1j)), (-0.4, 0.4), [Active(1.4), Active(-1.4), Active(1.6j)]
    )
    assert found
    assert found.parameters == pytest.approx((-0.5, 0.5), abs=1e-12)


def test_a_single_pole_is_least_where_it_has_no_slope() -> None:
    """z = 1 + x^2 + (y - 1)^2, of which the second parameter is one."""

    def coefficients(x: float, y: float) -> ComplexArray:
        return np.array([[-1 - x**2 - (y - 1) ** 2, 1], [-2 * x, 0], [-2 * (y - 1), 0]], complex)

    found = solved(coefficients, (0.2, 0.9), [Active(1.05, real=True)])
    assert found
    assert found.parameters == pytest.approx((0, 1), abs=1e-12)
    assert found.z[0] == pytest.approx(1)


def test_a_double_pole_is_least_along_the_curve_on_which_it_is_double() -> None:
    """z^2 - 2 x z + x^2 - (x - 1 - y^2): double at x = 1 + y^2, as z = x; least at y = 0."""

    def coefficients(x: float, y: float) -> ComplexArray:
        return np.array([[x**2 - x + 1 + y**2, -2 * x, 1], [2 * x - 1, -2, 0], [2 * y, 0, 0]], complex)

    found = solved(coefficients, (1.1, 0.2), [Active(1.1, multiplicity=2, real=True)])
    assert found
    assert found.parameters == pytest.approx((1, 0), abs=1e-12)
    assert found.z[0] == pytest.approx(1)


@pytest.mark.parametrize("held", [0, 1])
def test_a_parameter_that_is_held_is_zero(held: int) -> None:
    """|z|^2 = (2 + x + y)^2 + (x - y)^2 is least at (-1, -1); on either axis at -1."""
    found = solved(from_roots((2, 1 + 1j, 1 - 1j)), (-0.8, -0.2) if held else (-0.2, -0.8), [Active(1 - 0.6j)], held)
    assert found
    assert found.parameters == pytest.approx((0, -1) if held == 0 else (-1, 0), abs=1e-12)


def test_what_leads_far_away_is_no_minimum_nearby() -> None:
    """The pole 1 + x + iy is least at (-1, 0)."""
    assert solved(from_roots((1, 1, 1j)), (5.0, 5.0), [Active(6 + 5j)]) is None
