from fractions import Fraction
from typing import Any

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.methods.registry import lookup
from bezstab.regions.answer import MapAnswer, map_answer, map_conditions, moving_regions, region_answer
from bezstab.regions.columns import REGION
from bezstab.show.columns import row_of
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import combined_error
from bezstab.stability.regions import region
from bezstab.stability.turning import moving_pole


def answer_about(name: str, **asked: Any) -> MapAnswer:
    return map_answer(lookup(name), map_conditions(points=2, **asked), drawn=True)


def test_the_best_point_is_inside_only_where_z_is_that_small() -> None:
    stable, faster = answer_about("B4", levels=(Fraction(1), Fraction(1, 2))).regions
    assert stable.best == faster.best
    assert stable.best
    assert stable.best.z_abs > 0.5
    assert stable.inside == stable.best
    assert faster.inside is None
    drawing = answer_about("B4").drawing
    assert drawing
    (level,) = drawing.levels
    assert stable.best.z_abs < level < 1


@pytest.mark.parametrize(
    "name", ["SYM", *(pytest.param(name, marks=pytest.mark.slow) for name in ("B4", "verlet-old"))]
)
def test_the_region_of_a_moving_mechanism_shrinks_with_its_speed_from_that_at_rest(name: str) -> None:
    method = lookup(name)
    moving, at_rest = moving_regions(method), region(method).area
    assert at_rest
    assert moving.area(0.0) == pytest.approx(at_rest, rel=5e-3)  # by cells of a three hundredth
    areas = [moving.area(turned) for turned in (0.0, 0.01, 0.05, 0.1)]
    assert areas == sorted(areas, reverse=True)
    assert areas[-1] == 0  # nothing is settled beyond
    for row, column in ((100, 100), (150, 40), (20, 200)):
        at = float(moving.alpha_hat[column]), float(moving.beta_hat[row])
        pole = moving_pole(method, 0.03, 1.0, *at)
        assert (pole.verdict == "converges") == (moving.turn_limits[row, column] > 0.03)


@pytest.mark.parametrize("name", ["B4", "gauss4", "verlet-kdk"])
def test_the_window_holds_the_best_point(name: str) -> None:
    answer = answer_about(name)
    assert answer.drawing
    if best := answer.regions[0].best:
        assert best.alpha_hat <= answer.drawing.alpha_hat[-1]
        assert best.beta_hat <= answer.drawing.beta_hat[-1]


def test_symplectic_euler_has_its_triangle_to_tell() -> None:
    answer = region_answer(lookup("SYM"))
    assert (answer.stable_for_all, answer.unconditional_damping_ratio) == ("no", None)
    assert answer.critical_damping_limit == pytest.approx(8**0.5 - 2)  # beta h with 2 alpha_hat + beta_hat = 4


def test_the_most_accurate_point_forces_less_than_the_fastest() -> None:
    forced = answer_about("RK4", accuracy=True)
    best = forced.regions[0].best
    assert best
    assert forced.drawing
    fastest, accurate = forced.on_motion
    assert accurate.error < fastest.error
    assert (fastest.alpha_hat, fastest.beta_hat) == (best.alpha_hat, best.beta_hat)
    assert fastest.error == float(combined_error(lookup("RK4"), best.alpha_hat, best.beta_hat, Fraction(1, 100)))
    assert min(forced.drawing.alpha_hat[0], forced.drawing.beta_hat[0]) > 0


def test_the_marks_of_an_engine_are_stable_points_with_its_own_method() -> None:
    for point in map_conditions(engine=ENGINES["box2d"], h=Fraction(1, 60)).marks.values():
        assert spectral_radius(lookup("SYM"), *point) < 1


@pytest.mark.slow
def test_limits_that_a_region_does_not_have_are_said_in_words() -> None:
    answer = region_answer(lookup("bdf3"))
    row = row_of(REGION, answer)
    assert [row[key] for key in ("area", "alpha_hat_range", "beta_hat_range")] == [None, [0, None], [0, None]]
    words = {each.heading: each.text(answer) for each in REGION}
    shown = [words[heading] for heading in ("area", "α̂", "β̂", "βh to (α = β)")]
    assert shown == ["unbounded", "0 to unbounded", "0 to unbounded", "unlimited"]
    assert row["unconditional_damping_ratio"] == pytest.approx(0.06919293)
