from dataclasses import replace

import numpy as np
import pytest

from bezstab.paper import drift
from bezstab.paper.drift import (
    GROWTH_DURATION,
    Runs,
    drift_figure,
    first_constraint_represents_all,
    large_steps_favour_b4,
    unstabilized,
)
from bezstab.paper.experiments import largest


def drifting(steps: tuple[float, ...], duration: float = GROWTH_DURATION) -> Runs:
    return unstabilized(steps, duration, "", lambda keys, label: keys)


def test_the_first_constraint_is_the_largest_and_its_derivative_is_followed() -> None:
    runs = drifting((0.01,))
    for run in runs.values():
        assert largest(run, 50, 100, rate=True) == np.abs(run.cdot[5000:, 0]).max()
        assert np.abs(run.c).max(axis=0).argmax() == 0  # c_1 is the largest
    found = first_constraint_represents_all(runs)
    assert "in 4 of 4 runs" in found.here
    assert "3 to 30 times c_4" in found.here
    key, run = next(iter(runs.items()))
    lost = replace(run, c=run.c[:, ::-1])
    assert first_constraint_represents_all({key: lost}).agreement != "confirmed"


@pytest.mark.parametrize(("factor", "agreement"), [(1.0, "not confirmed"), (1e-6, "confirmed with a correction")])
@pytest.mark.slow
def test_that_b4_is_better_for_large_steps_would_be_noticed(
    factor: float, agreement: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drift, "GROWTH_STEPS", (0.005, 0.01))
    runs = drifting((0.005, 0.01))
    run = runs["rk4", "B4", 0.01]
    scaled = replace(run, c=factor * run.c)
    assert large_steps_favour_b4({**runs, ("rk4", "B4", 0.01): scaled}).agreement == agreement


def test_the_figure_shows_the_largest_error_so_far_by_start_and_step() -> None:
    runs = drifting((0.05, 0.1), 100.0)
    figure = drift_figure(runs)
    panels = dict(zip(("euler", "rk4"), figure.axes, strict=True))
    assert "Euler" in panels["euler"].get_title()
    for (start, name, h), run in runs.items():
        lines = {str(line.get_label()): np.array(line.get_xydata()) for line in panels[start].lines}
        drawn = lines[f"{name}, {1e3 * h:g} ms"]
        so_far = np.maximum.accumulate(np.abs(run.c[:, 0]))
        assert drawn[:, 1] == pytest.approx(np.interp(drawn[:, 0], run.t, so_far))
        assert drawn[-1, 1] == so_far[-1]
        crossed = [line for line in panels[start].lines if line.get_marker() == "x"]
        assert len(crossed) == sum(other.failure is not None for (of, *_), other in runs.items() if of == start)
