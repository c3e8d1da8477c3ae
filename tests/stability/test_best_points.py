from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.stability.best_points import BestPoint, FarLimit, best_point, falls_towards
from bezstab.stability.closed_loop import converges, poles, spectral_radius
from bezstab.stability.regions import region, window
from tests.methods.kinds import EXPLICIT, sampled
from tests.reference.least_by_descent import least_within
from tests.reference.made_methods import multistep
from tests.reference.random_methods import other_random_method, random_implicit_runge_kutta, random_method
from tests.reference.second_order_methods import as_second_order

F = Fraction
P = 3**-0.5


def best(method: Method) -> BestPoint:
    found = best_point(method)
    assert found is not None
    return found


def places(found: BestPoint) -> list[tuple[float, float]]:
    return [(found.alpha_hat, found.beta_hat), *found.elsewhere]


@pytest.mark.parametrize(("name", "squared"), [("AB3", 11 / 23), ("B4", (66 + 5056**0.5) / 350)])
def test_the_kink_where_two_opposite_real_roots_meet(name: str, squared: float) -> None:
    """By hand: a zero of the even part of (p - 1) |sigma|(p), for B4 of 350p^4 - 132p^2 - 2."""
    found = best(lookup(name))
    assert found.z_abs == pytest.approx(squared**0.5, rel=1e-12)
    assert not region(lookup(name), found.z_abs - 1e-6).area
    assert region(lookup(name), found.z_abs + 1e-6).area


@pytest.mark.parametrize("name", sampled([*EXPLICIT, "B4@2"]))
@pytest.mark.slow
def test_nothing_in_the_plane_is_faster(name: str) -> None:
    method, found, random = lookup(name), best(lookup(name)), np.random.default_rng(5)
    (a_low, a_high), (b_low, b_high) = window(region(method))
    far = random.uniform((a_low, b_low), (a_high, b_high), (20000, 2))
    near = (found.alpha_hat, found.beta_hat) * (1 + random.normal(0, 1e-3, (5000, 2)))
    assert spectral_radius(method, *np.concatenate([far, near]).T).min() >= found.z_abs - 1e-9
    # the square root of eps: at a double mu a rounding of the point moves the poles by 1e-8, at ABM2's double z more
    here = float(spectral_radius(method, found.alpha_hat, found.beta_hat))
    assert here == pytest.approx(found.z_abs, abs=1e-3 if name == "ABM2" else 1e-6)


@pytest.mark.parametrize("name", ["RK4", pytest.param("AB3@2", marks=pytest.mark.slow)])
def test_a_recipe_that_spells_out_a_method_has_its_best_point(name: str) -> None:
    """Of the first all poles are zero, of the other poles of P are double along curves at a slant."""
    of_recipe, of_method = best(as_second_order(name)), best(lookup(name))
    assert of_recipe.z_abs == pytest.approx(of_method.z_abs, rel=1e-7)
    offsets = np.array(places(of_method)) - places(of_recipe)[0]
    assert np.abs(offsets).max(axis=1).min() < (1e-5 if of_method.z_abs else 1e-7)


@pytest.mark.parametrize("name", ["B2", "AB2"])
def test_along_an_arc_the_most_damped_end_is_taken(name: str) -> None:
    """|z_p| is 3^(-1/2) for alpha_hat from 4/9 to 4/3 at beta_hat = 4/9."""
    found = best(lookup(name))
    assert found.z_abs == pytest.approx(3**-0.5, rel=1e-13)
    assert places(found) == [pytest.approx((4 / 3, 4 / 9), abs=1e-10)]


@pytest.mark.parametrize(
    ("method", "points"),
    [
        (lookup("radau3"), [(6, 9)]),  # R has a numerator of lower degree
        (lookup("RK2"), [(2, 2)]),
        (lookup("SYM"), [(1, 1)]),
        (lookup("RK4@5"), np.array([(3.45888846213, 3.78125278982), (0.541111537865, 6.34710275518)]) / (5, 25)),
        (lookup("verlet-half"), [(1, 1)]),  # z^2 = 0 where 1 - alpha = 0 and alpha + beta = 2
        (lookup("verlet-kdk"), [(2, 2)]),  # (1 - alpha / 2)^2 = 0
        (lookup("average-acceleration"), [(4, 4)]),
    ],
    ids=str,
)
def test_where_every_pole_is_zero(method: Method, points: list[tuple[float, float]]) -> None:
    found = best(method)
    assert found.z_abs == 0
    # of (1 - alpha / 2)^2 rounding leaves half the digits
    assert np.array(places(found)) == pytest.approx(np.array(points), abs=1e-8 if "kdk" in method.name else 1e-10)
    assert float(spectral_radius(method, found.alpha_hat, found.beta_hat)) < 1e-7  # simple zeros, to rounding


@pytest.mark.slow
def test_multiple_poles_may_be_the_least() -> None:
    """ABM2's are a double root of pi. With the old velocity 2 z^3 + (a + 2b - 4) z^2 + 2 z - a = 2 (z - p)^3 asks for
    3 p^2 = 1, a = 2 p^3, 2 b = 4 - a - 6 p; with the predicted one three meet at a negative place."""
    of_pi, old, predicted = best(lookup("ABM2")), best(lookup("verlet-old")), best(lookup("verlet-predicted"))
    assert (of_pi.z_abs, of_pi.alpha_hat, of_pi.beta_hat) == pytest.approx((1 / 3, 4 / 3, 4 / 9), rel=1e-7)
    assert old.z_abs == pytest.approx(P, rel=1e-12)
    assert (old.alpha_hat, old.beta_hat) == pytest.approx((2 * P**3, 2 - P**3 - 3 * P), rel=1e-11)
    assert [old.z_abs, predicted.z_abs] == pytest.approx([P, 0.455410041101], rel=1e-11)
    assert poles(lookup("verlet-predicted"), predicted.alpha_hat, predicted.beta_hat).real.max() < 0


