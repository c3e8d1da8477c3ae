"""Answers: what is asked of them is found then, and agrees with the function that finds it."""

from fractions import Fraction
from math import inf

import pytest

from bezstab.engines import ENGINES, Drive
from bezstab.methods import lookup
from bezstab.questions import Answer, LargestStep, Question, answers
from bezstab.stability import choose, describe_point, feedback_cost

SYM = (lookup("SYM"),)
POINT = (Fraction(1), Fraction(1, 2))


def first(question: Question) -> Answer:
    return next(answers(question))


def test_an_answer_has_what_a_description_of_its_point_has() -> None:
    answer, described = first(Question(methods=SYM, point=POINT)), describe_point(SYM[0], "as given", *POINT)
    for name in ("verdict", "pole", "worst", "margins", "settle_steps"):
        assert getattr(answer, name) == getattr(described, name)
    assert (answer.role, answer.point, answer.safe) == ("given", POINT, True)
    assert answer.cost == feedback_cost(SYM[0], *POINT)
    assert (answer.moving, answer.varying, answer.gains, answer.setting) == (None, None, None, None)


def test_what_to_take_instead_is_not_looked_for_unless_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("looked for a choice")

    monkeypatch.setattr("bezstab.questions.answering.choose", refuse)
    assert [answer.role for answer in answers(Question(methods=SYM, point=POINT))] == ["given"]


def test_instead_is_what_choose_gives() -> None:
    instead = first(Question(methods=SYM, point=POINT)).instead
    chosen = choose(SYM[0])
    assert (instead.role, instead.goal) == ("instead", "accurate")
    assert (instead.alpha_hat, instead.beta_hat) == (chosen.alpha_hat, chosen.beta_hat)


def test_safe_is_what_is_safe_as_steps_vary_and_as_a_scene_moves() -> None:
    h = Fraction("0.01")
    weak = (Fraction("0.02"), Fraction("0.5"))
    assert first(Question(methods=SYM, point=weak, h=h)).safe
    varying = first(Question(methods=SYM, point=weak, h=h, h_min=h / 3, h_max=2 * h))
    assert varying.varying
    assert varying.safe == (varying.varying.varying == "proven")
    moving = first(Question(methods=SYM, point=(Fraction("1.9"), Fraction("0.1")), h=h, scene="driven_four_bar"))
    assert moving.moving
    assert moving.safe == (moving.moving.verdict == "converges")


def test_an_engine_answers_for_every_point_that_it_takes() -> None:
    values = (Fraction("-135000"), Fraction("-920"))  # what solimp makes of large errors is another point
    small, large = answers(Question(engine=ENGINES["mujoco"], values=values, h=Fraction("0.002")))
    assert (small.verdict, large.verdict) == ("converges", "diverges")
    assert small.setting is None
    assert "solref" in str(small.instead.setting)


LIMITS = [
    ("SYM", "1", "1/4", 2 - 1 / 8, 2, "kd"),  # 2 kd + kp < 4
    ("SYM", "1/10", "3", 1 / 2, 4 - 1 / 5, "kp"),
    ("SYM", "19/10", "1/2", 7 / 4, 1 / 5, "kd"),  # unstable: each is lowered until it is stable
    ("SYM", "3", "1/4", 2 - 1 / 8, None, "kd"),  # where one alone is too much the other does not help
    ("SYM", "1/10", "5", None, 4 - 1 / 5, "kp"),
    ("SYM", "3", "5", None, None, None),
    ("SYM", "0", "1/100", None, None, None),  # rounding on the circle is no decay
    ("imex-euler", "1", "1", inf, 6, "kp"),
    ("implicit-euler", "1", "1", inf, inf, None),
]


@pytest.mark.parametrize(("name", "kd", "kp", "kd_max", "kp_max", "used_up"), LIMITS)
def test_gains_reach_the_edge_of_what_is_stable(
    name: str, kd: str, kp: str, kd_max: float | None, kp_max: float | None, used_up: str | None
) -> None:
    """On an inertia of 1, with steps of 1 s, kd is alpha_hat and kp is beta_hat."""
    drive = Drive(Fraction(kp), Fraction(kd), Fraction(1))
    found = first(Question(methods=(lookup(name),), drive=drive, h=Fraction(1))).gains
    assert found
    assert (found.kd_max, found.kp_max) == pytest.approx((kd_max, kp_max))
    assert found.used_up == used_up


def test_faster_decay_costs_and_slower_decay_gains() -> None:
    chosen = first(Question(methods=(lookup("RK4"),), goal="accurate", h=Fraction("0.002")))
    assert chosen.faster
    assert abs(chosen.faster.pole) < abs(chosen.pole)
    assert chosen.slower
    assert abs(chosen.slower.pole) >= abs(chosen.pole)
    dearer, cheaper = chosen.times_the_errors(chosen.faster), chosen.times_the_errors(chosen.slower)
    assert dearer
    assert cheaper
    assert min(dearer) > 1 > max(cheaper)


def test_the_largest_step_of_alpha_and_beta_ends_where_they_do() -> None:
    found = LargestStep(SYM[0], Fraction(60), Fraction(55))
    h = Fraction(found.h_limit)
    assert 4 * 60 * h + 55**2 * h**2 == pytest.approx(4)  # 2 alpha_hat + beta_hat = 4
    assert not LargestStep(SYM[0], Fraction(0), Fraction(1)).safe
