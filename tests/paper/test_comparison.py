import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper.comparison import (
    Runs,
    ab4_oscillates_fast,
    bezier_performs_better,
    compared_runs,
    misprints,
    oscillation_is_a_disadvantage,
    panels_figure,
    points_lie_as_said,
)
from bezstab.paper.experiments import experiment
from bezstab.paper.printed import COMPARED, TABLE_5
from bezstab.stability import dominant_pole, spectral_radius


@cache
def compared() -> Runs:
    return compared_runs(lambda keys, label: keys)


def test_a_misprint_is_noticed_and_a_half_digit_is_not() -> None:
    assert misprints(("0.600", "0.800", "1.0", "53.13"), 0.6 + 0.8j) == [None] * 4
    wrong = misprints(("0.600", "0.810", "1.0", "53.13"), 0.6 + 0.8j)
    assert wrong == [None, "0.810 should be 0.800", None, None]
    assert misprints(("0.12", "0.00", "0.1", "0.0"), 0.1249 + 0j) == [None] * 4
    cut_off, *rest = misprints(("-0.12", "0.00", "0.1", "180.0"), -0.1271 + 0j)
    assert (cut_off, rest) == ("-0.12 should be -0.13 (cut off, not rounded)", [None] * 3)


@pytest.mark.slow
def test_the_oscillation_of_rk4_is_that_of_feedback_chosen_for_stability() -> None:
    finding = oscillation_is_a_disadvantage(compared())
    assert finding.agreement == "not confirmed"
    rk4, b4, rk4_as_compared, b4_as_compared = map(float, re.findall(r"\d+e-\d+", finding.here))
    assert rk4 < b4
    assert rk4_as_compared > 1000 * b4_as_compared


@pytest.mark.slow
def test_the_edge_of_ab4_lies_between_the_second_and_the_third_point() -> None:
    edge = float(re.search(r"β̂ = ([.\d]+)", points_lie_as_said(compared()).here).group(1))  # type: ignore[union-attr]
    assert spectral_radius(lookup("AB4"), 0.5, edge) == pytest.approx(1, abs=2e-5)  # 1e-5 of β̂, and 2.6 a unit of it


@pytest.mark.slow
def test_ab4_makes_one_regular_wave_of_its_poles_angle_and_noise_is_irregular() -> None:
    turns = abs(np.angle(dominant_pole(lookup("AB4"), 0.5, 0.101))) / (2 * np.pi)  # a step of 1 ms
    shown = f"{1000 * turns:.0f} turns a second, each of {1 / turns:.2f} steps; but regular"
    assert shown in ab4_oscillates_fast(compared()).here
    run = compared()[3, "AB4"]
    noise = np.random.default_rng(1).normal(size=run.c.shape)
    noisy = replace(run, c=noise)
    assert "but irregular" in ab4_oscillates_fast({(3, "AB4"): noisy}).here


@pytest.mark.slow
def test_the_crank_is_as_wrong_as_an_independent_angle_says() -> None:
    """Angle after 10 s by two high-precision routes: 11.735910737052 rad."""
    last = {name: abs(compared()[1, name].q[-1, 0] - 11.735910737052) for name in COMPARED}
    here = bezier_performs_better(compared()).here
    assert all(f"{name} {last[name]:.0e}" in here for name in ("B4", "RK4@5", "SIE"))
    assert last["AB4"] < 1e-10 < last["B4"] < last["RK4@5"]


def test_fig_9_keeps_the_papers_panels() -> None:
    runs = {
        (case, name): experiment(name, *TABLE_5[case].point, duration=0.02) for case in TABLE_5 for name in COMPARED
    }
    figure = panels_figure(runs)
    shown = ["".join(sorted(str(line.get_label()) for line in axes.lines)) for axes in figure.axes]
    assert shown == ["RK4@5SIE", "AB4B4", "RK4@5SIE", "AB4B4", "AB4B4", "RK4@5SIE"]
    assert [axes.get_title()[0] for axes in figure.axes] == list("abcdef")
