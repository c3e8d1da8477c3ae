from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings

from bezstab.errors import NumericalError
from bezstab.methods import LinearMultistep, Method, RungeKutta, lookup
from bezstab.stability import (
    BestPoint,
    Pencil,
    best_point,
    best_points,
    falls_towards,
    pencil_of,
    region,
    spectral_radius,
    window,
)
from bezstab.stability.best_points import _meeting_poles
from tests.methods.kinds import EXPLICIT, sampled
from tests.reference.least_by_descent import least_within, modulus_of, random_implicit_runge_kutta
from tests.reference.random_methods import other_random_method
from tests.reference.rationals import rationals
from tests.reference.second_order_methods import as_second_order

F = Fraction
KINKS = [f"B{n}" for n in range(3, 13)] + [f"AB{n}" for n in range(3, 9)]


def best(name: str) -> BestPoint:
    found = best_point(lookup(name))
    assert found is not None
    return found


@pytest.mark.promise(
    "Least |z_p|",
    computed="1e-12, its place 1e-10, against thirty digits; no sampled point of the plane is lower",
)
@pytest.mark.parametrize("name", sampled(KINKS))
def test_the_kink_where_two_opposite_real_roots_meet(name: str) -> None:
    scheme = lookup(name).scheme
    assert isinstance(scheme, LinearMultistep)
    rho, sigma = ([mpmath.mpf(c.numerator) / c.denominator for c in p] for p in (scheme.rho, scheme.sigma))
    with mpmath.workdps(30):

        def gap(r: mpmath.mpf) -> mpmath.mpf:
            return mpmath.polyval(rho, r) * mpmath.polyval(sigma, -r) - mpmath.polyval(rho, -r) * mpmath.polyval(
                sigma, r
            )

        r = mpmath.findroot(gap, best(name).z_abs)
        mu = mpmath.polyval(rho, r) / mpmath.polyval(sigma, r)
    found = best(name)
    assert found.z_abs == pytest.approx(float(r), rel=1e-12)
    assert found.alpha_hat == pytest.approx(float(-2 * mu), rel=1e-10)
    assert found.beta_hat == pytest.approx(float(mu**2), rel=1e-10)
    assert found.double
    assert sorted(z.real for z in found.meeting) == pytest.approx([-found.z_abs, found.z_abs])
    assert not found.arc


def test_the_values_beside_the_papers() -> None:
    exact = {"B2": 0.57735, "B3": 0.60698, "B4": 0.62588}
    assert {name: round(best(name).z_abs, 5) for name in exact} == exact


@pytest.mark.parametrize("name", ["B2", "ABM3", "AB3@2"])
@pytest.mark.slow
def test_a_recipe_that_spells_out_a_method_has_its_best_point(name: str) -> None:
    of_recipe, of_method = best_point(as_second_order(name)), best(name)
    assert of_recipe
    assert of_recipe.z_abs == pytest.approx(of_method.z_abs, rel=1e-9)
    places = np.array([(of_method.alpha_hat, of_method.beta_hat), *of_method.elsewhere])
    # where two curves of |z| meet at a slant the place is good to some 1e-10
    assert np.abs(places - [of_recipe.alpha_hat, of_recipe.beta_hat]).max(axis=1).min() < 1e-9


@pytest.mark.parametrize("name", ["B2", "AB2"])
def test_two_steps_have_a_whole_arc(name: str) -> None:
    found = best(name)
    assert found.arc
    assert found.z_abs == pytest.approx(3**-0.5, rel=1e-13)
    ends = sorted([(found.alpha_hat, found.beta_hat), *found.elsewhere])
    assert np.array(ends) == pytest.approx(np.array([(4 / 9, 4 / 9), (4 / 3, 4 / 9)]), abs=1e-10)
    along = spectral_radius(lookup(name), np.linspace(4 / 9, 4 / 3, 50)[1:-1], 4 / 9)
    assert along == pytest.approx(3**-0.5, abs=1e-9)  # both roots simple away from the ends


@pytest.mark.parametrize(
    ("name", "points"),
    [
        ("RK1", [(2, 1)]),
        ("RK2", [(2, 2)]),
        ("SIE", [(1, 1)]),
        ("SYM", [(1, 1)]),
        ("RK3", [(3.19214327596, 2.54744467359), (1.40392836202, 3.75922975962)]),
        ("RK4", [(3.45888846213, 3.78125278982), (0.541111537865, 6.34710275518)]),
        ("RK4@5", [(3.45888846213 / 5, 3.78125278982 / 25), (0.541111537865 / 5, 6.34710275518 / 25)]),
    ],
)
def test_one_step_methods_are_deadbeat_at_the_zeros_of_r(name: str, points: list[tuple[float, float]]) -> None:
    found = best(name)
    assert found.z_abs == 0
    assert np.array([(found.alpha_hat, found.beta_hat), *found.elsewhere]) == pytest.approx(np.array(points), abs=1e-10)
    assert float(spectral_radius(lookup(name), found.alpha_hat, found.beta_hat)) < 1e-7  # R has simple zeros; rounding


