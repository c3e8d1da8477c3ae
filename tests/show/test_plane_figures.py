import io
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.evidence import map_rows, moving_region, simulated_verdicts, verdict_map
from bezstab.mechanism import at_speed, compiled_mechanism, load_scene, turning_normals
from bezstab.methods import lookup
from bezstab.show import plot
from bezstab.show.plane_figures import comparison_figure, family_figure, region_figure, verdict_figure
from bezstab.show.style import save
from bezstab.stability import (
    FloatArray,
    Member,
    best_point,
    bezier_limit,
    choose,
    family_members,
    region,
    spectral_radius,
    window,
)


def drawn_map(name: str = "B4", h: float | None = None) -> tuple[Figure, FloatArray, FloatArray, FloatArray]:
    method = lookup(name)
    alpha_hat, beta_hat = (np.linspace(low, high, 41) for low, high in window(region(method)))
    z_abs = spectral_radius(method, alpha_hat, beta_hat[:, None])
    faster = [region(method, 0.75), region(method, 0.9)]
    return (
        region_figure(region(method), faster, best_point(method), alpha_hat, beta_hat, z_abs, h),
        alpha_hat,
        beta_hat,
        z_abs,
    )


@pytest.mark.parametrize("h", [None, 0.001])
def test_the_figure_draws_what_it_is_given(h: float | None) -> None:
    figure, alpha_hat, beta_hat, z_abs = drawn_map(h=h)
    axes, scale = figure.axes[0], np.array([1 / (h or 1), 1 / (h or 1) ** 2])
    (image,) = axes.images
    shown = image.get_array()
    assert shown is not None
    assert (np.ma.getmaskarray(shown) == (z_abs >= 1)).all()
    assert np.asarray(shown)[z_abs < 1].tolist() == z_abs[z_abs < 1].tolist()
    left, right, bottom, top = image.get_extent()
    step = (alpha_hat[1] - alpha_hat[0]) * scale[0]
    assert (left + step / 2, right - step / 2) == pytest.approx((0, alpha_hat[-1] * scale[0]))  # nodes at pixel centres
    assert (bottom + top) / 2 == pytest.approx(beta_hat[[0, -1]].mean() * scale[1])
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    for label, level in (("$|z_p| = 1$", 1.0), ("$|z_p| = 0.75$", 0.75), ("$|z_p| = 0.9$", 0.9)):
        (curve,) = region(lookup("B4"), level).boundary
        assert lines[label][:-1] == pytest.approx(curve * scale)
    in_the_axes_notation = r"$\hat\beta = \hat\alpha^2/4$" if h is None else r"$\alpha = \beta$"
    parabola = lines[f"critical damping: {in_the_axes_notation}"]
    assert parabola[:, 1] == pytest.approx(parabola[:, 0] ** 2 / 4)  # beta^2 = (2 alpha)^2/4 in either unit
    best = best_point(lookup("B4"))
    assert best is not None
    assert lines["least $|z_p|$: 0.6259"][0] == pytest.approx(np.array([best.alpha_hat, best.beta_hat]) * scale)
    assert r"\alpha" in axes.get_xlabel()
    assert r"\beta" in axes.get_ylabel()
    assert ("1/s" in axes.get_xlabel()) == (h is not None)


def test_the_verdict_figure_shows_cells_boundary_and_disagreement() -> None:
    method = lookup("SYM")
    rows = map_rows(load_scene("pendulum"), method, 1e-3, 6)
    cells = verdict_map(rows, [simulated_verdicts(each) for each in rows])
    wrong = cells.diverges.copy()
    wrong[2, 3] ^= True
    undecided = np.zeros_like(wrong)
    undecided[0, 5] = True
    figure = verdict_figure(replace(cells, diverges=wrong, undecided=undecided), region(method))
    (axes,) = figure.axes
    shown = axes.images[0].get_array()
    assert shown is not None
    assert (np.ma.getmaskarray(shown) == undecided).all()
    assert (np.asarray(shown)[~undecided] == wrong[~undecided]).all()
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    assert lines["disagree"].tolist() == [[cells.alpha_hat[3], cells.beta_hat[2]]]
    (curve,) = region(method).boundary
    assert lines["$|z_p| = 1$"][:-1] == pytest.approx(curve)
    assert axes.get_title().splitlines()[-2:] == ["35 of 36 runs gave a verdict", "34 of them agree"]


