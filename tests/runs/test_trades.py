from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest

from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs import trades
from bezstab.runs.accuracy_costs import NO_FEEDBACK, measured_runs, reference_run
from bezstab.runs.trades import ranked, trade
from bezstab.stabilising import NOTHING, after_step

ONE = Fraction(1)
SMALL = load_scene("pendulum"), 0.01, 0.1
SYM = lookup("SYM")
POINT = (Fraction(1), Fraction("0.5"))
small = partial(
    trade, "pendulum", (SYM,), (Fraction("0.02"), Fraction("0.01")), duration=Fraction("0.1"), numbers=POINT, repeats=1
)


def test_against_projection_each_method_runs_with_feedback_and_with_projection() -> None:
    asked = small()
    assert [(sweep.point, sweep.after) for sweep in asked.sweeps] == [((1, 0.5), NOTHING)]
    assert asked.omega is None  # no point is advised
    assert [(each.point, each.after) for each in small(against="projection", omega=ONE).sweeps] == [
        (None, NOTHING),
        ((1, 0.5), NOTHING),
        (NO_FEEDBACK, after_step("projection")),
    ]


def test_the_cheapest_within_the_tolerance_takes_the_largest_step_that_is_good_enough() -> None:
    asked = small()
    measured = [measured_runs(sweep) for sweep in asked.sweeps]
    larger, smaller = (run.trajectory_error or 0.0 for run in ranked(asked, measured).runs)
    for tolerance, h in ((larger, 0.02), (smaller, 0.01), (smaller / 2, None)):
        cheapest = ranked(replace(asked, tolerance=Fraction(tolerance)), measured).cheapest
        assert (cheapest.h if cheapest else None) == h


def test_all_runs_of_a_sweep_are_compiled_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trades, "reference_run", lambda *_: reference_run(*SMALL))  # that of 1e-5 s takes a minute
    for choice, names, least_step, expected in (
        ("auto", ["AB2"], "0.001", False),
        ("auto", ["AB2"], "1e-5", True),
        ("auto", ["AB2", "bdf2"], "1e-5", False),
        ("yes", ["AB2", "bdf2"], "0.001", False),
    ):
        monkeypatch.setenv("BEZSTAB_COMPILED", choice)
        steps = Fraction("0.001"), Fraction(least_step)
        asked = trade("pendulum", list(map(lookup, names)), steps, duration=ONE, numbers=POINT)
        assert {sweep.compiled for sweep in asked.sweeps} == {expected}
