from fractions import Fraction

import numpy as np
import pytest

from bezstab.evidence import (
    NO_FEEDBACK,
    Cost,
    ErrorOf,
    Run,
    Sweep,
    measured_runs,
    pareto_front,
    reference_motion,
    swept_runs,
    with_fronts,
)
from bezstab.mechanism import compiled_mechanism, load_scene, simulated
from bezstab.methods import lookup
from bezstab.show.run_figures import history_figure, projection_figure, work_precision_figure
from bezstab.stabilising import NOTHING, AfterStep, after_step


@pytest.mark.slow
def test_the_work_precision_figure_has_every_run_and_rings_the_front() -> None:
    scene, steps, point = load_scene("slider_crank_light"), (0.004, 0.008, 0.0125), (50.0, 50.0)
    true = reference_motion(scene, min(steps), 1.0)
    sweeps = [Sweep(lookup(name), scene, steps, 1.0, point, True, 1, true) for name in ("B2", "AB4")]
    swept = [run for sweep in sweeps for run in swept_runs(sweep, measured_runs(sweep))]
    failed, ended = ([run for run in swept if bool(run.failure) == wanted] for wanted in (True, False))
    assert failed  # AB4 at the largest step

    def drawn(run: Run, error: ErrorOf, against: Cost) -> tuple[float, float | None]:
        cost = run.evaluations if against == "evaluations" else run.seconds
        return cost, run.c_max if error == "constraint" else run.trajectory_error

    kinds: list[tuple[ErrorOf, Cost]] = [("constraint", "evaluations"), ("trajectory", "time")]
    for error, against in kinds:
        (axes,) = work_precision_figure(with_fronts(swept, 0.0, against), scene.name, error).axes
        lines = {str(line.get_label()): np.array(line.get_xydata()).tolist() for line in axes.lines}
        places = [drawn(run, error, against) for run in ended]
        for name in ("B2", "AB4"):
            own = [list(place) for run, place in zip(ended, places, strict=True) if run.method.name == name]
            assert lines[name] == own
        assert lines["front"] == [list(places[k]) for k in pareto_front(places)]
        crosses = [np.array(line.get_xydata()) for line in axes.lines if line.get_marker() == "x"]
        across = sorted(x for cross in crosses for x, _ in cross)
        assert across == sorted(drawn(run, error, against)[0] for run in failed)


@pytest.mark.slow
def test_the_projection_figure_shows_all_three_errors_of_every_way_to_hold_the_constraints() -> None:
    """A line for each method and way in each axes."""
    scene, steps = load_scene("slider_crank_light"), (0.008, 0.004)
    true = reference_motion(scene, min(steps), 1.0)
    ways: list[tuple[tuple[float, float] | None, AfterStep]]
    ways = [(None, NOTHING), ((0.5, 0.1), NOTHING), (NO_FEEDBACK, after_step("projection"))]
    sweeps = [
        Sweep(lookup(name), scene, steps, 1.0, point, False, 1, true, Fraction(14), after=after)
        for name in ("B2", "SYM")
        for point, after in ways
    ]
    swept = [run for sweep in sweeps for run in swept_runs(sweep, measured_runs(sweep))]
    figure = projection_figure(with_fronts(swept, true.error, "projection"), scene.name, 0.0)
    trajectory, constraint, energy = figure.axes
    errors = ([run.trajectory_error, run.c_max, abs(run.energy_drift)] for run in swept)
    for axes, of_runs in zip((trajectory, constraint, energy), zip(*errors, strict=True), strict=True):
        drawn = [point for line in axes.lines for point in np.array(line.get_xydata()).tolist()]
        assert drawn == [[run.factorizations, error] for run, error in zip(swept, of_runs, strict=True)]


def test_the_history_figure_says_what_was_run_and_shows_decay_as_a_line() -> None:
    pendulum = compiled_mechanism(load_scene("pendulum"))
    run = simulated(pendulum, lookup("SYM"), h=0.002, duration=0.2, alpha_hat=0.5, beta_hat=0.1, perturb=1e-4)
    figure = history_figure(run)
    upper, middle, lower = figure.axes
    assert np.array(upper.lines[0].get_ydata()).tolist() == run.c[:, 0].tolist()
    assert np.array(middle.lines[0].get_ydata()).tolist() == run.cdot[:, 0].tolist()
    assert np.array(lower.lines[0].get_ydata()).tolist() == np.abs(run.c).max(axis=1).tolist()
