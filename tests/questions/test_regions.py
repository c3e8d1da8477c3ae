from fractions import Fraction

import pytest

from bezstab.engines import ENGINES
from bezstab.methods import lookup
from bezstab.questions import MapAnswer, MapQuestion, forced_errors_of, motion_of, region_answer
from bezstab.stability import combined_error, spectral_radius


def test_the_best_point_is_inside_only_where_z_is_that_small() -> None:
    question = MapQuestion(points=2, methods=(lookup("B4"),), levels=(Fraction(1), Fraction(1, 2)))
    stable, faster = MapAnswer(question, lookup("B4")).regions
    assert stable.best == faster.best
    assert stable.best
    assert stable.best.z_abs > 0.5
    assert stable.inside == stable.best
    assert faster.inside is None
    (level,) = stable.faster_levels
    assert stable.best.z_abs < level < 1


@pytest.mark.parametrize("name", ["B4", "gauss4", "verlet-kdk"])
def test_the_window_holds_the_best_point(name: str) -> None:
    answer = region_answer(lookup(name))
    (_, alpha_hat_max), (_, beta_hat_max) = answer.window
    if answer.best:
        assert answer.best.alpha_hat <= alpha_hat_max
        assert answer.best.beta_hat <= beta_hat_max


def test_symplectic_euler_has_its_triangle_to_tell() -> None:
    answer = region_answer(lookup("SYM"))
    assert (answer.stable_for_all, answer.unconditional_damping_ratio) == ("no", None)
    assert answer.critical_damping_limit == pytest.approx(8**0.5 - 2)  # beta h with 2 alpha_hat + beta_hat = 4


def test_the_most_accurate_point_forces_less_than_the_fastest() -> None:
    forced = forced_errors_of(lookup("RK4"), motion_of(None, None, Fraction(1), None))
    assert forced.chosen
    assert forced.best
    assert forced.accurate_error
    assert forced.best_error
    assert forced.accurate_error < forced.best_error
    fastest = forced.best.alpha_hat, forced.best.beta_hat
    assert forced.best_error == float(combined_error(lookup("RK4"), *fastest, Fraction(1, 100)))
    assert all(low > 0 for low, _ in forced.window)


def test_the_marks_of_an_engine_are_stable_points_with_its_own_method() -> None:
    for point in MapQuestion(points=2, engine=ENGINES["box2d"], h=Fraction(1, 60)).marks.values():
        assert spectral_radius(lookup("SYM"), *point) < 1
