"""A question is whole, or it is none; tests/cli/mistakes.txt has what does not go together."""

from fractions import Fraction
from typing import Any

import pytest

from bezstab.engines import DRIVE_METHODS, ENGINES, Drive
from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.questions import Question, usual_goal

SYM = (lookup("SYM"),)
POINT = (Fraction(1), Fraction(1, 2))
H = Fraction(1, 240)
DRIVE = Drive(Fraction(1000), Fraction(80), Fraction("0.1"))


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"methods": SYM}, "a point is needed: --alpha with --beta, --engine, or --pd"),
        ({"methods": SYM, "point": POINT, "drive": DRIVE, "h": H}, "--pd takes the place of --alpha"),
        ({"methods": SYM, "point": POINT, "h": Fraction(0)}, "h = 0 s: expected"),
    ],
)
def test_what_only_python_can_ask_is_refused_as_well(asked: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Question(**asked)


def test_an_engine_brings_its_method_and_a_drive_all_ways_of_applying_it() -> None:
    of_engine = Question(engine=ENGINES["mujoco"], values=(Fraction(1, 50), Fraction(1)), h=H)
    assert [method.name for method in of_engine.methods] == ["SYM"]
    assert [method.name for method in Question(drive=DRIVE, h=H).methods] == list(DRIVE_METHODS)


def test_an_engine_says_itself_what_it_holds_while_steps_vary() -> None:
    steps = Question(engine=ENGINES["bullet"], values=(Fraction(1, 5),), h=H, h_min=H / 2).steps
    assert steps
    assert (steps.h_min, steps.h_max, steps.hold) == (H / 2, H, True)


def test_the_usual_goal_is_accurate_and_along_a_curve_or_of_a_drive_robust() -> None:
    assert [usual_goal(None, None), usual_goal(ENGINES["box2d"], None), usual_goal(None, DRIVE)] == [
        "accurate",
        "robust",
        "robust",
    ]
