"""A question is whole, or it is none: what does not go together is refused where the question is made."""

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
MUJOCO = {"engine": ENGINES["mujoco"], "values": (Fraction(1, 50), Fraction(1))}
DRIVE = Drive(Fraction(1000), Fraction(80), Fraction("0.1"))


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"methods": SYM}, "a point is needed: --alpha with --beta, --engine, or --pd"),
        ({"point": POINT}, "which integrator?"),
        ({"methods": SYM, "point": POINT, "drive": DRIVE, "h": H}, "--pd takes the place of --alpha"),
        (MUJOCO, "need --h"),
        ({**MUJOCO, "drive": DRIVE, "h": H}, "--engine and --pd each give a point"),
        ({"methods": SYM, "point": POINT, "as_typed": True}, "--as-typed needs --engine"),
        ({"methods": SYM, "point": POINT, "h": H, "h_max": H}, "--h-max needs --h-min"),
        ({"methods": SYM, "point": POINT, "h": H, "hold": True}, "--hold needs --h-min"),
        ({"methods": SYM, "point": POINT, "h": H, "h_min": 2 * H}, "expected at most the longest step"),
        ({"methods": SYM, "point": POINT, "h_min": H}, "--h-min needs --h-max or --h"),
        ({"methods": (lookup("B4"),), "point": POINT, "h": H, "h_min": H / 2}, "B4 uses values of several steps"),
        ({"methods": SYM, "point": POINT, "speed": Fraction(2)}, "--speed needs --scene"),
        ({"methods": SYM, "point": POINT, "h": Fraction(0)}, "h = 0 s: expected"),
        ({"methods": SYM, "goal": "quick"}, "goal 'quick': expected accurate, robust, fastest, critical, gentle"),
        ({"methods": SYM, "goal": "gentle", "h": H}, "--goal gentle needs --settle"),
        ({"methods": SYM, "goal": "fastest", "h": H, "settle": H}, "--settle goes with --goal gentle or accurate"),
        ({"methods": SYM, "goal": "robust", "spread": 1.0}, "--spread 1: expected a share"),
        ({"methods": SYM, "goal": "fastest", "h": H, "h_max": 2 * H}, "only for --goal accurate, robust or --h-min"),
        ({"goal": "robust", "engine": ENGINES["bullet"], "h": H, "h_max": 2 * H}, "told by `check --engine`"),
        ({"goal": "robust", "engine": ENGINES["pinocchio"], "h": H}, "has no integrator of its own"),
        (
            {"methods": (lookup("RK4"),), "goal": "robust", "engine": ENGINES["bullet"], "h": H},
            "only with --method SYM",
        ),
    ],
)
def test_what_does_not_go_together_is_refused(asked: dict[str, Any], message: str) -> None:
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
