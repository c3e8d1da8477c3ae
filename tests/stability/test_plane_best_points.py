import numpy as np
import pytest

from bezstab.methods import Method, lookup, recipe
from bezstab.stability import FarLimit, Goal, best_point, choose, falls_towards, region, spectral_radius
from bezstab.stability.plane_best_points import _axis, critical_point
from bezstab.stability.plane_pencils import plane_pencil_of
from tests.reference.companion_poles import radius
from tests.reference.random_methods import other_random_method
from tests.reference.second_order_methods import as_second_order, newmark, second_order

IMPLICIT_SPRING = Method(
    "implicit spring", recipe({"x1": "x0 + v1", "v1": "v0 + acc", "acc": "acceleration(x1, v0)"}), ""
)

DEADBEAT = {
    "half": (1, 1),  # z^2 = 0 where 1 - alpha = 0 and alpha + beta = 2
    "implicit": (2, 2),  # alpha = 2, 2 beta = 4
    "kdk": (2, 2),  # (1 - alpha / 2)^2 = 0
}


@pytest.mark.parametrize("name", DEADBEAT)
def test_all_poles_are_zero_where_both_coefficients_vanish(name: str) -> None:
    best = best_point(second_order(name))
    assert best
    assert best.z_abs == 0
    assert (best.alpha_hat, best.beta_hat) == pytest.approx(DEADBEAT[name], abs=1e-12)


def test_average_acceleration_is_deadbeat_at_four() -> None:
    best = best_point(newmark("1/4", "1/4"))
    assert best
    assert (best.alpha_hat, best.beta_hat) == pytest.approx((4, 4), abs=1e-12)


def test_with_the_old_velocity_three_poles_meet() -> None:
    # 2 z^3 + (a + 2b - 4) z^2 + 2 z - a = 2 (z - p)^3 asks for 3 p^2 = 1, a = 2 p^3, 2 b = 4 - a - 6 p
    best = best_point(second_order("old"))
    assert best
    p = 3**-0.5
    assert best.z_abs == pytest.approx(p, rel=1e-12)
    assert (best.alpha_hat, best.beta_hat) == pytest.approx((2 * p**3, 2 - p**3 - 3 * p), rel=1e-11)
    assert best.multiplicity == 3


def test_with_the_predicted_velocity_three_poles_meet_at_a_negative_place() -> None:
    best = best_point(second_order("predicted"))
    assert best
    assert best.multiplicity == 3
    assert best.meeting[0].real < 0


@pytest.mark.parametrize("name", ["SYM", "RK2", "SIE", "RK4"])
def test_a_method_of_mu_written_as_second_order_has_the_same_best_point(name: str) -> None:
    by_plane, by_mu = best_point(as_second_order(name)), best_point(lookup(name))
    assert by_plane
    assert by_mu
    places = [(by_mu.alpha_hat, by_mu.beta_hat), *by_mu.elsewhere]
    assert min(np.hypot(by_plane.alpha_hat - a, by_plane.beta_hat - b) for a, b in places) < 1e-7


@pytest.mark.parametrize(
    ("method", "limit"),
    [
        (second_order("implicit euler"), FarLimit(0, (0, 1))),
        (IMPLICIT_SPRING, FarLimit(0, (0, 1))),
        (lookup("implicit-euler"), FarLimit(0, (0, 1))),
        (lookup("bdf2"), FarLimit(0, (0, 1))),
        (lookup("bdf4"), FarLimit(0, (0, 1))),
    ],
    ids=str,
)
def test_some_have_no_best_point_because_the_modulus_falls_on(method: Method, limit: FarLimit) -> None:
    assert best_point(method) is None
    assert falls_towards(method) == limit


def test_it_may_fall_along_one_ratio_of_both_parameters_alone() -> None:
    """Damping implicit, spring explicit: (1 + a) z^2 - (2 + a - b) z + 1, which tends to z^2 - (1 - b / a) z."""
    method = second_order("imex")
    assert best_point(method) is None
    limit = falls_towards(method)
    assert limit
    assert (limit.z_abs, limit.direction) == (0, (1, 1))
    assert limit.ratio == pytest.approx(1)


@pytest.mark.parametrize("goal", ["fastest", "robust"])
def test_what_is_recommended_then_is_as_strong_as_was_searched(goal: Goal) -> None:
    """Of (1 + b) z^2 - (2 - a) z + 1 - a, which is fastest where both z are (2 - a) / 2 / (1 + b)."""
    choice = choose(IMPLICIT_SPRING, goal)
    assert choice.searched == 4
    assert choice.beta_hat <= 16
    if goal == "fastest":
        alpha_hat = 8 * 17**0.5 - 32  # (2 - a)^2 = 4 (1 + b) (1 - a) with b = 16
        assert (choice.alpha_hat, choice.beta_hat) == pytest.approx((alpha_hat, 16))
        assert abs(choice.pole) == pytest.approx((2 - alpha_hat) / 34)


