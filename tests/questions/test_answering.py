"""Answers: what is asked of them is found then, and agrees with the function that finds it."""

from dataclasses import replace
from fractions import Fraction
from functools import partial
from math import sqrt
from typing import Any

import numpy as np
import pytest

from bezstab.api import check
from bezstab.engines.conversions import Point
from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.goals import Goal
from bezstab.mechanism.equations import Mechanism
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.motion.spinning_bodies import spin_change
from bezstab.questions import answering
from bezstab.questions.answering import Answer, LargestStep, answers, engine_energy_rate
from bezstab.questions.question import Question
from bezstab.questions.scene_runs import SceneRun, scene_run
from bezstab.rationals import exact, rational
from bezstab.stability.choices import choose, describe_point
from bezstab.stability.feedback_costs import feedback_cost
from tests.reference.engine_steps import STEPS, matrix

SYM = (lookup("SYM"),)
ONE = Fraction(1)
POINT = (ONE, Fraction(1, 2))


def first(question: Question) -> Answer:
    return next(answers(question))


def test_an_answer_has_what_a_description_of_its_point_has() -> None:
    answer, described = first(Question(methods=SYM, point=POINT)), describe_point(SYM[0], "as given", *POINT)
    for name in ("verdict", "pole", "worst", "margins", "settle_steps"):
        assert getattr(answer, name) == getattr(described, name)
    assert (answer.role, answer.point, answer.safe) == ("given", POINT, True)
    assert answer.cost == feedback_cost(SYM[0], *POINT, least=False)
    assert (answer.moving, answer.setting) == (None, None)


def test_what_to_take_instead_is_not_looked_for_unless_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("looked for a choice")

    monkeypatch.setattr("bezstab.questions.answering.choose", refuse)
    assert [answer.role for answer in answers(Question(methods=SYM, point=POINT))] == ["given"]


def test_an_answer_begins_with_its_sentence_and_is_true_where_it_is_safe() -> None:
    """RK2 at α̂ = β̂ = 1 has |z| = 1/2: 2^-10 is below a thousandth; β alone may grow by √(1 + √3)."""
    judged = Question(methods=(lookup("RK2"),), point=(ONE, ONE), h=Fraction(1, 100))
    place = "α̂ = 1, β̂ = 1 (α = 50 1/s, β = 100 1/s at h = 0.01 s)"
    assert f"{sqrt(1 + sqrt(3)):.3g}" == "1.65"
    safe = first(judged)
    assert repr(safe).startswith(
        f"{place}: safe. An error falls to a thousandth in 0.1 s (10 steps). "
        "Each alone may grow: the step to 20 ms, α 2.5 times, β 1.65 times."
    )
    without_step = first(replace(judged, h=None))
    assert without_step.sentence == (
        "α̂ = 1, β̂ = 1: safe. An error falls to a thousandth in 10 steps. "
        "Each alone may grow: the step 2 times, α 2.5 times, β 1.65 times."
    )
    unsafe = first(replace(judged, point=(Fraction(5), Fraction(5))))
    assert repr(unsafe).startswith("α̂ = 5, β̂ = 5 (α = 250 1/s, β = 223.607 1/s at h = 0.01 s): not safe. Each step")
    assert bool(safe)
    assert not bool(unsafe)


def test_of_one_constraint_alone_nothing_is_said_to_grow_without_limit() -> None:
    """A chain of them has other limits."""
    brax = ENGINES["brax-positional"]
    answer = first(Question(methods=SYM, engine=brax, values=(Fraction(1, 2),), h=Fraction(1, 100)))
    assert ": safe for one constraint alone. An error falls to a thousandth in 0.2 s (20 steps)." in answer.sentence
    assert "grow" not in answer.sentence


def test_instead_is_what_choose_gives() -> None:
    instead = first(Question(methods=SYM, point=POINT)).instead
    chosen = choose(SYM[0])
    assert (instead.role, instead.goal) == ("instead", "accurate")
    assert (instead.alpha_hat, instead.beta_hat) == (chosen.alpha_hat, chosen.beta_hat)


def test_safe_is_what_is_safe_as_a_scene_moves() -> None:
    h = Fraction("0.01")
    weak = (Fraction("0.02"), Fraction("0.5"))
    assert first(Question(methods=SYM, point=weak, h=h)).safe
    moving = first(Question(methods=SYM, point=(Fraction("1.9"), Fraction("0.1")), h=h, scene="driven_four_bar"))
    assert moving.moving
    assert moving.safe == (moving.moving.verdict == "converges")


def test_an_engine_answers_for_every_point_that_it_takes() -> None:
    values = (Fraction("-135000"), Fraction("-920"))  # what solimp makes of large errors is another point
    small, large = answers(Question(engine=ENGINES["mujoco"], values=values, h=Fraction("0.002")))
    assert (small.verdict, large.verdict) == ("converges", "diverges")
    assert small.setting is None
    assert "solref" in str(small.instead.setting)


