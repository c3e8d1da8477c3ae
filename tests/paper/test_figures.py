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


@pytest.mark.parametrize(("step", "duration", "collapses"), [(0.1, 100.0, True), (0.05, 1.0, False)])
def test_figs_5_and_6_show_the_largest_error_so_far_and_a_cross_where_a_run_collapses(
    step: float, duration: float, collapses: bool
) -> None:
    runs = unstabilized_runs((step,), duration)
    figure = figures.drift_figure(runs)
    for (start, name, h), run in runs.items():
        axes = figure.axes[list(START_NAMES).index(start)]
        (line,) = (line for line in axes.lines if line.get_label() == f"{name}, {1e3 * h:g} ms")
        t, drawn = np.transpose(line.get_xydata())
        so_far = np.maximum.accumulate(np.abs(run.c[:, 0]))
        assert drawn == pytest.approx(np.interp(t, run.t, so_far))
        assert drawn[-1] == so_far[-1]
    crosses = sum(line.get_marker() == "x" for axes in figure.axes for line in axes.lines)
    assert crosses == sum(run.failure is not None for run in runs.values())
    (legend,) = figure.legends
    assert (figures.COLLAPSED in {text.get_text() for text in legend.get_texts()}) == collapses == (crosses > 0)


@pytest.mark.parametrize("derivative", [False, True])
def test_figs_7_and_8_draw_the_histories(derivative: bool) -> None:
    """Of those that grow, the first and the last, the absolute value on a logarithmic axis."""
    for place, (axes, run) in enumerate(zip(figures.histories_figure(derivative).axes, kicked_runs(), strict=True)):
        history = (run.cdot if derivative else run.c)[:, 0]
        grows = place in (0, 5)
        assert (axes.get_yscale() == "log", axes.get_ylabel().startswith("$|")) == (grows, grows)
        history = np.abs(history) if grows else history
        (line,) = axes.lines
        t, drawn = np.array(line.get_xdata()), np.array(line.get_ydata())
        assert t == pytest.approx(1e3 * run.t[: t.size])
        assert drawn == pytest.approx(history[: t.size])
        # the rest is its axis
        assert np.abs(history[t.size :]).max(initial=0.0) <= figures.VISIBLE * np.abs(history).max()
        assert f"{run.alpha_hat:g}" in axes.get_title()


def test_fig_9_keeps_the_papers_panels(monkeypatch: pytest.MonkeyPatch) -> None:
    runs = {(case, name): experiment(name, *map(float, case), duration=0.02) for case in TABLE_5 for name in COMPARED}
    monkeypatch.setattr(figures, "compared_runs", lambda: runs)
    figure = figures.compared_figure()
    shown = ["".join(sorted(str(line.get_label()) for line in axes.lines)) for axes in figure.axes]
    assert shown == ["RK4@5SIE", "AB4B4", "RK4@5SIE", "AB4B4", "AB4B4", "RK4@5SIE"]
    assert [axes.get_title()[0] for axes in figure.axes] == list("abcdef")
    for axes, case in zip(figure.axes, np.repeat(list(TABLE_5), 2, axis=0).tolist(), strict=True):
        assert axes.get_yscale() == "log"
        for line in axes.lines:
            run = runs[tuple(case), str(line.get_label())]
            assert np.array(line.get_ydata()).tolist() == np.abs(run.c[:, 0]).tolist()