def test_what_has_a_best_point_falls_towards_nothing() -> None:
    assert falls_towards(second_order("half")) is None
    assert falls_towards(lookup("trapezoid")) is None


def test_far_out_it_falls_towards_more_than_its_best_point_has() -> None:
    method = lookup("generalized-alpha")
    best = best_point(method)
    assert best
    assert falls_towards(method) is None
    angle = np.linspace(0, np.pi / 2, 201)
    assert spectral_radius(method, 1e6 * np.cos(angle), 1e6 * np.sin(angle)).min() > best.z_abs


@pytest.mark.slow
@pytest.mark.parametrize("name", ["predicted", "old", "kdk", "implicit", "half"])
def test_no_point_of_a_fine_grid_is_better(name: str) -> None:
    best = best_point(second_order(name))
    assert best
    alpha_hat, beta_hat = np.meshgrid(np.linspace(1e-3, 5, 500), np.linspace(1e-3, 5, 500))
    z_abs = radius(second_order(name), alpha_hat, beta_hat)
    assert z_abs.min() >= best.z_abs


@pytest.mark.slow
def test_the_least_value_along_a_curve_of_double_poles_is_found() -> None:
    """Of Yoshida's composition: both poles are real and equal, and P's gradients in the plane are parallel there."""
    best = best_point(lookup("yoshida4"))
    assert best
    around = np.concatenate([-np.geomspace(1e-9, 1e-2, 40), [0], np.geomspace(1e-9, 1e-2, 40)])
    alpha_hat, beta_hat = np.meshgrid(best.alpha_hat + around, best.beta_hat + around)
    nearby = radius(lookup("yoshida4"), alpha_hat, beta_hat)
    assert nearby.min() >= best.z_abs * (1 - 1e-7)  # a double pole is known to the root of rounding
    assert best.z_abs == pytest.approx(nearby[40, 40], rel=1e-6)
    assert len(best.meeting) == 1


@pytest.mark.slow
def test_three_poles_of_one_modulus_are_solved_for_as_far_as_their_moduli_are_known() -> None:
    """Of this recipe more than 1e-13 is left of the equations, by rounding: a bound as tight would find nothing."""
    method = other_random_method(277)
    best = best_point(method)
    assert best
    assert len(best.meeting) == 2
    around = np.linspace(-0.01, 0.01, 201)
    nearby = spectral_radius(method, best.alpha_hat + around, best.beta_hat + around[:, np.newaxis])
    assert best.z_abs == pytest.approx(nearby.min(), rel=1e-12)  # it is the middle of the grid


@pytest.mark.parametrize(("name", "place"), [("half", (1, 1)), ("old", (2 * 3**-1.5, 2 - 3**-1.5 - 3**0.5))])
def test_the_double_pole_is_followed_down_to_where_it_ends(name: str, place: tuple[float, float]) -> None:
    found = critical_point(plane_pencil_of(second_order(name)), (8.0, 16.0))
    assert found == pytest.approx(place, rel=1e-6)
    z_abs = float(spectral_radius(second_order(name), *found)) if found else np.nan
    assert z_abs < 0.578


def test_a_pole_that_nothing_moves_stays_and_hides_nothing() -> None:
    equations = {"a1": "acceleration(x0, v0)", "v1": "v0 + a1", "x1": "x0 + v1", "u": "1/2 u[0] + 1/2 x1"}
    method = Method("beside", recipe(equations), "")  # symplectic Euler, and a helper that follows x by halves
    best = best_point(method)
    assert best
    assert (best.z_abs, best.fixed) == (0.5, 0.5)
    assert (best.alpha_hat, best.beta_hat) == pytest.approx((1, 1))
    assert region(method).area == pytest.approx(4)
    assert region(method, 0.6).area == pytest.approx(region(lookup("SYM"), 0.6).area)
    assert region(method, 0.4).extent is None
    assert choose(method, "fastest").alpha_hat == pytest.approx(1)


def test_where_least_values_lie_a_grid_has_no_wide_gaps_however_far_it_goes() -> None:
    axis = _axis(1e4, 121)
    assert axis[-1] == pytest.approx(1e4)
    assert np.diff(axis[axis <= 8]).max() < 0.11
