"""Figures of the plane: what their artists hold is what was given, contours are where they are said to be."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.contour import QuadContourSet

from bezstab.engines.engine_list import ENGINES
from bezstab.methods.registry import lookup
from bezstab.regions.answer import MapConditions, MapSetup, map_answer, map_conditions
from bezstab.regions.figure import comparison_figure, map_figure
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.forced_errors import combined_error
from bezstab.stability.regions import region
from tests.show.drawn import lines_of

F = Fraction


def drawn_map(name: str, **asked: Any) -> Axes:
    return map_figure(map_answer(lookup(name), map_conditions(MapSetup(**{"points": 21, **asked})), drawn=True)).axes[0]


def starting(axes: Axes, words: str) -> list[str]:
    """Return the labels of a legend that start so."""
    return [label for label in lines_of(axes) if label.startswith(words)]


def test_a_map_draws_what_it_is_given_in_the_units_of_the_step() -> None:
    scale = np.array([1e3, 1e6])
    asked = map_conditions(MapSetup(h=F("0.001"), levels=(0.75, 0.9), points=41))
    answer = map_answer(lookup("B4"), replace(asked, marks={"a rule": (0.1, 0.2)}), drawn=True)
    assert answer.drawing
    z_abs = np.abs(answer.drawing.z)
    axes = map_figure(answer).axes[0]
    (image,) = axes.images
    assert np.ma.masked_array(image.get_array()).filled(1).tolist() == np.where(z_abs < 1, z_abs, 1).tolist()
    lines = lines_of(axes)
    for words, point in {"least $|z_p|$": answer.regions[0].best, "choose": answer.chosen, "a rule": None}.items():
        (label,) = starting(axes, words)
        place = (point.alpha_hat, point.beta_hat) if point else (0.1, 0.2)
        assert lines[label][0] == pytest.approx(np.array(place) * scale)
    (critical,) = starting(axes, "critical damping")
    assert lines[critical][:, 1] == pytest.approx(lines[critical][:, 0] ** 2 / 4)  # beta^2 = (2 alpha)^2/4, any unit
    assert "1/s" in axes.get_xlabel()
    for shape in (answer.regions[0].region, *answer.drawing.faster):
        assert lines[f"$|z_p| = {shape.level:g}$"][:-1] == pytest.approx(shape.boundary[0] * scale)


def test_a_comparison_draws_each_boundary_in_a_given_window() -> None:
    methods = lookup("B4"), lookup("RK4@5")
    asked = MapConditions(h=F("0.001"), alpha_range=(0.0, 1.0), beta_range=(0.0, 0.5))
    axes = comparison_figure(list(map(region, methods)), asked).axes[0]
    for line, method in zip(axes.lines[:2], methods, strict=True):
        assert np.array(line.get_xydata())[:-1] == pytest.approx(region(method).boundary[0] * [1e3, 1e6])
    assert (*axes.get_xlim(), *axes.get_ylim()) == pytest.approx((0, 1e3, 0, 0.5e6))


def test_arrows_stand_along_the_edges_beyond_which_a_region_goes_on() -> None:
    """hht's goes on to either side of a valley, that of verlet-implicit to the right alone; RK4's ends."""
    regions = [region(lookup(name)) for name in ("RK4", "hht", "verlet-implicit")]
    arrows = comparison_figure(regions, MapConditions(h=F("0.01"))).axes[0].lines[len(regions) :]
    assert [line.get_marker() for line in arrows] == [">", "^", ">"]


def test_in_an_engine_the_point_says_that_constraints_are_not_many() -> None:
    assert starting(drawn_map("SYM", h=F("1/60"), engine=ENGINES["ode"]), "choose robust, one constraint:")


def test_what_is_not_in_the_window_is_named_as_such_and_not_drawn() -> None:
    window: dict[str, Any] = {"alpha_range": (0.0, 0.5), "beta_range": (0.1, 1.0)}
    axes = drawn_map("SYM", levels=(0.9, 0.3), **window)
    assert starting(axes, "$|z_p| = 0.9$")  # a chord crosses the window, whose ends are outside
    (missing,) = starting(axes, "nowhere")
    for name in ("$|z_p| = 0.3$", "critical damping", "deadbeat", "choose"):
        assert name in missing
        assert not starting(axes, name)
    assert all(line.count("$") % 2 == 0 for line in missing.splitlines())  # none ends in a formula


@pytest.mark.slow
def test_of_a_scene_that_moves_words_and_point_are_those_at_rest() -> None:
    axes = drawn_map("B4", h=F("0.005"), scene="driven_four_bar")
    assert {text.get_text() for text in axes.texts} == {"stable at rest", "diverges at rest"}
    assert starting(axes, "choose at rest")


@pytest.mark.parametrize(("name", "words"), [("SYM", {"stable", "diverges"}), ("implicit-euler", {"stable"})])
def test_a_map_says_where_errors_decay_and_where_they_grow(name: str, words: set[str]) -> None:
    """Each word stands in its area."""
    axes = drawn_map(name, points=41)
    assert {text.get_text() for text in axes.texts} == words
    for text in axes.texts:
        point = axes.transLimits.inverted().transform(text.get_position())
        assert (spectral_radius(lookup(name), *point) < 1) == (text.get_text() == "stable")


# On a motion

OMEGA_H = F(1, 100)
"""As usual where no motion is named."""


def test_each_contour_is_where_the_error_is_its_power_of_ten_and_every_second_is_drawn() -> None:
    window: dict[str, Any] = {"alpha_range": (2e-3, 6.0), "beta_range": (1e-6, 9.0)}
    axes = drawn_map("RK4", accuracy=True, levels=(0.99,), points=61, **window)
    mesh, errors, level = axes.collections
    assert isinstance(errors, QuadContourSet)
    assert np.ma.masked_array(mesh.get_array()).max() < 1  # what diverges has no colour
    paths = zip(errors.levels, errors.get_paths(), strict=True)
    drawn = [(power, np.transpose(path.vertices)) for power, path in paths if np.size(path.vertices)]
    assert [power for power, _ in drawn] == list(range(-10, 0, 2))
    for power, (alpha_hat, beta_hat) in drawn[:-1]:  # nearer to the boundary the grid is too coarse
        assert np.median(abs(np.log10(combined_error(lookup("RK4"), alpha_hat, beta_hat, OMEGA_H)) - power)) < 0.02
    (path,) = level.get_paths()
    assert np.median(abs(spectral_radius(lookup("RK4"), *np.asarray(path.vertices).T) - 0.99)) < 1e-3


def test_labels_of_contours_stand_apart() -> None:
    """Where gain turns into loss at once, lines of both run side by side; RK4's +10^-10 and -10^-10 do."""
    answer = map_answer(lookup("RK4"), map_conditions(MapSetup(points=21, energy=True)), drawn=True)
    assert answer.drawing
    growth = np.tile(np.sinh(np.linspace(-20, 20, 21)) * 1e-12, (21, 1))
    figure = map_figure(replace(answer, drawing=replace(answer.drawing, growth=growth)))
    figure.draw_without_rendering()
    places = [text.get_window_extent() for text in figure.axes[0].texts]
    assert len(places) > 1
    assert not any(place.count_overlaps(places[:number]) for number, place in enumerate(places))


def test_energy_is_kept_on_the_line_that_says_so() -> None:
    """Of symplectic Euler it is to first order in h beta^2 = omega^2 - 4 alpha^2: b = (omega h)^2 - a^2."""
    contours = drawn_map("SYM", energy=True, points=61).collections
    (kept,) = (each for each in contours if isinstance(each, QuadContourSet) and list(each.levels) == [0.0])
    alpha_hat, beta_hat = np.asarray(kept.get_paths()[0].vertices).T
    assert beta_hat[alpha_hat < 0.009] == pytest.approx((1e-4 - alpha_hat**2)[alpha_hat < 0.009], rel=0.1)