def test_a_given_point_is_compared_with_the_least_error_where_the_motion_is_known() -> None:
    """alpha = beta = 20 1/s, which is 270 times the least on a motion that nobody asked about."""
    asked = partial(Question, methods=(lookup("RK4"),), point=(Fraction("0.4"), Fraction("0.04")), h=Fraction("0.01"))
    told = first(asked())
    assert told.cost
    assert (told.cost.times_least, told.cost.times_least_velocity, told.cost.least_at) == (None, None, None)
    rates: list[dict[str, Any]] = [{"omega": Fraction(10)}, {"omega_h": Fraction("0.1")}]
    for known in rates:
        compared = first(asked(**known)).cost
        assert compared
        assert compared.times_least == pytest.approx(4.9, rel=0.01)
    assert first(asked(scene="slider_crank")).compared


RK4 = (lookup("RK4"),)
ASKED = r"RK4: α = 0\.56 ω, β = 0\.83 ω, ω the rate of your motion in rad/s: give --omega or --scene"


def test_a_choice_that_follows_the_motion_asks_for_its_rate() -> None:
    h = Fraction("0.05")
    wanting: list[dict[str, Any]] = [{}, {"h": h}, {"h": h, "h_max": 2 * h}]
    for asked in wanting:
        with pytest.raises(InputError, match=ASKED):
            Question(methods=RK4, goal="accurate", **asked)
    with pytest.raises(InputError, match=ASKED):
        Question(methods=(*SYM, *RK4), goal="accurate", h=h)
    with pytest.raises(InputError, match=ASKED):
        _ = first(Question(methods=RK4, point=POINT, h=h)).instead
    enough: list[dict[str, Any]] = [
        {"omega": Fraction(1)},
        {"omega_h": Fraction("0.01")},
        {"settle": Fraction(2)},
        {"goal": "robust"},
    ]
    for known in enough:
        assert first(Question(**{"methods": RK4, "goal": "accurate", "h": h, **known})).safe
    assert first(Question(methods=SYM, goal="accurate", h=h)).question.motion.assumed


def test_the_rate_of_a_motion_alone_gives_alpha_and_beta_and_how_large_the_step_may_be() -> None:
    chosen = first(Question(methods=RK4, goal="accurate", omega=Fraction(10)))
    at_a_step = first(Question(methods=RK4, goal="accurate", omega=Fraction(10), h=Fraction(1, 500)))
    assert (chosen.alpha, chosen.beta) == pytest.approx((at_a_step.alpha, at_a_step.beta), rel=1e-3)
    assert (chosen.alpha, chosen.beta) == pytest.approx((5.56, 8.28), rel=1e-3)
    assert chosen.alpha
    assert chosen.beta
    assert chosen.h_limit == pytest.approx(LargestStep(RK4[0], exact(chosen.alpha), exact(chosen.beta)).h_limit)
    with pytest.raises(InputError, match="--omega needs --h"):
        Question(methods=SYM, goal="accurate", omega=Fraction(10))


@pytest.mark.slow
def test_a_choice_that_is_not_safe_says_with_which_step_it_is() -> None:
    asked: dict[str, Any] = {"methods": (lookup("B4"),), "goal": "fastest", "scene": "four_bar"}
    chosen = first(Question(**asked, h=Fraction("0.005")))
    assert not chosen.safe
    assert chosen.safe_with
    option, value = chosen.safe_with.split()
    assert option == "--h"
    taken = first(Question(**asked, h=Fraction(value)))
    assert (taken.safe, taken.safe_with) == (True, None)