def test_where_all_poles_are_zero_with_negative_damping_nobody_is_sent() -> None:
    """R has zeros on either side of the imaginary axis."""
    found = best(lookup("dopri5"))
    assert found.z_abs == 0
    assert all(alpha_hat > 0 for alpha_hat, _ in places(found))


def test_a_sharp_valley_is_narrowed_to_its_floor() -> None:
    """Of a recipe, beside whose best point |z_p| rises like a root: a stretch of 4e-10 is 7e-7 above it."""
    method, least = other_random_method(25), F("0.4568747")
    assert converges(method, F("0.22893125215410917"), F("0.13500461107509398"), least)  # proven: it is lower there
    assert best(method).z_abs < least


IMPLICIT_SPRING = Method(
    "implicit spring", recipe({"x1": "x0 + v1", "v1": "v0 + acc", "acc": "acceleration(x1, v0)"}), ""
)
FALLING = [IMPLICIT_SPRING, lookup("implicit-euler"), lookup("bdf4")]


@pytest.mark.parametrize("method", FALLING, ids=str)
def test_some_have_no_best_point_because_the_modulus_falls_on(method: Method) -> None:
    assert best_point(method) is None
    assert falls_towards(method) == FarLimit(0, (0, 1))


def test_it_may_fall_along_one_ratio_of_both_parameters_alone() -> None:
    """Damping implicit, spring explicit: (1 + a) z^2 - (2 + a - b) z + 1, which tends to z^2 - (1 - b / a) z."""
    limit = falls_towards(lookup("imex-euler"))
    assert limit
    assert (limit.z_abs, limit.direction) == (0, (1, 1))
    assert limit.ratio == pytest.approx(1)


@pytest.mark.slow
def test_without_a_stable_region_there_is_no_best_point() -> None:
    leapfrog = multistep("leapfrog", "1 0 -1", "0 2 0")
    assert (best_point(leapfrog), falls_towards(leapfrog)) == (None, None)


DRAWN = [
    *(pytest.param(random_implicit_runge_kutta, k, marks=[] if k < 2 else pytest.mark.slow) for k in range(24)),
    *(pytest.param(other_random_method, k, marks=pytest.mark.slow) for k in range(1, 48, 4)),
    # |z_p| is least at alpha_hat = -0.06 and -3.1; a grid of points misses the curved valley of the others
    *(pytest.param(random_method, k, marks=pytest.mark.slow) for k in (134, 250, 205, 220)),
]


def on_way(limit: FarLimit, t: float) -> tuple[float, float]:
    """Return alpha_hat and beta_hat at t > 0 of the way to a limit."""
    (p, q), ratio = limit.direction, limit.ratio or 1.0
    return (t**p, 1 / ratio) if q == 0 else (ratio ** (1 / q) * t**p, t**q)


@pytest.mark.parametrize(("draw", "number"), DRAWN)
def test_the_least_value_of_random_methods(draw: Callable[[int], Method], number: int) -> None:
    """It is attained where it is said to be, or approached and not attained; nothing found by descent is lower."""
    method = draw(number)
    near, far = (least_within(method, furthest) for furthest in (1e4, 1e12))
    found, limit = best_point(method), falls_towards(method)
    if found:
        assert min(found.alpha_hat, found.beta_hat) >= 0
        assert limit is None
        assert found.z_abs <= min(near, far) * (1 + 1e-6) + 1e-9
        # a double pole at the rounded point is known to the root of rounding, a quadruple one to its fourth root
        assert float(spectral_radius(method, found.alpha_hat, found.beta_hat)) - found.z_abs < 1e-3
    elif limit:
        assert limit.z_abs * (1 - 1e-5) - 1e-9 <= far < near
        on_the_way = [float(spectral_radius(method, *on_way(limit, t))) for t in (1e4, 1e8)]
        assert on_the_way[1] == pytest.approx(limit.z_abs, abs=1e-3)
        assert abs(on_the_way[1] - limit.z_abs) < abs(on_the_way[0] - limit.z_abs)
    else:
        assert min(near, far) > 1 - 1e-6


def test_the_best_point_of_a_region_without_end_may_lie_far_beyond_what_is_seen_of_it() -> None:
    """At mu = -x the two z have z_1 z_2 = r_0 / (1 + s_2 x), which falls until they meet; then one grows."""
    method = multistep("far", "1 -371/200 171/200", "2/11 -81/2200 0")
    r_1, r_0, s_2, s_1 = -371 / 200, 171 / 200, 2 / 11, -81 / 2200
    x = np.roots([s_1**2, 2 * r_1 * s_1 - 4 * r_0 * s_2, r_1**2 - 4 * r_0]).max()
    found = best(method)
    assert found.z_abs == pytest.approx(np.sqrt(r_0 / (1 + s_2 * x)), rel=1e-7)
    assert (found.alpha_hat, found.beta_hat) == pytest.approx((2 * x, x**2), rel=1e-6)


def test_what_is_almost_reached_far_out_is_no_best_point() -> None:
    """z = (1 + 9/11 x) / (1 + 20/11 x) at mu = -x falls towards 9/20."""
    method = multistep("theta", "1 -1", "20/11 -9/11")
    assert best_point(method) is None
    limit = falls_towards(method)
    assert limit
    assert limit.z_abs == pytest.approx(0.45, rel=1e-12)
