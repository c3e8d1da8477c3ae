from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import LinearMultistep, Method, RungeKutta, lookup
from bezstab.stability import pencil_of, poles
from bezstab.stability.pencils import deadbeat_mu, has_infinite_root


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
