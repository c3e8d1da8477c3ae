from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bezstab.mechanism import Simulation
from bezstab.methods import lookup
from bezstab.paper import influence
from bezstab.paper.influence import (
    TABLE_4,
    VISIBLE,
    Behaviour,
    about_cases,
    angle_is_the_frequency,
    behaviour,
    derivative_behaves_alike,
    dominant_pole_is_seen_late,
    histories_figure,
    kicked_runs,
    physics_decides,
    regions_h_are_faster,
    report,
    smaller_poles_are_faster,
    unit_circle_decides,
)
from bezstab.stability import poles, region


@cache
def runs() -> list[Simulation]:
    return kicked_runs(lambda cases, label: cases)


@cache
def rows() -> list[Behaviour]:
    return [behaviour(run) for run in runs()]


def test_the_points_of_table_4_lie_where_the_paper_puts_them() -> None:
    edge = region(lookup("B4")).extent
    assert edge
    points = [(alpha_hat, beta_hat) for _, alpha_hat, beta_hat in TABLE_4]
    assert points[0][0] < 0 < min(points[5])
    # outside, though neither parameter exceeds what the region reaches
    assert points[5][0] < edge[0][1]
    assert points[5][1] < edge[1][1]
    for point, row in zip(points, rows(), strict=True):
        assert np.isclose(poles(lookup("B4"), *point), row.pole).any()
        if row.pole.imag > 0.01:  # else a double pole, where the decay is slower at first
            assert row.c.rate == pytest.approx(abs(row.pole), abs=0.03)  # the wave's phase at either end of the window
            if row.failure is None and row.c.rate > 0.9:  # it is followed to the end: a crossing each half turn
                assert row.c.crossings / row.followed == pytest.approx(np.angle(row.pole) / np.pi, rel=0.05)
        assert row.cdot.rate == pytest.approx(row.c.rate, abs=0.06)
        assert row.cdot != row.c
    corrected = [finding.claim for finding in about_cases(rows()) if finding.agreement != "confirmed"]
    assert corrected == ["the smaller |z_p|, the faster"]  # not so of double poles
    assert all(row.c.fallen > np.log(0.01) / np.log(abs(row.pole)) for row in (rows()[1], rows()[3]))


def test_cases_that_do_otherwise_are_not_confirmed() -> None:
    exchanged = [rows()[case] for case in (0, 3, 4, 1, 2, 5)]  # slow for fast
    assert derivative_behaves_alike(rows()).agreement == "confirmed"
    assert derivative_behaves_alike(exchanged).agreement == "not confirmed"
    grown = [replace(row, c=replace(row.c, rate=1 / row.c.rate)) for row in rows()]
    assert "in 0 of 6 cases" in unit_circle_decides(grown).here
    slower = [
        replace(
            row,
            c=replace(row.c, fallen=1000 - row.c.fallen),
            cdot=replace(row.cdot, fallen=1000 - row.cdot.fallen),
        )
        for row in rows()
    ]
    assert smaller_poles_are_faster(slower).agreement == regions_h_are_faster(slower).agreement == "not confirmed"
    turned = [replace(row, c=replace(row.c, crossings=row.followed - row.c.crossings)) for row in rows()]
    assert angle_is_the_frequency(turned).agreement == "not confirmed"


def test_a_pole_that_is_not_dominant_decides_first() -> None:
    found = dominant_pole_is_seen_late()
    assert found.agreement == "confirmed with a correction"
    moduli = np.abs(poles(lookup("AB4"), 0.5, 0.1))  # of pairs, descending
    assert f"poles of {moduli[0]:.4f} and {moduli[2]:.4f}" in found.here
    assert moduli[2] ** 27 == pytest.approx(1e-3, rel=0.3)  # what the kick has fallen to after 27 steps, as it says
    assert "in 27 steps" in found.here


def test_energy_tells_wrong_parameters(monkeypatch: pytest.MonkeyPatch) -> None:
    assert physics_decides().agreement == "confirmed"
    monkeypatch.setattr(influence, "TABLE_4", TABLE_4[::-1])  # case 3 for case 4, case 1 for case 6
    assert physics_decides().agreement == "not confirmed"  # case 1 grows too slowly for that


def test_a_report_makes_its_parts_and_says_how_many_runs_it_takes() -> None:
    seen = []

    def watched(cases, label):  # type: ignore[no-untyped-def]
        seen.append((label, len(cases)))
        return cases

    made = report(watched)
    assert {*made.tables, *made.figures} == {"table4", "fig7", "fig8"}
    assert seen == [("table4", 6)]
    assert made.findings


@pytest.mark.parametrize("derivative", [False, True])
def test_the_figures_draw_the_histories(derivative: bool) -> None:
    for axes, run in zip(histories_figure(runs(), derivative).axes, runs(), strict=True):
        history = (run.cdot if derivative else run.c)[:, 0]
        (line,) = axes.lines
        t, drawn = np.array(line.get_xdata()), np.array(line.get_ydata())
        assert t == pytest.approx(1e3 * run.t[: t.size])
        assert np.abs(history[t.size :]).max(initial=0.0) <= VISIBLE * np.abs(history).max()  # the rest is its axis
        assert drawn == pytest.approx(history[: t.size])
        assert f"{run.alpha_hat:g}" in axes.get_title()