def test_a_double_root_of_pi_at_one_third() -> None:
    found = best("ABM2")
    assert (found.z_abs, found.alpha_hat, found.beta_hat) == pytest.approx((1 / 3, 4 / 3, 4 / 9), rel=1e-9)


@pytest.mark.promise("Least |z_p|")
@pytest.mark.parametrize("name", sampled([*EXPLICIT, "B4@2"]))
@pytest.mark.slow_except("RK4", "B1", "AB2", "B2", "AB4")
def test_nothing_in_the_plane_is_faster(name: str) -> None:
    method, found, random = lookup(name), best(name), np.random.default_rng(5)
    (a_low, a_high), (b_low, b_high) = window(region(method))
    far = random.uniform((a_low, b_low), (a_high, b_high), (20000, 2))
    near = (found.alpha_hat, found.beta_hat) * (1 + random.normal(0, 1e-3, (5000, 2)))
    points = np.concatenate([far, near])
    assert spectral_radius(method, *points.T).min() >= found.z_abs - 1e-9
    # the square root of eps: at a double mu a rounding of the point moves the poles by 1e-8, at ABM2's double z more
    here = float(spectral_radius(method, found.alpha_hat, found.beta_hat))
    assert here == pytest.approx(found.z_abs, abs=1e-3 if name == "ABM2" else 1e-6)


def test_without_a_stable_region_there_is_no_best_point() -> None:
    scheme = LinearMultistep((F(1), F(0), F(-1)), (F(0), F(2), F(0)))
    assert best_point(Method("leapfrog", scheme, "")) is None


@given(rationals(-F(9, 10), F(9, 10), max_denominator=20), rationals(-1, 2, max_denominator=20))
@settings(max_examples=8, deadline=None)
@pytest.mark.slow
def test_random_two_step_methods(root: Fraction, b: Fraction) -> None:
    scheme = LinearMultistep((F(1), -1 - root, root), (F(0), 1 - root - b, b))
    method = Method("random", scheme, "")
    found = best_point(method)
    if found is not None:
        (a_low, a_high), (b_low, b_high) = window(region(method))
        a, c = np.meshgrid(np.linspace(a_low, a_high, 200), np.linspace(b_low, b_high, 200))
        assert spectral_radius(method, a, c).min() >= found.z_abs - 1e-9


def test_a_small_modulus_where_poles_nearly_coincide_is_an_answer() -> None:
    root, b = F(-3, 10), F(2, 5)
    scheme = LinearMultistep((F(1), -1 - root, root), (F(0), 1 - root - b, b))
    found = best_point(Method("nearly deadbeat", scheme, ""))
    assert found
    assert found.z_abs == pytest.approx(0.0123, abs=1e-4)  # the poles at the rounded point are good to 1e-4 only


def test_a_zero_of_r_beyond_float64s_squares_is_out_of_reach() -> None:
    tableau = ((Fraction(0),) * 2, (Fraction(1, 10**200), Fraction(0)))
    far = Method("far", RungeKutta(tableau, (Fraction(0), Fraction(1))), "constructed")  # R = 1 + mu + 1e-200 mu^2
    best = best_point(far)
    assert best
    assert (best.z_abs, best.alpha_hat, best.beta_hat, best.elsewhere) == (0.0, 2.0, 1.0, ())


def test_the_repr_of_a_best_point_is_one_line() -> None:
    assert repr(best("RK2")) == "BestPoint(RK2: |z_p| = 0 at alpha_hat = 2, beta_hat = 2)"


