"""Forced errors in float64 against fifty digits, over ten decades; what is refused."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods import forced_errors, lookup
from bezstab.stability import forced_error, turning_response
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


def test_points_of_a_map_have_the_errors_that_they_have_alone() -> None:
    """A map's points are looked at in fewer frequencies at a time: the answer is the same."""
    alpha_hat, beta_hat = np.linspace(0.01, 0.9, 400), np.linspace(0.001, 0.4, 400)[:, np.newaxis]
    of_map = forced_error(lookup("B4"), alpha_hat, beta_hat, any_frequency=True)
    for i, j in ((0, 0), (17, 399), (399, 200)):
        alone = forced_error(lookup("B4"), alpha_hat[j], beta_hat[i, 0], any_frequency=True)
        assert float(of_map.total[i, j]) == pytest.approx(float(alone.total), rel=1e-12)
    assert forced_error(lookup("B4"), [], []).total.shape == (0,)


@pytest.mark.parametrize("omega", [Fraction(0), Fraction(1), Fraction(1, 10**7)])
def test_a_motion_that_no_step_follows_or_that_is_none_is_refused(omega: Fraction) -> None:
    with pytest.raises(InputError, match="rad a step: expected 1e-06 to 1"):
        forced_error(lookup("RK4"), 0.5, 0.1, omega)


@pytest.mark.promise("What normals that turn add to it")
@pytest.mark.parametrize("multiple", [1, 5])
def test_normals_that_turn_add_to_gauss_alone(multiple: int) -> None:
    """-b/5184 of the turning normal, b of the method's own step, where methods/test_steady_errors has it as a run."""
    found = turning_response(lookup(f"gauss4@{multiple}"), 3.0, 12.0)
    assert found
    assert found[0] == 3
    assert found[1] == pytest.approx(-12 * multiple**6 / 5184, rel=1e-14)
    assert turning_response(lookup("RK4"), 1.0, 1.0) is None
