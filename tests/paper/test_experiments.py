from functools import cache

import numpy as np
import pytest

from bezstab.methods import evaluations, lookup
from bezstab.paper.experiments import (
    COLLAPSE,
    COMPARED,
    GROWTH,
    TABLE_4,
    Experiment,
    _misprinted,
    behaviours,
    collapse_findings,
    comparison,
    comparison_findings,
    cost_findings,
    costs,
    growth_findings,
    influence,
    influence_findings,
    unstabilized,
)
from bezstab.paper.printed import TABLE_5, Finding
from bezstab.stability import poles, region


@cache
def compared() -> tuple[Experiment, ...]:
    return tuple(comparison())


def by_claim(findings: list[Finding], words: str) -> Finding:
    (found,) = (finding for finding in findings if words in finding.claim)
    return found


def test_the_points_of_table_4_lie_where_the_paper_puts_them() -> None:
    rows = behaviours(influence())
    assert len(rows) == len(TABLE_4) == 6
    edge = region(lookup("B4")).extent
    assert edge
    assert rows[0].alpha_hat < 0 < min(rows[5].alpha_hat, rows[5].beta_hat)
    assert rows[5].alpha_hat < edge[0][1]
    assert rows[5].beta_hat < edge[1][1]  # outside, though neither parameter exceeds what the region reaches
    for row in rows:
        assert np.isclose(poles(lookup("B4"), row.alpha_hat, row.beta_hat), row.pole).any()
        if row.pole.imag > 0.01:  # else a double pole, where the decay is slower at first
            assert row.rate == pytest.approx(abs(row.pole), abs=0.03)  # the wave's phase at either end of the window
            turns = np.angle(row.pole) / np.pi  # half turns, that is crossings, a step
            seen = row.crossings / (400 if row.failure is None and row.rate > 0.9 else row.crossings / turns)
            assert seen == pytest.approx(turns, rel=0.05)
    assert all(finding.agreement == "confirmed" for finding in influence_findings(rows))


def test_the_poles_of_table_5_are_as_printed_but_for_one() -> None:
    finding = by_claim(comparison_findings(compared()), "dominant poles")
    assert finding.agreement == "confirmed with a correction"
    assert finding.here == "B4 at (0.1, 0.1): 0.898 should be 0.899, 0.299 should be 0.300"
    assert sum(len(printed) for row in TABLE_5.values() for printed in row.values()) == 48


def test_a_misprint_is_noticed_and_a_half_digit_is_not() -> None:
    assert _misprinted(("0.600", "0.800", "1.0", "53.13"), 0.6 + 0.8j) == []
    assert _misprinted(("0.600", "0.810", "1.0", "53.13"), 0.6 + 0.8j) == ["0.810 should be 0.800"]
    assert _misprinted(("0.12", "0.00", "0.1", "0.0"), 0.1249 + 0j) == []


def test_what_fig_9_shows() -> None:
    findings = comparison_findings(compared())
    for words in ("case 2", "case 3"):
        assert by_claim(findings, words).agreement == "confirmed"
    for words in ("oscillate constantly", "damped out", "almost identically"):
        assert by_claim(findings, words).agreement == "confirmed with a correction"
    last = {(run.alpha_hat, run.beta_hat, run.run.method.name): run.envelope(8, 10) for run in compared()}
    assert len(last) == 3 * len(COMPARED)
    # AB4 alone has left the level of its truncation error, by the 1e4 that 1.0014^10000 = 1e6 allows
    assert last[0.5, 0.101, "AB4"] > 1e4 * last[0.1, 0.1, "B4"]
    assert max(value for key, value in last.items() if key != (0.5, 0.101, "AB4")) < 1e-6


def test_without_stabilisation_the_start_decides_who_wins() -> None:
    steps, duration = (0.005, 0.01), GROWTH[1]
    runs = list(unstabilized(steps, duration))
    final = {(run.start, run.run.method.name, run.h): run.envelope(80, 100) for run in runs}
    for h in steps:
        assert 0.7 < final["euler", "B4", h] / final["euler", "AB4", h] < 1
        assert final["rk4", "B4", h] / final["rk4", "AB4", h] > 1000
    linear = [np.log2(run.envelope(0, 100) / run.envelope(0, 50)) for run in runs]
    assert linear == pytest.approx(np.ones(8), abs=0.05)


@pytest.mark.slow
def test_what_figs_5_and_6_show() -> None:
    growth = growth_findings(list(unstabilized(*GROWTH)))
    assert [finding.agreement for finding in growth] == ["confirmed", *["confirmed with a correction"] * 2]
    runs = list(unstabilized(*COLLAPSE))
    (collapse,) = collapse_findings(runs)
    assert collapse.agreement == "confirmed with a correction"
    ends = {(run.start, run.run.method.name, run.h): run.run.t[-1] for run in runs}
    failed = {(run.start, run.run.method.name, run.h) for run in runs if run.run.failure}
    for h in COLLAPSE[0]:
        assert {("euler", "B4", h), ("euler", "AB4", h)} <= failed
        assert ends["euler", "B4", h] > ends["euler", "AB4", h]
        assert ("rk4", "AB4", h) not in failed


def test_the_four_methods_do_not_cost_the_same() -> None:
    rows = costs()
    assert [row.method.name for row in rows] == list(COMPARED)
    starter = 3 * (evaluations(lookup("RK4")) - 1)
    expected = {"B4": 10000 + starter, "AB4": 10000 + starter, "RK4@5": 8000, "SIE": 20000}
    assert {row.method.name: row.evaluations for row in rows} == expected
    assert rows[0].time_ratio == 1
    (finding,) = cost_findings(rows)
    assert finding.agreement == "not confirmed"
