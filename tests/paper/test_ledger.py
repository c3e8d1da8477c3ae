"""The numbers of figures/LEDGER.md, claim by claim: what the paper says, and what comes out."""

from collections.abc import Callable
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

from bezstab.mechanism.constraint_normals import constraint_motion
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import Simulation
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import evaluations
from bezstab.paper.experiments import (
    START_NAMES,
    TABLE_4,
    compared_runs,
    experiment,
    kicked_runs,
    largest,
    pole,
    unstabilized_runs,
)
from bezstab.paper.figures import COLLAPSE, GROWTH
from bezstab.paper.printed import COMPARED, TABLE_5
from bezstab.rationals import exact
from bezstab.stability.arrays import FloatArray
from bezstab.stability.best_points import best_point
from bezstab.stability.closed_loop import poles, verdict
from bezstab.stability.feedback_costs import feedback_cost
from bezstab.stability.regions import region
from tests.paper.record_times import costs

CASES = tuple(TABLE_5)


# The regions: Figs. 1 to 3


def test_section_5_1_the_least_moduli() -> None:
    best = [best_point(lookup(name)) for name in ("B2", "B3", "B4")]
    assert [each and round(each.z_abs, 5) for each in best] == [0.57735, 0.60698, 0.62588]


@pytest.mark.parametrize(
    "areas",
    [
        {"B2": 1.0792, "B3": 0.8867, "B4": 0.8097, "AB3": 0.3458, "AB4": 0.0646},
        {"RK4@5": 0.2606, "RK4@4": 0.5090, "SIE@2": 0.4142, "SYM": 4.0},  # figs 2, 3, abstract: at equal cost
        pytest.param({"AM3": 120.45, "AM4": 20.10, "ABM3@2": 0.396, "ABM4@2": 0.181}, marks=pytest.mark.slow),
    ],
)
def test_introduction_abstract_and_figs_2_and_3_how_large_the_regions_are(areas: dict[str, float]) -> None:
    found = {name: region(lookup(name)).area for name in areas}
    assert found == pytest.approx(areas, rel=3e-3 if "AM3" in areas else 0, abs=5e-5)


@pytest.mark.parametrize(
    ("point", "converge", "diverge"),
    [
        ((0, 0), "", "B2 B3 B4 AB2 AB3 AB4"),  # section 3: without feedback
        ((2, 2), "", "B2 B3 B4 AB4"),  # positive parameters are not enough
        ((1.01, 0.26), "B4", "AB4"),  # section 6: each is stable somewhere where the other is not
        ((0, 0.18), "AB4", "B4"),
        ((0.78, 0.34), "B4", "RK4@5"),
        ((-0.08, 0.23), "RK4@5", "B4"),
        ((0.5, 0.10044), "AB4", ""),  # table 5: the edge lies between its second and its third point
        ((0.5, 0.10046), "", "AB4"),
    ],
)
def test_sections_3_and_6_and_table_5_who_is_stable_where(
    point: tuple[float, float], converge: str, diverge: str
) -> None:
    for names, expected in ((converge, "converges"), (diverge, "diverges")):
        assert {verdict(lookup(name), *map(exact, point)) for name in names.split()} <= {expected}


# The mechanism


@pytest.mark.slow
def test_section_5_2_what_is_wrong_at_the_start_stays_wrong() -> None:
    right, wrong = (experiment("AB4", kick=kick) for kick in (0.0, 1e-3))
    assert largest(right, 0, 10) < 1e-10
    assert largest(wrong, 9, 10) == pytest.approx(1.04e-3, abs=5e-6)


# No stabilisation: Figs. 5 and 6

without_feedback = cache(unstabilized_runs)


def end(run: Simulation) -> float:
    return float(run.t[-1]) if run.failure else np.inf


def of(
    figure: tuple[tuple[float, ...], float], number: Callable[[Simulation], float], start: str, name: str
) -> FloatArray:
    """Return a number of one method's runs, step by step."""
    return np.array([number(run) for (*made, _), run in without_feedback(*figure).items() if made == [start, name]])


@pytest.mark.slow
def test_fig_5_b4_collapses_later_only_after_a_start_of_low_order_and_each_collapse_is_sudden() -> None:
    seconds = {
        ("euler", "B4"): [1911, 312, 82],
        ("euler", "AB4"): [1468, 237, 64],
        ("rk4", "B4"): [np.inf, 1126, 292],
        ("rk4", "AB4"): [np.inf, np.inf, np.inf],
    }
    for (start, name), expected in seconds.items():
        assert of(COLLAPSE, end, start, name) == pytest.approx(expected, abs=1)
    for run in without_feedback(*COLLAPSE).values():  # it grows in the last hundredth
        assert not run.failure or largest(run, 0, np.inf) > 5 * largest(run, 0, 0.99 * run.t[-1])


def final(run: Simulation) -> float:
    return largest(run, 80, 100)


@pytest.mark.slow
def test_fig_6_b4_has_the_smaller_error_only_after_a_start_of_low_order_and_never_for_large_steps_alone() -> None:
    h = np.log(GROWTH[0])
    ratios, powers = {}, {}
    for start in START_NAMES:
        b4, ab4 = (of(GROWTH, final, start, name) for name in ("B4", "AB4"))
        ratios[start] = b4 / ab4
        powers[start] = [round(np.polyfit(h, np.log(errors), 1)[0]) for errors in (b4, ab4)]
    assert powers == {"euler": [2, 2], "rk4": [2, 4]}
    assert ratios["euler"] == pytest.approx([0.78] * 4, abs=0.005)
    assert ratios["rk4"][-1] == pytest.approx(5e3, abs=5e2)
    assert ratios["rk4"].min() == ratios["rk4"][-1]


