from fractions import Fraction

import numpy as np
import pytest
from numpy.polynomial.polynomial import polyval2d

from bezstab.errors import NumericalError
from bezstab.methods import LinearMultistep, Method, RungeKutta, lookup
from bezstab.stability import pencil_of, poles, roots_in_z
from bezstab.stability.pencils import deadbeat_mu, has_infinite_root


@pytest.mark.parametrize("name", ["B4", "ABM3", "RK4", "AB2@1/3"])
def test_the_tables_of_the_gradient_are_those_of_difference_quotients(name: str) -> None:
    pencil, z, mu, small = pencil_of(lookup(name)), 0.3 + 0.4j, -0.5 + 0.2j, 1e-5
    by_z = (polyval2d(z + small, mu, pencil.table) - polyval2d(z - small, mu, pencil.table)) / (2 * small)
    by_mu = (polyval2d(z, mu + small, pencil.table) - polyval2d(z, mu - small, pencil.table)) / (2 * small)
    assert abs(polyval2d(z, mu, pencil.table_by_z) - by_z) < 1e-8
    assert abs(polyval2d(z, mu, pencil.table_by_mu) - by_mu) < 1e-8


@pytest.mark.parametrize("name", ["B2", "B4", "AB3", "AB4", "ABM2"])
def test_two_roots_meet_at_a_branch_point(name: str) -> None:
    pencil = pencil_of(lookup(name))
    found = pencil.branch_points
    assert len(found)
    z = roots_in_z(pencil, found)
    apart = np.abs(z[:, np.newaxis] - z)[np.triu_indices(len(z), 1)].min(axis=0)
    assert apart.max() < 1e-3  # where three or four meet, float64 keeps a third or a quarter of its digits


def test_coefficients_beyond_float64_are_reported() -> None:
    huge, none = Fraction(10) ** 90, Fraction(0)
    rows = tuple(tuple(huge if column == row - 1 else none for column in range(4)) for row in range(4))
    method = Method("huge", RungeKutta(rows, (1 - huge, none, none, huge)), "constructed")  # R has huge^4 mu^4
    with pytest.raises(NumericalError, match="huge: products of its coefficients"):
        poles(method, 0.5, 0.1)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        *[("implicit-euler", [1]), ("trapezoid", [2]), ("bdf2", [1.5]), ("B4", []), ("RK4", [])],
        *[("radau3", [2 - 2**0.5 * 1j, 2 + 2**0.5 * 1j]), ("gauss4", [3 - 3**0.5 * 1j, 3 + 3**0.5 * 1j])],
    ],
)
def test_a_root_is_infinite_at_the_zeros_of_the_leading_coefficient(name: str, expected: list[complex]) -> None:
    pencil = pencil_of(lookup(name))
    assert pencil.implicit == bool(expected)
    found = np.sort_complex(pencil.infinite_at)
    assert found == pytest.approx(np.array(expected), abs=1e-12)
    assert has_infinite_root(pencil, found).all()
    assert not has_infinite_root(pencil, found + 1e-6).any()


def fractions(text: str) -> tuple[Fraction, ...]:
    return tuple(map(Fraction, text.split()))


def test_a_leading_coefficient_vanishes_to_its_own_rounding_alone() -> None:
    # z^2 (1 - 7 mu / 10) - (1 - 13 mu / 10): nothing in z, from which a size could be taken by mistake
    method = Method("gap", LinearMultistep(fractions("1 0 -1"), fractions("7/10 0 13/10")), "constructed")
    place = 10 / 7 * (1 + np.finfo(float).eps * np.array([-2, -1, 0, 1, 2]))
    assert has_infinite_root(pencil_of(method), place.astype(complex)).all()
    assert not has_infinite_root(pencil_of(method), np.array([10 / 7 + 1e-9], complex)).any()


def test_branch_points_of_a_rational_function_are_its_values_where_it_is_flat_and_at_infinity() -> None:
    # R = (1 + mu/3) / (1 - 2 mu/3 + mu^2/6): R' = 0 at mu^2 + 6 mu - 18 = 0, R(infinity) = 0
    flat = np.array([-3 + 27**0.5, -3 - 27**0.5])
    values = (1 + flat / 3) / (1 - 2 * flat / 3 + flat**2 / 6)
    found = np.sort(pencil_of(lookup("radau3")).branch_points_in_z.real)
    assert found == pytest.approx(np.sort([*values, 0]), abs=1e-12)


@pytest.mark.parametrize(
    ("name", "zero"), [("radau3", -3), ("sdirk2", -1 - 2**0.5), ("implicit-midpoint", -2), ("RK1", -1)]
)
def test_of_a_numerator_of_lower_degree_too_the_zeros_are_found(name: str, zero: float) -> None:
    (found,) = deadbeat_mu(pencil_of(lookup(name)))
    assert found == pytest.approx(zero, rel=1e-14)


def test_the_scale_of_a_resultant_is_no_matter() -> None:
    """Twenty implicit Euler steps composed have a resultant below float64's range, but a pole of R as any other."""
    steps = 20
    h = Fraction(1, steps)
    rows = tuple((h,) * (k + 1) + (Fraction(0),) * (steps - k - 1) for k in range(steps))
    pencil = pencil_of(Method("composed", RungeKutta(rows, (h,) * steps), ""))
    furthest = np.finfo(float).eps ** (1 / steps)  # so far apart, and a few times that, are twenty roots that are one
    assert pencil.branch_points == pytest.approx(steps, rel=4 * furthest)
    assert len(pencil.branch_points) >= steps
