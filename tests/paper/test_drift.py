import numpy as np
import pytest

from bezstab.paper.drift import (
    COLLAPSE_DURATION,
    COLLAPSE_STEPS,
    GROWTH_DURATION,
    GROWTH_STEPS,
    collapse_findings,
    drift_figure,
    growth_findings,
    unstabilized,
)


def test_without_stabilisation_the_start_decides_who_wins() -> None:
    steps = (0.005, 0.01)
    runs = list(unstabilized(steps, GROWTH_DURATION))
    final = {(run.start, run.method.name, run.h): run.largest(80, 100) for run in runs}
    for h in steps:
        assert 0.7 < final["euler", "B4", h] / final["euler", "AB4", h] < 1
        assert final["rk4", "B4", h] / final["rk4", "AB4", h] > 1000
    linear = [np.log2(run.largest(0, 100) / run.largest(0, 50)) for run in runs]
    assert linear == pytest.approx(np.ones(8), abs=0.05)


@pytest.mark.slow
def test_what_figs_5_and_6_show() -> None:
    growth = growth_findings(list(unstabilized(GROWTH_STEPS, GROWTH_DURATION)))
    assert [finding.agreement for finding in growth] == ["confirmed", *["confirmed with a correction"] * 2]
    runs = list(unstabilized(COLLAPSE_STEPS, COLLAPSE_DURATION))
    (collapse,) = collapse_findings(runs)
    assert collapse.agreement == "confirmed with a correction"
    ends = {(run.start, run.method.name, run.h): run.t[-1] for run in runs}
    failed = {(run.start, run.method.name, run.h) for run in runs if run.failure}
    for h in COLLAPSE_STEPS:
        assert {("euler", "B4", h), ("euler", "AB4", h)} <= failed
        assert ends["euler", "B4", h] > ends["euler", "AB4", h]
        assert ("rk4", "AB4", h) not in failed


def test_the_figure_shows_the_largest_error_so_far_by_start_and_step() -> None:
    runs = list(unstabilized((0.05, 0.1), 100.0))
    figure = drift_figure(runs)
    panels = dict(zip(("euler", "rk4"), figure.axes, strict=True))
    assert "Euler" in panels["euler"].get_title()
    for run in runs:
        lines = {str(line.get_label()): np.array(line.get_xydata()) for line in panels[run.start].lines}
        drawn = lines[f"{run.method.name}, {1e3 * run.h:g} ms"]
        so_far = np.maximum.accumulate(np.abs(run.c))
        assert drawn[:, 1] == pytest.approx(np.interp(drawn[:, 0], run.t, so_far))
        assert drawn[-1, 1] == so_far[-1]
        crossed = [line for line in panels[run.start].lines if line.get_marker() == "x"]
        assert len(crossed) == sum(other.failure is not None for other in runs if other.start == run.start)