def test_the_title_of_verdicts_lies_within_the_figure() -> None:
    method = lookup("generalized-alpha")
    rows = map_rows(load_scene("slider_crank_light"), lookup("SYM"), 1e-3, 2)
    cells = verdict_map(rows, [simulated_verdicts(each) for each in rows])
    none, axis = np.zeros((60, 60), dtype=bool), np.linspace(0.1, 1.0, 60)
    of_many_runs = replace(
        cells, method=method, alpha_hat=axis, beta_hat=axis, z_abs=np.zeros((60, 60)), diverges=none, undecided=none
    )
    figure = verdict_figure(of_many_runs, region(lookup("SYM")))
    figure.savefig(io.BytesIO())
    title = figure.axes[0].title.get_window_extent()
    assert title.x0 >= 0
    assert title.x1 <= figure.bbox.x1
    assert title.y1 <= figure.bbox.y1


def test_the_family_figure_has_a_point_per_method_and_the_limit() -> None:
    families = {"bezier": family_members("bezier", 2, 5), "adams-bashforth": family_members("adams-bashforth", 2, 4)}
    limit = bezier_limit()
    area, fastest, constant, regions = family_figure(families, "bezier", limit).axes

    def assert_drawn(axes: Axes, quantity: Callable[[Member], float | None], shown: dict[str, str]) -> None:
        of_members = axes.lines[: len(shown)]
        for line, (key, name) in zip(of_members, shown.items(), strict=True):
            assert np.array(line.get_xydata()).tolist() == [[each.n, quantity(each)] for each in families[key]]
            assert line.get_label() == name or axes is constant
        assert len({(str(line.get_color()), str(line.get_linestyle())) for line in of_members}) == len(shown)

    both = {"bezier": "Bézier", "adams-bashforth": "Adams–Bashforth"}
    assert_drawn(area, lambda member: member.region.area, both)
    assert_drawn(fastest, lambda member: member.z_abs, both)
    assert_drawn(constant, lambda member: float(member.error_constant), {"bezier": "Bézier"})
    assert len(constant.lines) == 2  # the limit besides: constants of another order are not comparable
    assert constant.get_ylabel() == "error constant, all of order 2"
    assert [np.array(axes.lines[-1].get_ydata())[0] for axes in (area, fastest)] == [limit.area, limit.z_abs]
    assert np.array(regions.lines[-1].get_xydata()) == pytest.approx(limit.boundary)


def test_the_family_figure_shows_the_regions_of_the_family_asked_for() -> None:
    families = {"bezier": family_members("bezier", 2, 3), "adams-bashforth": family_members("adams-bashforth", 2, 3)}
    area, _, orders, regions = family_figure(families, "adams-bashforth", None).axes
    assert orders.get_ylabel() == "order of accuracy"
    assert np.array(orders.lines[0].get_xydata()).tolist() == [[2, 2], [3, 3]]
    assert [line.get_label() for line in regions.lines] == ["AB2", "AB3"]
    for line, member in zip(regions.lines, families["adams-bashforth"], strict=True):
        assert np.array(line.get_xydata())[:-1] == pytest.approx(member.region.boundary[0])
    assert len(area.lines) == 2  # no limit: theirs is nothing


def test_axes_marked_in_alpha_and_beta_mark_the_same_points() -> None:
    h = 0.001
    figure = comparison_figure([region(lookup("B4"))], h=h, alpha_and_beta=True)
    (axes,) = figure.axes
    for ticks, labels, power, scale in (
        (axes.get_xticks(), axes.get_xticklabels(), 1, 2),  # at 2 alpha
        (axes.get_yticks(), axes.get_yticklabels(), 2, 1),  # at beta^2
    ):
        assert len(ticks) > 2
        assert ticks == pytest.approx([scale * float(label.get_text()) ** power for label in labels])
    assert axes.get_xlabel().startswith(r"$\alpha$")
    assert axes.get_ylabel().startswith(r"$\beta$")


def test_the_choice_is_marked_and_no_marker_inside_is_cut() -> None:
    method = lookup("SYM")
    alpha_hat, beta_hat = (np.linspace(low, high, 9) for low, high in window(region(method)))
    z_abs = spectral_radius(method, alpha_hat, beta_hat[:, None])
    chosen = choose(method, "robust")
    corner, beyond = (float(alpha_hat[0]), float(beta_hat[0])), (2 * float(alpha_hat[-1]), 1.0)
    marks = {"at the corner": corner, "beyond": beyond}
    figure = region_figure(
        region(method), [], best_point(method), alpha_hat, beta_hat, z_abs, marks=marks, chosen=chosen
    )
    lines = {str(line.get_label()): line for line in figure.axes[0].lines}
    (label,) = (label for label in lines if label.startswith("choose robust"))
    assert np.array(lines[label].get_xydata()).tolist() == [[chosen.alpha_hat, chosen.beta_hat]]
    assert not lines["at the corner"].get_clip_on()
    assert lines["beyond"].get_clip_on()


