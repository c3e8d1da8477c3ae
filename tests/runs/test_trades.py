from dataclasses import replace
from fractions import Fraction

import pytest

from bezstab.methods.registry import lookup
from bezstab.runs.accuracy_costs import NO_FEEDBACK, measured_runs
from bezstab.runs.trades import FrontQuestion, TradeQuestion
from bezstab.stabilising import NOTHING, after_step
from bezstab.stability.closed_loop import spectral_radius

SYM = lookup("SYM")
QUESTION = TradeQuestion(
    scene="pendulum",
    methods=(SYM,),
    steps=(Fraction("0.02"), Fraction("0.01")),
    duration=Fraction("0.1"),
    numbers=(Fraction(1), Fraction("0.5")),
    repeats=1,
)


def test_against_projection_each_method_runs_with_feedback_and_with_projection() -> None:
    assert QUESTION.treatments == [((1, 0.5), NOTHING)]
    (advised, given, projected) = replace(QUESTION, against="projection").treatments
    assert (advised, given) == ((None, NOTHING), ((1, 0.5), NOTHING))
    assert projected == (NO_FEEDBACK, after_step("projection"))
    assert QUESTION.rate is None  # no point is advised


def test_smaller_steps_cost_more_and_err_less() -> None:
    swept = QUESTION.swept([measured_runs(sweep) for sweep in QUESTION.sweeps])
    larger, smaller = swept.runs
    assert (larger.h, smaller.h) == (0.02, 0.01)
    assert larger.evaluations < smaller.evaluations
    assert larger.trajectory_error
    assert smaller.trajectory_error
    assert smaller.trajectory_error < larger.trajectory_error


def test_the_cheapest_within_the_tolerance_takes_the_largest_step_that_is_good_enough() -> None:
    measured = [measured_runs(sweep) for sweep in QUESTION.sweeps]
    larger, smaller = (run.trajectory_error or 0.0 for run in QUESTION.swept(measured).runs)
    for tolerance, h in ((larger, 0.02), (smaller, 0.01), (smaller / 2, None)):
        cheapest = replace(QUESTION, tolerance=Fraction(tolerance)).swept(measured).cheapest
        assert (cheapest.h if cheapest else None) == h


def test_a_front_has_the_speeds_that_were_asked_for() -> None:
    (front,) = FrontQuestion(methods=(SYM,), levels=(Fraction("0.9"),)).fronts()
    found = [float(spectral_radius(SYM, point.alpha_hat, point.beta_hat)) for point in front]
    assert found[0] == pytest.approx(0.9, abs=1e-6)


def test_all_runs_of_a_sweep_are_compiled_or_none(monkeypatch: pytest.MonkeyPatch) -> None:
    fast, implicit = lookup("AB2"), lookup("bdf2")
    for choice, methods, least_step, expected in (
        ("auto", [fast], "0.001", False),
        ("auto", [fast], "1e-5", True),
        ("auto", [fast, implicit], "1e-5", False),
        ("yes", [fast], "0.001", True),
        ("yes", [fast, implicit], "0.001", False),
        ("no", [fast], "1e-5", False),
    ):
        monkeypatch.setenv("BEZSTAB_COMPILED", choice)
        steps = Fraction("0.001"), Fraction(least_step)
        question = TradeQuestion(scene="pendulum", methods=methods, steps=steps, duration=Fraction(1))
        assert question.compiled is expected
