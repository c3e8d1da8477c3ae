from collections.abc import Sequence

import numpy as np
import pytest

from bezstab.evidence import Run, Sweep, measured_runs, pareto_front, reference_motion, swept_runs, with_fronts
from bezstab.mechanism import compiled_mechanism, initial_state, load_scene
from bezstab.methods import lookup
from bezstab.show.run_figures import scene_figure, work_precision_figure


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
    figure = work_precision_figure(with_fronts(swept, 0.0), scene.name, constraint)
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
