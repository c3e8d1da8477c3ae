from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from bezstab.evidence import (
    NO_FEEDBACK,
    Cost,
    Run,
    Sweep,
    measured_runs,
    pareto_front,
    reference_motion,
    swept_runs,
    with_fronts,
)
from bezstab.mechanism import Projection, compiled_mechanism, initial_state, load_scene, simulated
from bezstab.methods import lookup
from bezstab.show.run_figures import history_figure, projection_figure, scene_figure, work_precision_figure


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


@pytest.mark.parametrize(
    ("constraint", "against", "label"),
    [
        (False, "evaluations", "evaluations of f"),
        (True, "evaluations", "evaluations of f"),
        (False, "time", "processor time (s)"),
    ],
)
@pytest.mark.slow
def test_the_work_precision_figure_has_every_run_and_rings_the_front(
    constraint: bool, against: Cost, label: str
) -> None:
    scene, steps, point = load_scene("slider_crank_light"), (0.004, 0.008, 0.0125), (50.0, 50.0)
    true = reference_motion(scene, min(steps), 1.0)
    sweeps = [Sweep(lookup(name), scene, steps, 1.0, point, True, 1, true) for name in ("B2", "AB4")]
    swept = [run for sweep in sweeps for run in swept_runs(sweep, measured_runs(sweep))]
    failed = [run for run in swept if run.failure]
    assert failed  # AB4 at the largest step
    figure = work_precision_figure(with_fronts(swept, 0.0, against), scene.name, constraint)
    (axes,) = figure.axes
    assert axes.get_xlabel() == label
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}

    def cost(run: Run) -> float:
        return run.evaluations if against == "evaluations" else run.seconds

    def expected(these: Sequence[Run]) -> list[tuple[float, float | None]]:
        return [(cost(run), run.c_max if constraint else run.trajectory_error) for run in these]

    for name in ("B2", "AB4"):
        own = [run for run in swept if run.method.name == name and not run.failure]
        assert lines[name].tolist() == [list(point) for point in expected(own)]
    ended = [run for run in swept if not run.failure]
    assert lines["front"].tolist() == [list(expected(ended)[k]) for k in pareto_front(expected(ended))]
    crosses = [line for line in axes.lines if line.get_marker() == "x" and len(np.array(line.get_xydata()))]
    assert sorted(x for line in crosses for x, _ in np.array(line.get_xydata())) == sorted(cost(run) for run in failed)
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert "diverged" in lines
    shapes = {
        name: (line.get_marker(), line.get_markersize()) for name in ("B2", "AB4") for line in [lines_of(axes)[name]]
    }
    assert len(set(shapes.values())) == len(shapes)  # coinciding curves are told apart


@pytest.mark.slow
def test_the_projection_figure_shows_all_three_errors_of_every_way_to_hold_the_constraints() -> None:
    """A line for each method and way in each axes; filled markers are projection, crosses a point that was given."""
    scene, steps = load_scene("slider_crank_light"), (0.008, 0.004)
    true = reference_motion(scene, min(steps), 1.0)
    ways: list[tuple[tuple[float, float] | None, Projection | None]]
    ways = [(None, None), ((0.5, 0.1), None), (NO_FEEDBACK, Projection())]
    sweeps = [
        Sweep(lookup(name), scene, steps, 1.0, point, False, 1, true, Fraction(14), projection=projection)
        for name in ("B2", "SYM")
        for point, projection in ways
    ]
    swept = [run for sweep in sweeps for run in swept_runs(sweep, measured_runs(sweep))]
    figure = projection_figure(with_fronts(swept, true.error, "projection"), scene.name, 0.0)
    trajectory, constraint, energy = figure.axes
    errors = ([run.trajectory_error, run.c_max, abs(run.energy_drift)] for run in swept)
    for axes, of_runs in zip((trajectory, constraint, energy), zip(*errors, strict=True), strict=True):
        assert [line.get_marker() for line in axes.lines] == ["o", "x", "o"] * 2
        assert [line.get_markerfacecolor() == "none" for line in axes.lines] == [True, False, False] * 2
        drawn = [point for line in axes.lines for point in np.array(line.get_xydata()).tolist()]
        assert drawn == [[run.factorizations, error] for run, error in zip(swept, of_runs, strict=True)]
        assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    (legend,) = figure.legends
    labels = [text.get_text() for text in legend.get_texts()]
    assert labels == ["B2", "SYM", "feedback, advised", "feedback, given", "projection"]


def lines_of(axes: Axes) -> dict[str, Line2D]:
    return {str(line.get_label()): line for line in axes.lines}


def test_the_history_figure_says_what_was_run_and_shows_decay_as_a_line() -> None:
    pendulum = compiled_mechanism(load_scene("pendulum"))
    run = simulated(pendulum, lookup("SYM"), h=0.002, duration=0.2, alpha_hat=0.5, beta_hat=0.1, perturb=1e-4)
    figure = history_figure(run)
    upper, middle, lower = figure.axes
    assert np.array(upper.lines[0].get_ydata()).tolist() == run.c[:, 0].tolist()
    assert np.array(middle.lines[0].get_ydata()).tolist() == run.cdot[:, 0].tolist()
    assert np.array(lower.lines[0].get_ydata()).tolist() == np.abs(run.c).max(axis=1).tolist()
    assert lower.get_yscale() == "log"
    title = figure.texts[0].get_text()
    for part in ("SYM", "0.002 s", r"\hat\alpha$ = 0.5", r"\hat\beta$ = 0.1"):
        assert part in title
