import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper.influence import TABLE_4, behaviours, findings, histories_figure, kicked_runs, report
from bezstab.stability import poles, region


def test_the_points_of_table_4_lie_where_the_paper_puts_them() -> None:
    rows = behaviours(kicked_runs())
    assert len(rows) == len(TABLE_4) == 6
    edge = region(lookup("B4")).extent
    assert edge
    outside = rows[5].case
    assert rows[0].case.alpha_hat < 0 < min(outside.alpha_hat, outside.beta_hat)
    assert outside.alpha_hat < edge[0][1]
    assert outside.beta_hat < edge[1][1]  # outside, though neither parameter exceeds what the region reaches
    for row in rows:
        assert np.isclose(poles(lookup("B4"), row.case.alpha_hat, row.case.beta_hat), row.pole).any()
        if row.pole.imag > 0.01:  # else a double pole, where the decay is slower at first
            assert row.rate == pytest.approx(abs(row.pole), abs=0.03)  # the wave's phase at either end of the window
            turns = np.angle(row.pole) / np.pi  # half turns, that is crossings, a step
            seen = row.crossings / (400 if row.failure is None and row.rate > 0.9 else row.crossings / turns)
            assert seen == pytest.approx(turns, rel=0.05)
    assert all(finding.agreement == "confirmed" for finding in findings(rows))


def test_a_report_makes_its_parts_and_says_how_many_runs_it_takes() -> None:
    seen = []

    def watched(runs, label, length):  # type: ignore[no-untyped-def]
        seen.append((label, length))
        return runs

    made = report(watched)
    assert {*made.tables, *made.figures} == {"table4", "fig7", "fig8"}
    assert seen == [("table4", 6)]
    assert made.findings


@pytest.mark.parametrize("derivative", [False, True])
def test_the_figures_draw_the_histories(derivative: bool) -> None:
    runs = list(kicked_runs())
    panels = histories_figure(runs, derivative).axes
    for axes, run in zip(panels, runs, strict=True):
        (line,) = axes.lines
        assert np.array(line.get_xdata()) == pytest.approx(1e3 * run.t)
        assert np.array(line.get_ydata()) == pytest.approx(run.cdot if derivative else run.c)
        assert f"{run.alpha_hat:g}" in axes.get_title()
