import io
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from bezstab.evidence import (
    Run,
    Sweep,
    map_rows,
    measured_runs,
    pareto_front,
    reference_motion,
    simulated_verdicts,
    swept_runs,
    verdict_map,
)
from bezstab.mechanism import compiled_mechanism, initial_state, load_scene
from bezstab.methods import lookup
from bezstab.show.figures import (
    comparison_figure,
    family_figure,
    region_figure,
    scene_figure,
    verdict_figure,
    work_precision_figure,
)
from bezstab.show.style import save
from bezstab.stability import FloatArray, best_point, bezier_limit, family_members, region, spectral_radius, window


def drawn(name: str = "B4", h: float | None = None) -> tuple[Figure, FloatArray, FloatArray, FloatArray]:
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
    figure, alpha_hat, beta_hat, z_abs = drawn(h=h)
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
    parabola = lines[r"$\hat\beta = \hat\alpha^2/4$"]
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
    broken = np.zeros_like(wrong)
    broken[0, 5] = True
    figure = verdict_figure(replace(cells, diverges=wrong, broken=broken), region(method))
    (axes,) = figure.axes
    shown = axes.images[0].get_array()
    assert shown is not None
    assert (np.ma.getmaskarray(shown) == broken).all()
    assert (np.asarray(shown)[~broken] == wrong[~broken]).all()
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    assert lines["disagree"].tolist() == [[cells.alpha_hat[3], cells.beta_hat[2]]]
    (curve,) = region(method).boundary
    assert lines["$|z_p| = 1$"][:-1] == pytest.approx(curve)
    assert "97.14%" in axes.get_title()  # 34 of 35


def test_the_scene_figure_joins_the_bodies_where_their_joints_are() -> None:
    scene = load_scene("slider_crank")
    q = initial_state(compiled_mechanism(scene))[0]
    (axes,) = scene_figure(scene, q).axes
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    tip = 0.2 * np.array([np.cos(np.pi / 4), np.sin(np.pi / 4)])
    assert lines["crank"] == pytest.approx(np.array([[0, 0], tip]))
    assert lines["rod"] == pytest.approx(np.array([tip, [q[4], 0]]))
    assert lines["slider"] == pytest.approx(np.array([[q[4], 0]]))
    assert {text.get_text() for text in axes.texts} == {"crank", "rod", "slider"}


@pytest.mark.parametrize("constraint", [False, True])
def test_the_work_precision_figure_has_every_run_and_rings_the_front(constraint: bool) -> None:
    scene, steps, point = load_scene("slider_crank_light"), (0.004, 0.008, 0.0125), (50.0, 50.0)
    true = reference_motion(scene, min(steps), 1.0)
    sweeps = [Sweep(lookup(name), scene, steps, 1.0, point, True, 1, true) for name in ("B2", "AB4")]
    swept = [run for sweep in sweeps for run in swept_runs(sweep, measured_runs(sweep))]
    failed = [run for run in swept if run.failure]
    assert failed  # AB4 at the largest step
    figure = work_precision_figure(swept, scene.name, constraint)
    (axes,) = figure.axes
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}

    def expected(these: Sequence[Run]) -> list[tuple[float, float | None]]:
        return [(run.evaluations, run.c_max if constraint else run.trajectory_error) for run in these]

    for name in ("B2", "AB4"):
        own = [run for run in swept if run.method.name == name and not run.failure]
        assert lines[name].tolist() == [list(point) for point in expected(own)]
    ended = [run for run in swept if not run.failure]
    assert lines["front"].tolist() == [list(expected(ended)[k]) for k in pareto_front(expected(ended))]
    crosses = [line for line in axes.lines if line.get_marker() == "x" and len(np.array(line.get_xydata()))]
    assert sorted(x for line in crosses for x, _ in np.array(line.get_xydata())) == sorted(
        r.evaluations for r in failed
    )
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert "diverged" in lines


