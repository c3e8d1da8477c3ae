"""Figures of runs that are made up: each error and each front is drawn where it is."""

from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.accuracy_costs import Cost, ErrorOf, Run, ranked_runs
from bezstab.runs.figures import FRONT, projection_figure, verdict_figure, work_precision_figure
from bezstab.runs.verdict_maps import compared
from bezstab.stability.regions import region
from tests.show.drawn import lines_of


def a_run(method: str, evaluations: int, error: float, **other: Any) -> Run:
    """Return a run whose |c| is a tenth of its error, and whose energy falls by twice that error; the rest is None."""
    nothing: dict[str, Any] = {each.name: None for each in fields(Run)}
    errors = {"trajectory_error": error, "c_max": error / 10, "energy_drift": -2 * error}
    costs = {"evaluations": evaluations, "factorizations": 2 * evaluations, "seconds": evaluations / 1e3}
    return Run(**{**nothing, "method": lookup(method), **errors, **costs, **other})


def legend_of(figure: Figure) -> list[str]:
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


RUNS = [
    a_run("B2", 100, 1e-2),
    a_run("B2", 200, 3e-3, h=0.01),
    a_run("AB4", 80, 9.0, failure="too far"),
    a_run("AB4", 300, 5e-3),
]


@pytest.mark.parametrize(("error", "against"), [("constraint", "evaluations"), ("trajectory", "time")])
def test_the_work_precision_figure_has_every_run_and_fills_the_front(error: ErrorOf, against: Cost) -> None:
    figure = work_precision_figure(ranked_runs(RUNS, 0.0, 6e-3, against), "made up", error)
    panels = {axes.get_title(): lines_of(axes) for axes in figure.axes}
    scale = [1 if against == "evaluations" else 1e-3, 0.1 if error == "constraint" else 1]
    own = {"B2": [(100, 1e-2), (200, 3e-3)], "AB4": [(300, 5e-3)]}
    for name, other, front in (("B2", "AB4", own["B2"]), ("AB4", "B2", [])):  # AB4 costs more and errs more
        lines = panels[name]
        assert lines["the method named above"] == pytest.approx(np.multiply(own[name], scale))
        assert lines[f"_{other}"] == pytest.approx(np.multiply(own[other], scale))
        assert lines[str(FRONT["label"])] == pytest.approx(np.reshape(front, (-1, 2)) * scale)
        assert lines["diverged"][:, 0] == pytest.approx([80 * scale[0]] if name == "AB4" else [])
    said, cheapest = legend_of(figure), "cheapest: B2, h = 0.01 s"
    assert {"diverged", "the method named above", "the other methods"} < set(said)
    assert ({cheapest, "tolerance 0.006"} <= set(said)) == (error == "trajectory")
    if error == "trajectory":  # AB4's 5e-3 is good enough as well, but dearer
        assert panels["B2"][cheapest] == pytest.approx(np.array([[0.2, 3e-3]]))
        assert cheapest not in panels["AB4"]
        assert set(panels["AB4"]["tolerance 0.006"][:, 1]) == {6e-3}


def test_the_projection_figure_shows_all_three_errors_of_every_way_to_hold_the_constraints() -> None:
    """A line for each method and way in each axes."""
    ways = [("baumgarte", True), ("baumgarte", False), ("projection", False)]
    runs = [
        a_run(method, 10 + number, 10.0**-number, stabilise=stabilise, advised=advised, h=0.02)
        for method in ("B2", "SYM")
        for number, (stabilise, advised) in enumerate(ways)
    ]
    figure = projection_figure(ranked_runs(runs, 0.0, 0.1, "projection"), "made up")
    for axes, share in zip(figure.axes, (1, 0.1, 2), strict=True):
        of_runs = [line for line in axes.lines if str(line.get_label()).startswith(("B2", "SYM"))]
        drawn = np.concatenate([line.get_xydata() for line in of_runs])
        assert drawn == pytest.approx(np.array([(20 + 2 * k, share * 10.0**-k) for k in (0, 0, 1, 1, 2, 2)]))
    ways_named = ["feedback, advised", "feedback, given", "projection"]
    assert legend_of(figure)[2:] == [*ways_named, "tolerance 0.1", "cheapest: B2, h = 0.02 s"]


def test_where_nothing_is_drawn_a_figure_says_why() -> None:
    runs = [a_run("B2", 100, 1e-9), a_run("AB4", 80, 9.0, failure="too far"), a_run("SYM", 90, 1e-3)]
    figure = work_precision_figure(ranked_runs(runs, 1e-8, 1e-12), "made up", "trajectory")
    said = {axes.get_title(): " ".join(axes.texts[0].get_text().split()) for axes in figure.axes}
    assert said == {"B2": "errors below the reference's", "AB4": "every run diverged", "SYM": ""}


def test_the_verdict_figure_shows_cells_boundary_and_disagreement() -> None:
    made_up = compared(
        scene=load_scene("pendulum"),
        method=lookup("SYM"),
        h=1e-3,
        run=2000,
        alpha_hat=np.arange(3.0),
        beta_hat=np.arange(2.0),
        z_abs=np.array([[0.9, 0.9, 1.1]] * 2),
        diverges=np.array([[False, True, True], [False, False, True]]),
        undecided=np.array([[False, False, True], [False] * 3]),
        moved=np.zeros((2, 3)),
    )
    (axes,) = verdict_figure(made_up, region(lookup("SYM"))).axes
    assert np.ma.masked_array(axes.images[0].get_array()).tolist() == [[0, 1, None], [0, 0, 1]]
    lines = lines_of(axes)
    assert lines["disagree"].tolist() == [[1, 0]]
    assert lines["$|z_p| = 1$"][:-1] == pytest.approx(region(lookup("SYM")).boundary[0])
    assert axes.get_title().endswith("5 of 6 runs gave a verdict, 4 of them agree")
