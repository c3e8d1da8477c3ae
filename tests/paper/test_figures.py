import numpy as np
import pytest

from bezstab.methods.registry import lookup
from bezstab.paper import figures
from bezstab.paper.experiments import START_NAMES, experiment, kicked_runs, unstabilized_runs
from bezstab.paper.printed import COMPARED, TABLE_5
from bezstab.stability.regions import region


def test_a_panel_of_fig_1_has_the_regions_s_and_h() -> None:
    axes = figures.faster_region_figure("B3").axes[0]
    lines = {str(line.get_label()): np.array(line.get_xydata()) for line in axes.lines}
    for label, level in (("$|z_p| = 1$", 1.0), ("$|z_p| = 0.7$", 0.7)):
        (boundary,) = region(lookup("B3"), level).boundary
        assert lines[label][:-1] == pytest.approx(boundary)


def test_figs_5_and_6_show_the_largest_error_so_far_and_a_cross_where_a_run_collapses() -> None:
    runs = unstabilized_runs((0.1,), 100.0)
    lines = {
        (axes.get_title(), line.get_label()): line
        for axes in figures.drift_figure(runs).axes
        for line in axes.lines[::-1]  # crosses have the labels of no line
    }
    for (start, name, _), run in runs.items():
        t, drawn = np.transpose(lines[f"start: {START_NAMES[start]}", f"{name}, 100 ms"].get_xydata())
        so_far = np.maximum.accumulate(np.abs(run.c[:, 0]))
        assert drawn == pytest.approx(np.interp(t, run.t, so_far))
        assert drawn[-1] == so_far[-1]
    crosses = sum(line.get_marker() == "x" for line in lines.values())
    assert crosses == sum(run.failure is not None for run in runs.values()) > 0


@pytest.mark.parametrize("derivative", [False, True])
def test_figs_7_and_8_draw_the_histories(derivative: bool) -> None:
    """Of those that grow, the first and the last, the absolute value on a logarithmic axis; the rest is small."""
    for place, (axes, run) in enumerate(zip(figures.histories_figure(derivative).axes, kicked_runs(), strict=True)):
        history = (run.cdot if derivative else run.c)[:, 0]
        grows = place in (0, 5)
        assert (axes.get_yscale() == "log") is grows
        t, drawn = np.transpose(axes.lines[0].get_xydata())
        assert t == pytest.approx(1e3 * run.t[: t.size])
        assert drawn == pytest.approx((np.abs(history) if grows else history)[: t.size])
        assert np.abs(history[t.size :]).max(initial=0.0) <= figures.VISIBLE * np.abs(history).max()


def test_fig_9_draws_the_errors_of_its_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = {(case, name): experiment(name, *map(float, case), duration=0.02) for case in TABLE_5 for name in COMPARED}
    monkeypatch.setattr(figures, "compared_runs", lambda: runs)
    drawn = [line for axes in figures.compared_figure().axes for line in axes.lines]
    for place, line in enumerate(drawn):
        run = runs[list(TABLE_5)[place // len(COMPARED)], str(line.get_label())]
        assert np.array(line.get_ydata()).tolist() == np.abs(run.c[:, 0]).tolist()
