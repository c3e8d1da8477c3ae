from dataclasses import replace

import numpy as np
import pytest

from bezstab.paper import drift
from bezstab.paper.drift import (
    COLLAPSE_DURATION,
    COLLAPSE_STEPS,
    GROWTH_DURATION,
    GROWTH_STEPS,
    collapse_findings,
    drift_figure,
    first_constraint_represents_all,
    growth_findings,
    large_steps_favour_b4,
    unstabilized,
)


@pytest.mark.slow
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
    assert {finding.claim: finding.agreement for finding in growth} == {
        "without stabilisation the violation grows linearly with time": "confirmed",
        "positions and velocities violate the constraints": "confirmed",
        "c_1 stands for all constraints": "confirmed with a correction",
        "both methods have the same order of error": "confirmed with a correction",
        "B4's error is slightly below AB4's": "confirmed with a correction",
        "B4 is more accurate in particular for large steps": "not confirmed",
    }
    runs = list(unstabilized(COLLAPSE_STEPS, COLLAPSE_DURATION))
    agreements = [finding.agreement for finding in collapse_findings(runs)]
    assert agreements == ["confirmed with a correction", "not confirmed", "confirmed"]
    ends = {(run.start, run.method.name, run.h): run.t[-1] for run in runs}
    failed = {(run.start, run.method.name, run.h) for run in runs if run.failure}
    for h in COLLAPSE_STEPS:
        assert {("euler", "B4", h), ("euler", "AB4", h)} <= failed
        assert ends["euler", "B4", h] > ends["euler", "AB4", h]
        assert ("rk4", "AB4", h) not in failed


def test_the_first_constraint_is_the_largest_and_its_derivative_is_followed() -> None:
    runs = list(unstabilized((0.01,), GROWTH_DURATION))
    for run in runs:
        c, cdot = run.observation.c, run.observation.cdot
        assert run.largest(50, 100, rate=True) == np.abs(cdot[5000:, 0]).max()
        assert np.abs(c).max(axis=0).argmax() == 0  # c_1 is the largest
    found = first_constraint_represents_all(runs)
    assert "in 4 of 4 runs" in found.here
    assert "3 to 30 times c_4" in found.here
    lost = replace(runs[0].observation, c=runs[0].observation.c[:, ::-1])
    assert first_constraint_represents_all([replace(runs[0], observation=lost)]).agreement != "confirmed"


@pytest.mark.parametrize(("factor", "agreement"), [(1.0, "not confirmed"), (1e-6, "confirmed with a correction")])
@pytest.mark.slow
def test_that_b4_is_better_for_large_steps_would_be_noticed(factor: float, agreement: str) -> None:
    runs = list(unstabilized((0.005, 0.01), GROWTH_DURATION))
    scaled = [
        replace(run, observation=replace(run.observation, c=factor * run.observation.c))
        if (run.method.name, run.h, run.start) == ("B4", 0.01, "rk4")
        else run
        for run in runs
    ]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drift, "GROWTH_STEPS", (0.005, 0.01))
        assert large_steps_favour_b4(scaled).agreement == agreement


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
