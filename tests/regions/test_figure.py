"""Figures of the plane: what their artists hold is what was given."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import QuadMesh

from bezstab.engines.engine_list import ENGINES
from bezstab.feedback.choosing import choose
from bezstab.methods.registry import lookup
from bezstab.regions.answer import map_answer, map_conditions
from bezstab.regions.figure import comparison_figure, map_figure
from bezstab.stability.closed_loop import spectral_radius
from bezstab.stability.regions import region
from tests.show.drawn import lines_of


@pytest.mark.parametrize(("accuracy", "h"), [(False, None), (True, Fraction("0.001"))])
def test_a_map_draws_what_it_is_given(accuracy: bool, h: Fraction | None) -> None:
    """On even axes, and on logarithmic ones where errors are asked about."""
    method, scale = lookup("B4"), np.array([1, 1] if h is None else [1e3, 1e6])
    levels = () if accuracy else (Fraction("0.75"), Fraction("0.9"))
    asked = map_conditions(h=h, accuracy=accuracy, levels=levels, points=41)
    marks = {"a rule": (0.1, 0.2), "far out": (3.0, 3.0)}
    answer = map_answer(method, replace(asked, marks=marks), drawn=True)
    assert answer.drawing
    z, alpha_hat, beta_hat = answer.drawing.z, answer.drawing.alpha_hat, answer.drawing.beta_hat
    axes = map_figure(answer).axes[0]
    (image,) = axes.images or [each for each in axes.collections if isinstance(each, QuadMesh)]
    values = np.ma.masked_array(image.get_array())
    assert (np.ma.getmaskarray(values) == (np.abs(z) >= 1)).all()
    assert values.compressed().tolist() == np.abs(z)[np.abs(z) < 1].tolist()
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    assert [low, high] == pytest.approx(np.transpose([alpha_hat, beta_hat])[[0, -1]] * scale)
    lines = lines_of(axes)
    best, chosen = answer.regions[0].best, answer.chosen
    assert best
    assert chosen
    where = "" if accuracy else r" at $\omega h = 0.01$"
    for label, point in {
        "least $|z_p|$: 0.6259": (best.alpha_hat, best.beta_hat),
        rf"choose{where}: $|z_p| = {abs(chosen.pole):.4g}$": (chosen.alpha_hat, chosen.beta_hat),
        "a rule": (0.1, 0.2),
    }.items():
        assert lines[label][0] == pytest.approx(np.array(point) * scale)
    assert "far out" not in lines
    (parabola,) = (points for label, points in lines.items() if label.startswith("critical damping"))
    assert parabola[:, 1] == pytest.approx(parabola[:, 0] ** 2 / 4)  # beta^2 = (2 alpha)^2/4 in either unit
    assert ("1/s" in axes.get_xlabel()) == (h is not None)
    if not accuracy:  # nodes are at the centres of pixels
        for drawn in (answer.regions[0].region, *answer.drawing.faster):
            assert lines[f"$|z_p| = {drawn.level:g}$"][:-1] == pytest.approx(drawn.boundary[0] * scale)
        left, right, *_ = axes.images[0].get_extent()
        step = (alpha_hat[1] - alpha_hat[0]) * scale[0]
        assert (left + step / 2, right - step / 2) == pytest.approx((alpha_hat[0] * scale[0], alpha_hat[-1] * scale[0]))


def test_a_comparison_draws_each_boundary_in_a_given_window_or_in_alpha_and_beta() -> None:
    methods = lookup("B4"), lookup("RK4@5")
    ends: dict[str, Any] = {"alpha_range": (Fraction(0), Fraction(1)), "beta_range": (Fraction(0), Fraction("0.5"))}
    axes = comparison_figure(list(map(region, methods)), map_conditions(h=Fraction("0.001"), **ends)).axes[0]
    for line, method in zip(axes.lines[:2], methods, strict=True):
        assert np.array(line.get_xydata())[:-1] == pytest.approx(region(method).boundary[0] * [1e3, 1e6])
    assert (*axes.get_xlim(), *axes.get_ylim()) == pytest.approx((0, 1e3, 0, 0.5e6))
    (axes,) = comparison_figure([region(methods[0])], map_conditions(h=Fraction("0.001"), alpha_beta=True)).axes
    for ticks, labels, power, scale in (
        (axes.get_xticks(), axes.get_xticklabels(), 1, 2),  # at 2 alpha
        (axes.get_yticks(), axes.get_yticklabels(), 2, 1),  # at beta^2
    ):
        assert len(ticks) > 2
        assert ticks == pytest.approx([scale * float(label.get_text()) ** power for label in labels])
    heights = [axes.transData.transform((0, tick))[1] for tick in axes.get_yticks()]
    assert np.diff(heights) == pytest.approx(heights[1] - heights[0])  # even in beta


def test_in_alpha_and_beta_critical_damping_is_straight() -> None:
    asked = map_conditions(h=Fraction("0.001"), alpha_beta=True, points=21)
    answer = map_answer(lookup("SYM"), asked, drawn=True)
    axes = map_figure(answer).axes[0]
    (line,) = (points for label, points in lines_of(axes).items() if label.startswith("critical damping"))
    across, up = axes.transData.transform(line).T
    slope = (up[-1] - up[0]) / (across[-1] - across[0])
    assert up - up[0] == pytest.approx(slope * (across - across[0]), abs=0.002 * (up[-1] - up[0]))
    assert answer.drawing
    assert np.diff(np.sqrt(answer.drawing.beta_hat)) == pytest.approx(np.sqrt(answer.drawing.beta_hat[-1]) / 20)


@pytest.mark.parametrize("name", ["SYM", "B4"])
def test_a_map_marks_the_point_of_choose(name: str) -> None:
    method = lookup(name)
    marked = map_answer(method, map_conditions(points=2), drawn=True).chosen
    assert marked
    assert marked.point == choose(name, margins=False, cost=False).point


def test_in_an_engine_the_point_is_on_its_curve_and_says_that_constraints_are_not_many() -> None:
    answer = map_answer(lookup("SYM"), map_conditions(h=Fraction("1/60"), engine=ENGINES["ode"], points=2), drawn=True)
    assert answer.chosen
    assert (answer.chosen.goal, answer.chosen.alpha_hat) == ("robust", 1)  # ERP alone: alpha_hat = 1
    assert any(label.startswith("choose robust, one constraint:") for label in lines_of(map_figure(answer).axes[0]))


def test_what_is_not_in_the_window_is_named_as_such_and_not_drawn() -> None:
    window: dict[str, Any] = {
        "alpha_range": (Fraction(0), Fraction("0.5")),
        "beta_range": (Fraction("0.1"), Fraction(1)),
    }
    asked = map_conditions(levels=(Fraction("0.9"), Fraction("0.3")), points=21, **window)
    labels = list(lines_of(map_figure(map_answer(lookup("SYM"), asked, drawn=True)).axes[0]))
    assert "$|z_p| = 0.9$" in labels  # a chord crosses the window, whose ends are outside
    (missing,) = (label for label in labels if label.startswith("nowhere"))
    for name in ("$|z_p| = 0.3$", "critical damping", "deadbeat", "choose"):
        assert name in missing
        assert not any(label.startswith(name) for label in labels)


def test_no_line_of_a_legend_ends_in_a_formula() -> None:
    """The point of choose is far out with the trapezoidal rule."""
    labels = lines_of(map_figure(map_answer(lookup("trapezoid"), map_conditions(points=21), drawn=True)).axes[0])
    (missing,) = (label for label in labels if label.startswith("nowhere"))
    assert "choose" in missing
    assert all(line.count("$") % 2 == 0 for line in missing.splitlines())


@pytest.mark.slow
def test_of_a_scene_that_moves_words_and_point_are_those_at_rest() -> None:
    asked = map_conditions(h=Fraction("0.005"), scene="driven_four_bar", points=21)
    axes = map_figure(map_answer(lookup("B4"), asked, drawn=True)).axes[0]
    assert {text.get_text() for text in axes.texts} == {"stable at rest", "diverges at rest"}
    assert any(label.startswith("choose at rest") for label in lines_of(axes))


@pytest.mark.parametrize("h", [None, Fraction("0.01")])
def test_arrows_along_the_edges_are_where_an_unbounded_region_goes_on(h: Fraction | None) -> None:
    """Beside the two unbounded ones the bounded region has none."""
    methods = tuple(map(lookup, ("RK4", "hht", "newmark")))
    regions = [region(method) for method in methods]
    axes = comparison_figure(regions, map_conditions(h=h)).axes[0]
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    scale = np.array([1 / float(h or 1), 1 / float(h or 1) ** 2])
    arrows = axes.lines[len(regions) :]
    of_boundaries = {line.get_color(): shape for line, shape in zip(axes.lines, regions, strict=False)}
    assert {line.get_color() for line in arrows} == set(list(of_boundaries)[1:])
    for line in arrows:
        shares = np.array(line.get_xydata())
        axis, end = {"<": (0, 0), ">": (0, 1), "v": (1, 0), "^": (1, 1)}[str(line.get_marker())]
        shares = shares[np.isfinite(shares).all(axis=1)]
        assert np.abs(shares[:, axis] - end).max() < 0.05  # beside the edge, for what is on it
        shares[:, axis] = end
        points = (low + (high - low) * shares) / scale
        assert of_boundaries[line.get_color()].contains(*points.T).all()
    assert {">", "^"} <= {line.get_marker() for line in arrows}
    assert [line.get_label() for line in arrows].count("stable beyond this edge") == 1  # named once


def test_into_a_sliver_no_word_is_written() -> None:
    """Where BDF3 diverges beside small alpha_hat the word would lie across the axis."""
    axes = map_figure(map_answer(lookup("bdf3"), map_conditions(points=41), drawn=True)).axes[0]
    assert [text.get_text() for text in axes.texts] == ["stable"]


@pytest.mark.parametrize("name", ["SYM", "RK4", "implicit-euler"])
def test_a_map_says_where_errors_decay_and_where_they_grow(name: str) -> None:
    """Each word stands in its area, and in the axes; where no error grows nothing is said to diverge."""
    method = lookup(name)
    axes = map_figure(map_answer(method, map_conditions(points=21), drawn=True)).axes[0]
    said = {text.get_text(): np.array(text.get_position()) for text in axes.texts}
    assert set(said) == ({"stable"} if name == "implicit-euler" else {"stable", "diverges"})
    for word, share in said.items():
        assert ((share > 0.05) & (share < 0.95)).all()
        alpha_hat, beta_hat = axes.transLimits.inverted().transform(share)
        z_abs = spectral_radius(method, alpha_hat, beta_hat)
        assert (z_abs < 1) == (word == "stable")
    assert axes.get_title().startswith(name)