def test_an_empty_region_can_be_drawn() -> None:
    axis = np.linspace(0, 1, 5)
    figure = region_figure(region(lookup("AB4"), 0.5), [], None, axis, axis, np.full((5, 5), 2.0))
    save(figure, "png", io.BytesIO())


def test_a_comparison_draws_each_boundary_and_keeps_a_given_window() -> None:
    regions = [region(lookup(name)) for name in ("B4", "RK4@5")]
    axes = comparison_figure(regions, (0.0, 1.0), (0.0, 0.5), h=0.001).axes[0]
    for line, shape in zip(axes.lines[:2], regions, strict=True):
        assert np.array(line.get_xydata())[:-1] == pytest.approx(shape.boundary[0] * [1e3, 1e6])
    assert (*axes.get_xlim(), *axes.get_ylim()) == pytest.approx((0, 1e3, 0, 0.5e6))


def test_an_empty_region_has_its_label_only() -> None:
    figure = comparison_figure([region(lookup("B4"), 0.5)])
    (line,) = figure.axes[0].lines
    assert line.get_label() == "B4"
    assert np.isnan(line.get_xydata()).all()


@pytest.mark.parametrize("h", [None, 0.01])
def test_arrows_along_the_edges_are_where_an_unbounded_region_goes_on(h: float | None) -> None:
    """Beside the two unbounded ones the bounded region has none; no two lie on one line."""
    regions = [region(lookup(name)) for name in ("RK4", "hht", "newmark")]
    axes = comparison_figure(regions, h=h).axes[0]
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    x_of_one, y_of_one = (1.0, 1.0) if h is None else (1 / h, 1 / h**2)
    arrows = axes.lines[len(regions) :]
    of_boundaries = {line.get_color(): shape for line, shape in zip(axes.lines, regions, strict=False)}
    assert {line.get_color() for line in arrows} == set(list(of_boundaries)[1:])
    for line in arrows:
        across, up = np.array(line.get_xydata()).T
        edge = {"<": (0, up), ">": (1, up), "v": (across, 0), "^": (across, 1)}[str(line.get_marker())]
        x, y = left + (right - left) * edge[0], low + (high - low) * edge[1]
        drawn = np.isfinite(across) & np.isfinite(up)
        x, y = np.broadcast_arrays(x, y)
        assert of_boundaries[line.get_color()].contains(x[drawn] / x_of_one, y[drawn] / y_of_one).all()
        assert line.get_transform() == axes.transAxes
    places = [(str(line.get_marker()), round(float(np.nanmax(line.get_xydata())), 6)) for line in arrows]
    assert len(set(places)) == len(places)
    assert {">", "^"} <= {marker for marker, _ in places}


@pytest.mark.slow
def test_a_moving_mechanism_is_named_and_so_is_what_its_speed_is_a_multiple_of() -> None:
    method, scene = lookup("SYM"), load_scene("driven_four_bar")
    moving = {}
    for speed in (1.0, 3.0):
        mechanism = compiled_mechanism(at_speed(scene, speed))
        moving[speed] = moving_region(method, turning_normals(mechanism, mechanism.scene.duration), 0.005, points=9)
    axis = np.linspace(0, 4, 9)
    z_abs = spectral_radius(method, axis, axis[:, None])
    figure = region_figure(region(method), [], None, axis, axis, z_abs, 0.005, moving=moving, scene=scene.name)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {"its own speed", "3 times its own speed", "$|z_p| = 1$ at rest"} <= set(labels)
    assert scene.name in figure.axes[0].get_title().replace("\n", " ")
    assert not any(r"\hat" in text for text in labels)  # nor have the axes


@pytest.mark.parametrize("name", ["SYM", "newmark"])
def test_a_deadbeat_point_is_called_that(name: str) -> None:
    best = best_point(lookup(name))
    assert best
    assert plot.best_point(best).get_label() == "deadbeat: $|z_p| = 0$"