def test_the_family_figure_has_a_point_per_method_and_the_limit() -> None:
    families, limit = (
        {"bezier": family_members("bezier", 2, 5), "adams-bashforth": family_members("adams-bashforth", 2, 4)},
        bezier_limit(),
    )
    area, fastest, constant, regions = family_figure(families, limit).axes
    for axes, of in (
        (area, lambda m: m.region.area),
        (fastest, lambda m: m.z_abs),
        (constant, lambda m: float(m.error_constant)),
    ):
        lines = {str(line.get_label()): line for line in axes.lines}
        for name, found in families.items():
            order = {"bezier": 2, "adams-bashforth": "n"}[name]
            assert np.array(lines[f"{name} (order {order})"].get_xydata()).tolist() == [[m.n, of(m)] for m in found]
    assert [np.array(axes.lines[-1].get_ydata())[0] for axes in (area, fastest)] == [limit.area, limit.z_abs]
    assert np.array(regions.lines[-1].get_xydata()) == pytest.approx(limit.boundary)


def test_an_empty_region_can_be_drawn() -> None:
    axis = np.linspace(0, 1, 5)
    figure = region_figure(region(lookup("AB4"), 0.5), [], None, axis, axis, np.full((5, 5), 2.0))
    save(figure, "png", io.BytesIO())


def test_a_method_has_the_same_colour_everywhere_and_its_own_line() -> None:
    names = ["B3", "B4", "AB3", "AB4", "RK4@5", "SYM", "SIE", "ABM4"]
    looks = []
    for order in (names, names[::-1]):
        axes = comparison_figure([region(lookup(name)) for name in order]).axes[0]
        looks.append({str(line.get_label()): (line.get_color(), line.get_linestyle()) for line in axes.lines})
    assert looks[0] == looks[1]
    assert len(set(map(str, looks[0].values()))) == len(names)


def test_a_comparison_draws_each_boundary_and_keeps_a_given_window() -> None:
    regions = [region(lookup(name)) for name in ("B4", "RK4@5")]
    axes = comparison_figure(regions, (0.0, 1.0), (0.0, 0.5), h=0.001).axes[0]
    for line, shape in zip(axes.lines, regions, strict=True):
        assert np.array(line.get_xydata())[:-1] == pytest.approx(shape.boundary[0] * [1e3, 1e6])
    assert (*axes.get_xlim(), *axes.get_ylim()) == pytest.approx((0, 1e3, 0, 0.5e6))


def test_an_empty_region_has_its_label_only() -> None:
    figure = comparison_figure([region(lookup("B4"), 0.5)])
    (line,) = figure.axes[0].lines
    assert line.get_label() == "B4"
    assert np.isnan(line.get_xydata()).all()


@pytest.mark.parametrize("form", ["png", "svg", "pdf"])
def test_equal_figures_are_equal_bytes_whatever_the_users_settings(form: str) -> None:
    outputs = []
    own: dict[str, Any] = {"font.size": 20, "lines.linewidth": 9, "savefig.dpi": 10, "svg.hashsalt": "x"}
    for settings in ({}, own):
        with mpl.rc_context(settings):  # type: ignore[arg-type,unused-ignore]
            save(drawn()[0], form, file := io.BytesIO())  # type: ignore[arg-type]
        outputs.append(file.getvalue())
    assert outputs[0] == outputs[1]


def test_two_processes_draw_the_same_bytes() -> None:
    code = (
        "import sys; from bezstab.show.figures import *; from bezstab.show.style import save;"
        "from bezstab.methods import lookup;"
        "from bezstab.stability import region;"
        "save(comparison_figure([region(lookup('B4'))]), 'svg', sys.stdout.buffer)"
    )
    runs = [
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, check=True, env={"PYTHONHASHSEED": seed}
        ).stdout
        for seed in ("1", "2")
    ]
    assert runs[0] == runs[1]
    assert b"<svg" in runs[0]
