from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.runs.simulating import RunQuestion, run_answer

QUESTION = RunQuestion(
    scene="pendulum",
    method=lookup("SYM"),
    duration=Fraction("0.1"),
    h=Fraction("0.01"),
    point=(Fraction(1), Fraction("0.5")),
)


def test_a_sequence_of_equal_steps_is_the_run_with_that_step() -> None:
    run, by_sequence = run_answer(QUESTION), run_answer(replace(QUESTION, sequence=(Fraction("0.01"),) * 2))
    np.testing.assert_allclose(by_sequence.q, run.q, rtol=1e-12)
    assert run.stabilise == by_sequence.stabilise == "baumgarte"


def test_projection_and_nothing_hold_the_constraints_without_a_point() -> None:
    projected = run_answer(replace(QUESTION, point=None, stabilise="projection", iterations=1))
    assert (projected.stabilise, projected.alpha_hat, projected.beta_hat) == ("projection", 0, 0)
    assert run_answer(replace(QUESTION, point=None, stabilise="none")).stabilise == "none"


def test_feedback_alone_has_a_point() -> None:
    for changed in ({"stabilise": "projection"}, {"stabilise": "none"}, {"point": None}):
        with pytest.raises(InputError, match="--stabilise baumgarte"):
            replace(QUESTION, **changed)