@pytest.mark.slow
def test_a_solved_kink_above_a_sampled_modulus_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is returned is never worse than what was sampled: 1 % above, it is no answer."""
    solutions = best_points._solutions
    scheme = LinearMultistep((F(1), F(-1), F(0)), (F(0), F(8, 5), F(-3, 5)))  # of no other test: nothing is remembered

    def worse(pencil: Pencil, start: complex) -> list[best_points._Candidate]:
        return [replace(one, z_abs=1.01 * one.z_abs) for one in solutions(pencil, start)]

    monkeypatch.setattr(best_points, "_solutions", worse)
    with pytest.raises(NumericalError, match="no kink as low"):
        best_point(Method("kinked", scheme, ""))
    monkeypatch.undo()
    assert best_point(Method("kinked", scheme, ""))


def test_zeros_of_r_a_third_of_a_percent_apart_are_two_deadbeat_points() -> None:
    first, second = Fraction(3), Fraction("3.01")
    third = 1 / (1 - 1 / first - 1 / second)  # so that R'(0) = 1
    product = 1 / (first * second * third)
    pairs = (first + second + third) * product  # R = 1 + mu + pairs mu^2 + product mu^3, zero at minus the three
    zero = Fraction(0)
    tableau = ((zero, zero, zero), (product / pairs, zero, zero), (zero, pairs, zero))
    found = best_point(Method("close zeros", RungeKutta(tableau, (zero, zero, Fraction(1))), ""))
    assert found
    places = sorted([found.alpha_hat, *(alpha_hat for alpha_hat, _ in found.elsewhere)])
    assert places == pytest.approx(sorted(float(2 * zero) for zero in (first, second, third)), rel=1e-10)


NO_ZERO = {
    "bounded": RungeKutta(
        ((F(1, 2), F(0), F(0)), (F(1, 3), F(1, 2), F(0)), (F(1), F(1, 3), F(1, 2))), (F(-2, 5), F(-11, 12), F(139, 60))
    ),
    "unbounded": RungeKutta(((F(0), F(-2)), (F(1), F(121, 101))), (F(203, 424), F(221, 424))),
}


@pytest.mark.parametrize(("name", "z_abs"), [("bounded", 0.0540368), ("unbounded", 0.125147)])
def test_without_a_zero_of_r_where_mu_is_damped_the_least_value_is_on_the_edge(name: str, z_abs: float) -> None:
    """log|R| is harmonic there: it has no minimum inside. Both have |R| < 1 on a piece of the imaginary axis."""
    method = Method(name, NO_ZERO[name], "")
    found = best_point(method)
    assert found
    assert falls_towards(method) is None
    assert found.alpha_hat == 0
    modulus = modulus_of(method)
    assert float(modulus(np.zeros(1), np.array([found.beta_hat]))[0]) == pytest.approx(found.z_abs, rel=1e-9)
    on_edge = modulus(np.zeros(20001), np.linspace(1e-3, 20, 20001))
    assert found.z_abs == pytest.approx(on_edge.min(), abs=1e-5)  # samples lie 1e-3 apart
    assert found.z_abs == pytest.approx(z_abs, abs=1e-6)


def held_against_descent(method: Method) -> None:
    """The least value is attained where it is said to be, or approached and not attained; nothing found is lower."""
    modulus = modulus_of(method)
    near, far = (least_within(modulus, furthest)[0] for furthest in (1e4, 1e12))
    found, limit = best_point(method), falls_towards(method)
    if found:
        assert found.z_abs <= min(near, far) * (1 + 1e-6) + 1e-9
        # a double pole at the rounded point is known to the root of rounding, a quadruple one to its fourth root
        assert float(modulus(np.array([found.alpha_hat]), np.array([found.beta_hat]))[0]) - found.z_abs < 1e-3
    elif limit:
        assert limit.z_abs * (1 - 1e-5) - 1e-9 <= far < near
        on_the_way = [float(modulus(*(np.array([x]) for x in limit.point(t)))[0]) for t in (1e4, 1e8)]
        assert on_the_way[1] == pytest.approx(limit.z_abs, abs=1e-3)
        assert abs(on_the_way[1] - limit.z_abs) < abs(on_the_way[0] - limit.z_abs)
    else:
        assert min(near, far) > 1 - 1e-6


@pytest.mark.parametrize("number", [*range(2), *(pytest.param(k, marks=pytest.mark.slow) for k in range(2, 24))])
def test_the_least_value_of_random_implicit_runge_kutta_methods(number: int) -> None:
    held_against_descent(random_implicit_runge_kutta(number))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(1, 48, 4))
def test_the_least_value_of_random_recipes(number: int) -> None:
    held_against_descent(other_random_method(number))


def test_a_small_pole_off_the_real_axis_is_shown_where_it_lies() -> None:
    """R(mu) = 1 + mu + mu^2/2 of the midpoint rule is zero at -1 + i, with the slope i."""
    (pole,) = _meeting_poles(pencil_of(lookup("RK2")), 1e-4, np.array([-1 + 1j + 1e-4]))
    assert pole == pytest.approx(1e-4j + 0.5e-8, rel=1e-9)
