import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper.experiments import COMPARED, experiment, influence, unstabilized
from bezstab.show.figures import comparison_of_methods_figure, influence_figure, unstabilized_figure


def test_the_growth_figure_shows_the_largest_error_so_far_by_start_and_step() -> None:
    runs = list(unstabilized((0.05, 0.1), 100.0))
    figure = unstabilized_figure(runs)
    panels = dict(zip(("euler", "rk4"), figure.axes, strict=True))
    assert "Euler" in panels["euler"].get_title()
    for run in runs:
        lines = {str(line.get_label()): np.array(line.get_xydata()) for line in panels[run.start].lines}
        drawn = lines[f"{run.run.method.name}, {1e3 * run.h:g} ms"]
        so_far = np.maximum.accumulate(np.abs(run.c))
        assert drawn[:, 1] == pytest.approx(np.interp(drawn[:, 0], run.run.t, so_far))
        assert drawn[-1, 1] == so_far[-1]
        crossed = [line for line in panels[run.start].lines if line.get_marker() == "x"]
        assert len(crossed) == sum(other.run.failure is not None for other in runs if other.start == run.start)


@pytest.mark.parametrize("derivative", [False, True])
def test_the_figures_of_table_4_draw_the_histories(derivative: bool) -> None:
    runs = list(influence())
    panels = influence_figure(runs, derivative).axes
    for axes, run in zip(panels, runs, strict=True):
        (line,) = axes.lines
        assert np.array(line.get_xdata()) == pytest.approx(1e3 * run.run.t)
        assert np.array(line.get_ydata()) == pytest.approx(run.seen.cdot[:, 0] if derivative else run.c)
        assert f"{run.alpha_hat:g}" in axes.get_title()


def test_the_figure_of_table_5_keeps_the_papers_panels() -> None:
    runs = [
        experiment(lookup(name), 1e-3, 0.02, a, b)
        for a, b in ((0.1, 0.1), (0.5, 0.1), (0.5, 0.101))
        for name in COMPARED
    ]
    figure = comparison_of_methods_figure(runs)
    shown = ["".join(sorted(str(line.get_label()) for line in axes.lines)) for axes in figure.axes]
    assert shown == ["RK4@5SIE", "AB4B4", "RK4@5SIE", "AB4B4", "AB4B4", "RK4@5SIE"]
    assert [axes.get_title()[0] for axes in figure.axes] == list("abcdef")
