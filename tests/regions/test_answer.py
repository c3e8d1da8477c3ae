from fractions import Fraction
from typing import Any

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.feedback.choosing import choose
from bezstab.methods.registry import lookup
from bezstab.regions.answer import MapAnswer, MapSetup, map_answer, map_conditions, moving_regions
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import combined_error
from bezstab.stability.regions import region
from bezstab.stability.turning import moving_pole


def answer_about(name: str, **asked: Any) -> MapAnswer:
    return map_answer(lookup(name), map_conditions(MapSetup(points=2, **asked)), drawn=True)


def test_the_best_point_is_inside_only_where_z_is_that_small() -> None:
    stable, faster = answer_about("B4", levels=(1.0, 0.5)).regions
    assert stable.best
    assert stable.best.z_abs > 0.5
    assert (stable.inside, faster.best, faster.inside) == (stable.best, stable.best, None)


@pytest.mark.parametrize("name", ["B4", "average-acceleration"])
def test_a_map_holds_the_best_point_and_marks_that_of_choose(name: str) -> None:
    answer = answer_about(name)
    assert answer.drawing
    assert answer.chosen
    if best := answer.regions[0].best:
        assert best.alpha_hat <= answer.drawing.alpha_hat[-1]
        assert best.beta_hat <= answer.drawing.beta_hat[-1]
        (level,) = answer.drawing.levels
        assert best.z_abs < level < 1
    assert answer.chosen.point == choose(name, margins=False, cost=False).point


@pytest.mark.parametrize("name", ["SYM", pytest.param("verlet-old", marks=pytest.mark.slow)])
def test_the_region_of_a_moving_mechanism_shrinks_with_its_speed_from_that_at_rest(name: str) -> None:
    method = lookup(name)
    moving = moving_regions(method)
    assert moving.area(0.0) == pytest.approx(region(method).area, rel=5e-3)  # by cells of a three hundredth
    areas = [moving.area(turned) for turned in (0.0, 0.01, 0.05, 0.1)]
    assert areas == sorted(areas, reverse=True)
    assert areas[-1] == 0  # nothing is settled beyond
    for row, column in ((100, 100), (150, 40), (20, 200)):
        pole = moving_pole(method, 0.03, 1.0, float(moving.alpha_hat[column]), float(moving.beta_hat[row]))
        assert (pole.verdict == "converges") == (moving.turn_limits[row, column] > 0.03)


def test_of_a_motion_the_most_accurate_point_forces_less_than_the_fastest() -> None:
    forced = answer_about("RK4", accuracy=True)
    best, (fastest, accurate) = forced.regions[0].best, forced.on_motion
    assert best
    assert accurate.error < fastest.error
    assert fastest.error == float(combined_error(lookup("RK4"), best.alpha_hat, best.beta_hat, Fraction(1, 100)))


def test_the_marks_of_an_engine_are_stable_points_with_its_own_method() -> None:
    for point in map_conditions(MapSetup(engine=ENGINES["box2d"], h=Fraction(1, 60))).marks.values():
        assert spectral_radius(lookup("SYM"), *point) < 1