def test_a_choice_whose_run_fails_says_that_the_goal_robust_is_safe(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run of the fastest point is made to gain energy; that of robust is as it is."""
    question = Question(methods=SYM, goal="fastest", h=Fraction("0.002"), scene="driven_four_bar")
    fastest, run = choose(lookup("SYM"), "fastest", margins=False), scene_run

    def gains_there(mechanism: Mechanism, method: Method, h: Fraction, point: Point, time: float | None) -> SceneRun:
        found = run(mechanism, method, h, point, time)
        there = abs(float(point[0]) - fastest.alpha_hat) < 0.1
        return replace(found, gained=1.0) if there else found

    monkeypatch.setattr(answering, "scene_run", gains_there)
    chosen = first(question)
    assert (chosen.safe, chosen.safe_with) == (False, "--goal robust")


def test_faster_decay_costs_and_slower_decay_gains() -> None:
    chosen = first(Question(methods=(lookup("RK4"),), goal="accurate", h=Fraction("0.002"), omega=Fraction(5)))
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


def test_what_a_motion_gains_is_said_where_its_rate_is_given() -> None:
    """RK2 at (2, 1) makes a rotation break down after 1 / (2 g h omega^2), g = 1/4: 2 s; runs did after 2.08 s."""
    pumped = check("RK2", alpha=100, beta=100, h=Fraction(1, 100), omega=10)
    assert pumped.energy_rate is not None
    assert 1 / pumped.energy_rate[1] == pytest.approx(2.0, rel=0.02)
    assert "breaks down after about 2.0" in pumped.sentence
    assert check("RK2", alpha=100, beta=100, h=Fraction(1, 100)).energy_rate is None
    gentle = check("heun", alpha=20, beta=20, h=Fraction(1, 1000), omega=10)
    assert "gains" not in gentle.sentence


@pytest.mark.parametrize(("name", "h", "alpha", "safe"), [("RK2", "0.01", 100, False), ("heun", "0.01", 100, True)])
def test_a_scene_that_the_feedback_pumps_is_not_safe(name: str, h: str, alpha: float, safe: bool) -> None:
    answer = check(name, alpha=alpha, beta=alpha, h=Fraction(h), scene="pendulum")
    assert answer.verdict == "converges"
    assert answer.safe is safe
    assert "in a run of 10 s: |c| at most" in answer.sentence.lower()
    assert ("breaks down after about 27.8 s" in answer.sentence) is not safe


@pytest.mark.parametrize(
    ("engine", "sign"), [("chipmunk", -1), ("box2d-v2", -1), ("pbd=1", -1), ("mujoco=-720,-60", 1)]
)
def test_an_engine_says_what_its_step_does_to_a_spinning_body(engine: str, sign: int) -> None:
    answer = check(engine=engine, h=Fraction(1, 60), omega=6)
    assert answer.energy_rate is not None
    assert np.sign(answer.energy_rate[0]) == sign
    assert f"{'gains' if sign > 0 else 'loses'}" in answer.sentence
    if engine == "box2d-v2":  # minus h omega^2
        assert answer.energy_rate[0] == pytest.approx(-0.6, rel=1e-3)


def test_mujocos_impedance_counts_at_each_of_its_points() -> None:
    """(0.2, 0.2) pumps at d = 0.95 and brakes at 0.8: neutral at 0.87."""
    values = tuple(map(Fraction, ("-720", "-12", "0.8", "0.95")))
    soft, past = answers(Question(engine=ENGINES["mujoco"], values=values, h=Fraction(1, 60), omega=Fraction(6)))
    assert (soft.impedance, past.impedance) == (0.8, 0.95)
    assert soft.energy_rate is not None
    assert past.energy_rate is not None
    assert soft.energy_rate[0] < 0 < past.energy_rate[0]
    assert check(engine="mujoco", h=Fraction(1, 60), omega=6).impedance == 0.9
    assert check(engine="chipmunk", h=Fraction(1, 60), omega=6).impedance is None


@pytest.mark.parametrize("goal", ["robust", "fastest"])
def test_a_choice_that_does_not_weigh_the_motion_says_what_that_costs(goal: Goal) -> None:
    """Also where that is little."""
    kept = Question(methods=SYM, goal=goal, h=Fraction(1, 600), omega=Fraction(6))
    assert "A motion of 6 rad/s keeps its energy." in first(kept).sentence
    pumped = replace(kept, methods=(lookup("RK2"),), h=Fraction(1, 100))
    assert "A motion of 6 rad/s gains" in first(pumped).sentence
    run = Question(methods=SYM, goal=goal, h=Fraction(1, 100), scene="pendulum")
    assert "In a run of 10 s: |c| at most" in first(run).sentence


def test_a_run_says_that_it_has_no_soft_impedance() -> None:
    values = tuple(map(Fraction, ("-720", "-12", "0.95", "0.95")))
    soft = Question(engine=ENGINES["mujoco"], values=values, h=Fraction(1, 100), scene="pendulum")
    hard = replace(soft, values=(*values[:2], Fraction("0.9999"), Fraction("0.9999")))
    words = "The run is of hard constraints: an impedance d of 0.95 brakes besides."
    assert [words in first(question).sentence for question in (soft, hard)] == [True, False]


def test_so_does_a_choice_for_a_chain_in_an_engine() -> None:
    chain = Question(engine=ENGINES["chipmunk"], goal="robust", h=Fraction(1, 60), omega=Fraction(6))
    assert "A body that spins about a pin at 6 rad/s loses" in first(chain).sentence


@pytest.mark.parametrize(
    ("name", "point"), [("bullet", (1, 0.2)), ("jolt-spring", (1, 0.5)), ("xpbd", (0, 4)), ("brax-spring", (0.3, 0.1))]
)
def test_a_row_says_what_the_engines_own_step_does_to_a_motion(name: str, point: tuple[float, float]) -> None:
    """The shares that a step takes back, of velocity and error, are read from the step that the engine's source has."""
    engine, h, omega = ENGINES[name], Fraction(1, 60), Fraction(6)
    exact_point = (rational(str(point[0])), rational(str(point[1])))
    (of_place, _), (taken, kept) = matrix(STEPS[name], float(h), *map(float, engine.values(exact_point, h)))
    a, b = (1 - of_place, 0.0) if engine.energy_class == "projected" else (1 - kept, -taken * float(h))
    assert engine.energy_class
    expected = 2 * spin_change(engine.energy_class, a, b, float(omega * h)) / float(h)
    assert engine_energy_rate(engine, exact_point, h, omega) == pytest.approx(expected, rel=1e-6)


def test_an_engine_with_another_integrator_is_judged_by_that_integrator() -> None:
    """The classes of engines are those of their own steps."""
    answer = check("RK2", engine="mujoco=-10000,-200", h=Fraction(1, 100), omega=10)
    assert not answer.spins
    assert "a motion of 10 rad/s gains" in answer.sentence.lower()
