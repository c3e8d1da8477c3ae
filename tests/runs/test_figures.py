"""Figures of runs that are made up: each error and each front is drawn where it is."""

import itertools
from dataclasses import fields
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from bezstab.methods.registry import lookup
from bezstab.runs.accuracy_costs import Run, ranked_runs
from bezstab.runs.figures import FRONT, projection_figure, verdict_figure, work_precision_figure
from bezstab.stability.regions import region
from tests.runs.test_verdict_maps import MADE_UP
from tests.show.drawn import lines_of

WHAT = ("the method named above", str(FRONT["label"]))


def a_run(method: str, evaluations: int, error: float, **other: Any) -> Run:
    """Return a run whose |c| is a tenth of its error, and whose energy falls by twice that error; the rest is None."""
    nothing: dict[str, Any] = {each.name: None for each in fields(Run)}
    errors = {"trajectory_error": error, "c_max": error / 10, "energy_drift": -2 * error}
    costs = {"evaluations": evaluations, "factorizations": 2 * evaluations, "seconds": evaluations / 1e3}
    return Run(**{**nothing, "method": lookup(method), **errors, **costs, **other})


def legend_of(figure: Figure) -> list[str]:
    (legend,) = figure.legends
    return [text.get_text() for text in legend.get_texts()]


def test_the_work_precision_figure_has_every_run_fills_the_front_and_marks_the_cheapest() -> None:
    """AB4 costs more and errs more, and its 5e-3 is good enough as well, but dearer."""
    good = [a_run("B2", 100, 1e-2), a_run("B2", 200, 3e-3, h=0.01), a_run("AB4", 300, 5e-3)]
    runs = [*good, a_run("AB4", 80, 9.0, failure="too far")]
    figure = work_precision_figure(ranked_runs(runs, 0.0, 6e-3, "time"), "made up", "trajectory")
    panels = {axes.get_title(): lines_of(axes) for axes in figure.axes}
    seen = {name: [panels[name][key].tolist() for key in WHAT] for name in panels}
    b2, ab4, cheapest = [[0.1, 1e-2], [0.2, 3e-3]], [[0.3, 5e-3]], "cheapest: B2, h = 0.01 s"
    assert seen == {"B2": [b2, b2], "AB4": [ab4, []]}
    assert panels["AB4"]["diverged"][:, 0].tolist() == [0.08]
    assert panels["B2"][cheapest].tolist() == [[0.2, 3e-3]]
    assert {"diverged", *WHAT, cheapest} <= set(legend_of(figure))


@pytest.mark.parametrize("costs", [(100, 130), (100, 800), (100, 1600), (130, 7500), (509, 8000), (50, 20000)])
def test_labels_below_narrow_axes_stand_apart(costs: tuple[int, int]) -> None:
    runs = [a_run(name, cost, 0.01) for name in ("B2", "B4", "SYM") for cost in costs]
    figure = work_precision_figure(ranked_runs(runs, 0.0, 6e-3), "made up", "trajectory")
    figure.draw_without_rendering()
    labels = figure.axes[0].xaxis.get_ticklabels(which="both")
    ends = sorted(each.get_window_extent().intervalx.tolist() for each in labels if each.get_text())
    assert all(left[1] < right[0] for left, right in itertools.pairwise(ends))


def test_the_projection_figure_shows_all_three_errors_of_every_way_to_hold_the_constraints() -> None:
    ways = [("baumgarte", True), ("baumgarte", False), ("projection", False)]
    runs = [
        a_run("B2", 10 + number, 10.0**-number, stabilise=stabilise, advised=advised, h=0.02)
        for number, (stabilise, advised) in enumerate(ways)
    ]
    figure = projection_figure(ranked_runs(runs, 0.0, 0.1, "projection"), "made up")
    for axes, share in zip(figure.axes, (1, 0.1, 2), strict=True):
        drawn = np.concatenate([points for label, points in lines_of(axes).items() if label.startswith("B2")])
        assert drawn == pytest.approx(np.array([(20 + 2 * k, share * 10.0**-k) for k in range(3)]))
    ways_named = ["feedback, advised", "feedback, given", "projection"]
    assert legend_of(figure)[1:] == [*ways_named, "tolerance 0.1", "cheapest: B2, h = 0.02 s"]


def test_where_nothing_is_drawn_a_figure_says_why() -> None:
    runs = [a_run("B2", 100, 1e-9), a_run("AB4", 80, 9.0, failure="too far"), a_run("SYM", 90, 1e-3)]
    figure = work_precision_figure(ranked_runs(runs, 1e-8, 1e-12), "made up", "trajectory")
    said = {axes.get_title(): " ".join(axes.texts[0].get_text().split()) for axes in figure.axes}
    assert said == {"B2": "errors below the reference's", "AB4": "every run diverged", "SYM": ""}
    assert not any("cheapest" in text for text in legend_of(figure))  # none is within the tolerance


def test_the_verdict_figure_shows_cells_boundary_and_disagreement() -> None:
    (axes,) = verdict_figure(MADE_UP, region(lookup("SYM"))).axes
    assert np.ma.masked_array(axes.images[0].get_array()).tolist() == [[0, 1, 1], [None, 0, 0]]
    lines = lines_of(axes)
    assert lines["disagree"].tolist() == [[1, 0], [1, 1], [2, 1]]
    assert lines["$|z_p| = 1$"][:-1] == pytest.approx(region(lookup("SYM")).boundary[0])
    assert axes.get_title().endswith("5 of 6 runs gave a verdict, 2 of them agree")
