"""A question is whole, or it is none; tests/cli/mistakes.txt has what does not go together."""

from fractions import Fraction
from typing import Any

import pytest

from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.methods.registry import lookup
from bezstab.questions.question import Question, meant_in_seconds, usual_goal

SYM = (lookup("SYM"),)
POINT = (Fraction(1), Fraction(1, 2))
H = Fraction(1, 240)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"methods": SYM}, "a point is needed: --alpha with --beta, or --engine"),
        ({"methods": SYM, "point": POINT, "h": Fraction(0)}, "h = 0 s: expected"),
        ({"methods": SYM, "point": POINT, "h": H, "h_max": 2 * H}, "--h-max works only with --goal"),
    ],
)
def test_what_only_python_can_ask_is_refused_as_well(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Question(**asked)


def test_an_engine_brings_its_method() -> None:
    of_engine = Question(engine=ENGINES["mujoco"], values=(Fraction(1, 50), Fraction(1)), h=H)
    assert [method.name for method in of_engine.methods] == ["SYM"]


def test_the_usual_goal_is_accurate_and_in_an_engine_robust_unless_feedback_follows_the_motion() -> None:
    assert usual_goal(None) == "accurate"
    mujoco = ENGINES["mujoco"]
    goals = [
        usual_goal(ENGINES["box2d"]),
        usual_goal(mujoco),
        usual_goal(mujoco, (lookup("RK4"),)),
    ]
    assert goals == ["robust", "robust", "accurate"]


@pytest.mark.parametrize(
    ("alpha", "beta", "meant"),
    [("50", "50.5", True), ("1.5", "0.9", False), ("4", "3", False)],  # 4, 3: unstable, but no numbers of 1/s
)
def test_large_numbers_that_are_not_stable_are_meant_in_one_over_seconds(alpha: str, beta: str, meant: bool) -> None:
    point = Fraction(alpha), Fraction(beta)
    assert meant_in_seconds([lookup("SYM")], point, None) == meant
    assert not meant_in_seconds([lookup("implicit-euler")], point, None)  # stable as typed


@pytest.mark.parametrize(
    ("alpha", "beta", "h", "meant"),
    [
        ("5", "5", "1/100", True),  # a thousandth in 1.4 s
        ("1", "1", "1/100", True),  # stable as typed, and in 6.9 s
        ("1/2", "1/10", "1/100", False),  # in 700 s: a feedback that nobody has
        ("5", "5", "1", False),  # unstable in 1/s, too
    ],
)
def test_with_a_step_what_would_settle_is_asked_about(alpha: str, beta: str, h: str, meant: bool) -> None:
    assert meant_in_seconds([lookup("RK4")], (Fraction(alpha), Fraction(beta)), Fraction(h)) == meant