@pytest.mark.slow
def test_fig_6_the_error_grows_linearly_and_the_first_constraint_has_the_largest() -> None:
    above_rounding = [run for run in without_feedback(*GROWTH).values() if largest(run, 0, 100) > 1e-10]
    for run in above_rounding:
        assert largest(run, 0, 100) / largest(run, 0, 50) == pytest.approx(2, rel=0.05)  # the crank turns meanwhile
    sizes = np.array([np.abs(run.c).max(axis=0) for run in above_rounding])
    ratios = sizes[:, 0] / sizes[:, 3]
    assert (len(sizes), set(sizes.argmax(axis=1))) == (15, {0})
    assert (round(ratios.min()), round(ratios.max())) == (3, 32)


# What the poles do: Table 4, Figs. 7 and 8


def steps_to_a_hundredth(history: FloatArray) -> int:
    return int(np.flatnonzero(np.abs(history) > 0.01 * np.abs(history).max())[-1]) + 1


def test_section_4_smaller_poles_are_faster_but_for_double_ones_and_the_derivative_does_the_same() -> None:
    fallen = [[steps_to_a_hundredth(history[:, 0]) for history in (run.c, run.cdot)] for run in kicked_runs()[1:5]]
    assert fallen == [[333, 383], [233, 241], [18, 20], [13, 12]]  # |z_p|: 0.9802, 0.9810, 0.6835, 0.6836


def test_section_5_1_a_pole_that_is_not_dominant_decides_first() -> None:
    run = experiment("AB4", 0.5, 0.1, duration=1.0, kick=1e-3)
    c, moduli = np.abs(run.c[:, 0]), np.abs(poles(run.method, 0.5, 0.1))  # descending
    assert np.flatnonzero(c > 1e-6)[-1] + 1 == 27
    assert np.log(1e-3) / np.log(moduli[0]) == pytest.approx(5992, abs=0.5)


def test_section_3_energy_tells_wrong_parameters() -> None:
    energy = experiment("B4", *TABLE_4[5][1:], duration=0.5).energy  # case 6
    assert energy[-1] / energy[0] == pytest.approx(928, abs=0.5)


# Four methods at three points: Table 5, Fig. 9


@pytest.mark.slow
def test_fig_9_in_case_1_rk4_and_euler_oscillate_above_b4_and_ab4() -> None:
    left = {name: largest(compared_runs()[CASES[0], name], 8, 10) for name in COMPARED}
    assert left["AB4"] < 1e-13
    assert left["B4"] == pytest.approx(1e-10, abs=5e-11)
    assert left["RK4@5"] == pytest.approx(1.7e-7, abs=3e-8)
    assert left["SIE"] / left["RK4@5"] == pytest.approx(1.9, abs=0.05)


@pytest.mark.slow
def test_section_5_2_3_ab4_makes_one_regular_wave_of_its_dominant_poles() -> None:
    """A single pair of poles z makes c_{n+1} - 2 Re z c_n + |z|² c_{n-1} zero."""
    run = compared_runs()[CASES[2], "AB4"]
    z, c = pole(run), run.c[run.t >= 8, 0]
    assert np.angle(z) / (2 * np.pi) * 1000 == pytest.approx(429, abs=0.5)  # turns a second
    left = c[2:] - 2 * z.real * c[1:-1] + abs(z) ** 2 * c[:-2]
    assert np.abs(left).max() / np.abs(c).max() < 1e-3


@pytest.mark.slow
def test_section_6_the_crank_is_as_wrong_as_an_independent_angle_says() -> None:
    """Angle after 10 s by two high-precision routes: 11.735910737052 rad."""
    wrong = {name: abs(compared_runs()[CASES[0], name].q[-1, 0] - 11.735910737052) for name in COMPARED}
    assert wrong["AB4"] < 1e-10
    assert [float(f"{wrong[name]:.0e}") for name in ("B4", "RK4@5", "SIE")] == [3e-7, 4e-7, 8e-4]


@pytest.mark.slow
def test_section_6_the_oscillation_of_rk4_is_that_of_feedback_chosen_for_stability() -> None:
    omega = constraint_motion(compiled_mechanism(load_scene("slider_crank")), 10.0).omega
    for name, order, times, left in (("RK4@5", 4, (4e4, 9e4), 2e-12), ("B4", 2, (2e1, 9e1), 7e-12)):
        found = [feedback_cost(lookup(name), Fraction(a), Fraction(b), exact(omega) / 1000) for a, b in CASES]
        assert (found[0].order_left, found[0].order) == (2, order)
        forced = [cost.times_least or np.nan for cost in found]
        assert [float(f"{each:.0e}") for each in (min(forced), max(forced))] == list(times)
        assert found[0].least_at
        assert largest(experiment(name, *found[0].least_at), 8, 10) == pytest.approx(left, abs=6e-13)


# Costs: Table 6


@pytest.mark.slow
def test_table_6_the_four_methods_do_not_evaluate_the_same() -> None:
    starter = 3 * (evaluations(lookup("RK4")) - 1)
    expected = {"B4": 10000 + starter, "AB4": 10000 + starter, "RK4@5": 8000, "SIE": 20000}
    assert {row["method"]: row["evaluations"] for row in costs(repeats=1)} == expected
