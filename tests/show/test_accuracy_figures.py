"""Figures of forced errors: what their artists hold is what was given, and it can be read."""

from fractions import Fraction

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.contour import QuadContourSet
from matplotlib.figure import Figure

from bezstab.methods import lookup
from bezstab.show.accuracy_figures import accuracy_map_figure, error_front_figure
from bezstab.show.plane_figures import PlaneMap
from bezstab.stability import (
    FloatArray,
    best_point,
    choose,
    combined_error,
    error_front,
    region,
    spectral_radius,
)

OMEGA_H = Fraction(1, 100)


def drawn_map(name: str = "RK4", h: float | None = None) -> tuple[Figure, FloatArray, FloatArray, FloatArray]:
    """Return the map of a method, |z_p| in it, and the errors with both of its axes."""
    method = lookup(name)
    alpha_hat, beta_hat = np.geomspace(2e-3, 6, 61), np.geomspace(1e-6, 9, 61)
    z_abs = spectral_radius(method, alpha_hat, beta_hat[:, np.newaxis])
    error = combined_error(method, alpha_hat, beta_hat[:, np.newaxis], OMEGA_H)
    shown = PlaneMap(
        region=region(method),
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        z_abs=z_abs,
        best=best_point(method),
        chosen=choose(method, "accurate", margins=False),
        h=h,
        marks={"a rule": (0.1, 0.01)},
    )
    figure = accuracy_map_figure(shown, float(OMEGA_H), np.where(z_abs < 1, error, np.nan), [0.99])
    return figure, z_abs, alpha_hat, beta_hat


def contours(axes: Axes) -> list[QuadContourSet]:
    return [each for each in axes.collections if isinstance(each, QuadContourSet)]


@pytest.mark.parametrize("h", [None, 0.001])
def test_the_map_draws_what_it_is_given(h: float | None) -> None:
    figure, z_abs, alpha_hat, beta_hat = drawn_map(h=h)
    axes, scale = figure.axes[0], np.array([1 / (h or 1), 1 / (h or 1) ** 2])
    (mesh,) = [each for each in axes.collections if isinstance(each, QuadMesh)]
    shown = np.ma.masked_array(mesh.get_array())
    assert (np.ma.getmaskarray(shown) == (z_abs >= 1)).all()
    assert shown.compressed().tolist() == z_abs[z_abs < 1].tolist()
    low, high = np.transpose([axes.get_xlim(), axes.get_ylim()])
    assert [low, high] == pytest.approx(np.transpose([alpha_hat, beta_hat])[[0, -1]] * scale)
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    chosen = choose(lookup("RK4"), "accurate", margins=False)
    there = lines[f"choose accurate: {abs(chosen.pole):.4f}"][0]
    assert there == pytest.approx(np.array([chosen.alpha_hat, chosen.beta_hat]) * scale)
    assert lines["a rule"][0] == pytest.approx(np.array([0.1, 0.01]) * scale)


@pytest.mark.promise(
    "The map of forced errors (`region --accuracy`)",
    computed=("each contour is where the error is its power of ten; the boundary exact on its logarithmic axes, too"),
)
def test_each_contour_is_where_the_error_is_its_power_of_ten() -> None:
    method = lookup("RK4")
    axes = drawn_map()[0].axes[0]
    errors, level = contours(axes)
    paths = zip(errors.levels, errors.get_paths(), strict=True)
    drawn = {power: path for power, path in paths if np.size(path.vertices)}
    assert list(drawn) == list(range(-10, 0))
    for power, path in drawn.items():
        if power < -3:  # nearer to the boundary the grid is too coarse
            along_alpha, along_beta = np.asarray(path.vertices).T
            found = np.log10(combined_error(method, along_alpha, along_beta, OMEGA_H))
            assert np.median(abs(found - power)) < 0.02
    (path,) = level.get_paths()
    alpha_hat, beta_hat = np.asarray(path.vertices).T
    assert np.median(abs(spectral_radius(method, alpha_hat, beta_hat) - 0.99)) < 1e-3


@pytest.mark.promise("The map of forced errors (`region --accuracy`)")
def test_the_boundary_is_exact_down_to_the_last_decade() -> None:
    """Chords of a few points would be straight on other axes."""
    for name in ("SYM", "B4"):
        axes = drawn_map(name)[0].axes[0]
        (boundary,) = [line for line in axes.lines if line.get_label() == "$|z_p| = 1$"]
        points = np.array(boundary.get_xydata())
        inside = points[(points > 1e-6).all(axis=1)]
        assert spectral_radius(lookup(name), *inside.T) == pytest.approx(1, abs=2e-4)  # chords of the drawn arcs
        # straight on logarithmic axes, too: what lies between two points there is on the boundary
        pairs = np.stack([points[:-1], points[1:]])[
            :, (points[:-1] > 1e-6).all(axis=1) & (points[1:] > 1e-6).all(axis=1)
        ]
        between = np.sqrt(pairs[0] * pairs[1])
        assert spectral_radius(lookup(name), *between.T) == pytest.approx(1, abs=2e-3)


@pytest.mark.slow
def test_the_front_figure_has_every_point_of_every_front() -> None:
    fronts = [error_front(lookup(name), [0.999, 0.9, 0.5, 0.2]) for name in ("RK4", "B4", "AB4")]
    (axes,) = error_front_figure(fronts).axes
    for front, line in zip(fronts, axes.lines, strict=True):
        assert line.get_label() == front[0].method.name
        drawn = [[point.z_abs_below, point.combined_error] for point in front if point.z_abs_below >= 0.1]
        assert np.array(line.get_xydata()).tolist() == drawn
    assert len(np.array(axes.lines[0].get_xydata())) == len(fronts[0]) - 1  # deadbeat is infinitely far away
