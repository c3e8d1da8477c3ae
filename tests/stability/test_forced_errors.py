"""Forced errors in float64 against fifty digits, over ten decades; what is refused."""

from fractions import Fraction

import mpmath
import pytest

from bezstab.errors import InputError
from bezstab.methods import forced_errors, lookup, turning_error
from bezstab.stability import forced_error
from tests.reference.forced_runs import exact_value

METHODS = ("B4", "AB4", "AB8", "RK4", "dopri5", "SYM", "verlet-half", "hht", "gauss4")
OMEGAS = (Fraction(1, 10**6), Fraction(1, 100), Fraction(3, 10), Fraction(9, 10))
POINTS = ((1e-5, 1e-10), (0.02, 1e-4), (0.02, 3e-4))


@pytest.mark.promise("The error that a method forces on a constraint that moves (`methods`, `choose --goal accurate`)")
@pytest.mark.parametrize("omega", OMEGAS, ids=str)
@pytest.mark.parametrize("name", METHODS)
@pytest.mark.slow_except("SYM", "verlet-half", "hht", "AB4", "RK4")
def test_it_has_ten_digits_of_the_exact_functions(name: str, omega: Fraction) -> None:
    errors = forced_errors(lookup(name))
    for point in POINTS:
        found = forced_error(lookup(name), *point, omega)
        with mpmath.workdps(150):  # down to theta^10 = 1e-60 all terms cancel
            below = abs(exact_value(errors.denominator, *point, omega))
            position = abs(exact_value(errors.position, *point, omega)) / below
            velocity = abs(exact_value(errors.velocity, *point, omega)) / below / float(omega)
        # D is a difference of powers of z - 1: ten digits are left where omega h is large and steps are many
        assert float(found.position) == pytest.approx(float(position), rel=1e-10)
        assert float(found.velocity) == pytest.approx(float(velocity), rel=1e-10)
        assert found.total >= found.position * (1 - 1e-12)


def test_of_no_points_there_are_no_errors() -> None:
    assert forced_error(lookup("B4"), [], []).total.shape == (0,)


@pytest.mark.parametrize("omega", [Fraction(0), Fraction(1), Fraction(1, 10**7)])
def test_a_motion_that_no_step_follows_or_that_is_none_is_refused(omega: Fraction) -> None:
    with pytest.raises(InputError, match="rad a step: expected 1e-06 to 1"):
        forced_error(lookup("RK4"), 0.5, 0.1, omega)


@pytest.mark.promise("What normals that turn add to it")
@pytest.mark.parametrize("multiple", [1, 5])
def test_normals_that_turn_add_to_gauss_alone(multiple: int) -> None:
    """-b/5184 of the turning normal, b of the method's own step, where methods/test_steady_errors has it as a run."""
    found = turning_error(lookup(f"gauss4@{multiple}"))
    assert found
    assert found.power == 3
    assert found.at(3.0, 12.0) == pytest.approx(-12 * multiple**6 / 5184, rel=1e-14)
    assert turning_error(lookup("RK4")) is None
