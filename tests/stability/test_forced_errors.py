"""Forced errors in float64 against fifty digits, over ten decades; what is refused."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from numpy.polynomial.polynomial import polyroots, polyval

from bezstab.methods.registry import lookup
from bezstab.methods.steady_errors import forced_errors, turning_error
from bezstab.stability.arrays import FloatArray
from bezstab.stability.forced_errors import forced_error
from tests.reference.forced_runs import exact_value

METHODS = ("B4", "AB4", "AB8", "RK4", "dopri5", "SYM", "verlet-half", "hht", "gauss4")
OMEGAS = (Fraction(1, 10**6), Fraction(1, 100), Fraction(3, 10), Fraction(9, 10))
POINTS = ((1e-5, 1e-10), (0.02, 1e-4), (0.02, 3e-4))


@pytest.mark.parametrize("omega", OMEGAS, ids=str)
@pytest.mark.parametrize("name", METHODS)
@pytest.mark.slow
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


@pytest.mark.parametrize("name", ["RK4", "AB4", "ABM2", "B4", "hht", "verlet-old", "gauss4"])
def test_the_worst_lower_harmonic_is_that_of_a_search_that_zooms_in(name: str) -> None:
    """Of random feedback, poles within 1e-5 of the unit circle too, to 1e-6; D from all digits of its own terms."""
    method, rng, omega = lookup(name), np.random.default_rng(18), Fraction(9, 10)
    terms, multiple = forced_errors(method).denominator, float(method.step_multiple)
    beta_hat = 10 ** rng.uniform(-6, -0.5, 20)
    alpha_hat = np.sqrt(beta_hat) * 10 ** rng.uniform(-6, 0.5, 20)
    found = forced_error(method, alpha_hat, beta_hat, omega)
    highest = min(multiple * float(omega), np.pi)
    for a, b, position, total in zip(alpha_hat, beta_hat, found.position, found.total, strict=True):
        in_z = np.zeros(1 + max(int(k) for of_powers in terms.values() for k, _ in of_powers))
        for (i, j), of_powers in terms.items():
            for (k, _), c in of_powers.items():
                in_z[int(k)] += float(c) * (multiple * a) ** i * (multiple**2 * b) ** j

        def size(theta: FloatArray, in_z: FloatArray = in_z) -> FloatArray:
            return np.asarray(np.abs(polyval(np.exp(1j * theta), in_z)))

        centres = np.array([0.0, np.sqrt(b) * multiple, *np.abs(np.angle(polyroots(in_z)))]).clip(0, highest)
        places = np.concatenate([np.linspace(0, highest, 2001), centres])
        reach = highest / 2000
        while reach > 1e-13:
            best = places[np.argsort(size(places))[:8]]
            places = np.add.outer(best, reach * np.linspace(-1, 1, 41)).ravel().clip(0, highest)
            reach /= 10
        at_own = size(np.array([multiple * float(omega)]))[0]
        assert total == pytest.approx(position * at_own / min(at_own, size(places).min()), rel=1e-6)


@pytest.mark.parametrize("multiple", [1, 5])
def test_normals_that_turn_add_to_gauss_alone(multiple: int) -> None:
    """-b/5184 of the turning normal, b of the method's own step, where methods/test_steady_errors has it as a run."""
    found = turning_error(lookup(f"gauss4@{multiple}"))
    assert found
    assert found.power == 3
    assert found.at(3.0, 12.0) == pytest.approx(-12 * multiple**6 / 5184, rel=1e-14)
    assert turning_error(lookup("RK4")) is None
