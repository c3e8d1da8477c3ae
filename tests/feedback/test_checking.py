"""A point that is given is judged whole: each part agrees with the function that finds it."""

from dataclasses import fields, is_dataclass
from fractions import Fraction
from math import sqrt
from typing import Any

import pytest

from bezstab.engines.conversions import Point
from bezstab.engines.engine_list import ENGINES
from bezstab.feedback import columns
from bezstab.feedback.checking import check, checks, largest_step, step_answer
from bezstab.feedback.conditions import Conditions, Setup, conditions
from bezstab.feedback.judgement import Judgement
from bezstab.methods.registry import lookup
from bezstab.motion.spinning_bodies import spin_change
from bezstab.questions.energy import engine_energy_rate
from bezstab.questions.scene_runs import SceneRun
from bezstab.rationals import rational
from bezstab.stability.choices import Choice, choose
from tests.reference.engine_steps import STEPS, matrix

SYM, RK4 = lookup("SYM"), lookup("RK4")
ONE = Fraction(1)
POINT = (ONE, Fraction(1, 2))
AT: dict[str, Any] = {"alpha_hat": ONE, "beta_hat": Fraction(1, 2)}


def test_an_answer_is_complete_when_made() -> None:
    """Nothing of it is computed when it is touched: no property, nothing cached, nothing lazy."""
    for kind in (Choice, Judgement, Conditions, SceneRun):
        assert is_dataclass(kind)
        own = {name for base in kind.__mro__[:-1] for name in vars(base) if not name.startswith("_")}
        assert own <= {field.name for field in fields(kind)}, kind


def test_an_answer_begins_with_its_sentence_and_is_true_where_it_is_safe() -> None:
    """RK2 at α̂ = β̂ = 1 has |z| = 1/2: 2^-10 is below a thousandth; β alone may grow by √(1 + √3)."""
    place = "α̂ = 1, β̂ = 1 (α = 50 1/s, β = 100 1/s at h = 0.01 s)"
    assert f"{sqrt(1 + sqrt(3)):.3g}" == "1.65"
    safe = check("RK2", alpha_hat=1, beta_hat=1, h="1/100")
    assert repr(safe).startswith(
        f"{place}: safe at rest. An error falls to a thousandth in 0.1 s (10 steps). "
        "It stays stable with one of these alone: the step up to 20 ms, α up to 2.5 times, β up to 1.65 times."
    )
    assert safe.settle_seconds == pytest.approx(0.1)
    assert safe.tenth_seconds == pytest.approx(0.04)
    assert check("RK2", alpha_hat=1, beta_hat=1).sentence == (
        "α̂ = 1, β̂ = 1: safe at rest. An error falls to a thousandth in 10 steps. "
        "It stays stable with one of these alone: the step up to 2 times, α up to 2.5 times, β up to 1.65 times."
    )
    unsafe = check("RK2", alpha_hat=5, beta_hat=5, h="1/100")
    assert repr(unsafe).startswith("α̂ = 5, β̂ = 5 (α = 250 1/s, β = 223.607 1/s at h = 0.01 s): not safe. Each step")
    assert bool(safe)
    assert not bool(unsafe)


def test_instead_is_what_choose_gives() -> None:
    instead, chosen = check(SYM, **AT, instead=True).instead, choose(SYM)
    assert instead is not None
    assert (instead.goal, instead.alpha_hat, instead.beta_hat) == ("accurate", chosen.alpha_hat, chosen.beta_hat)
    wanting = check(RK4, **AT, h="0.05", instead=True)
    assert wanting.instead is None
    assert "RK4: α = 0.56 ω, β = 0.83 ω, ω the rate of your motion in rad/s" in str(wanting.instead_reason)


def all_points(values: str, h: str, **asked: Any) -> list[Judgement]:
    """Return the answers for every point that MuJoCo makes of its values."""
    typed = tuple(map(rational, values.split(",")))
    asked_of = conditions(Setup(h=Fraction(h), engine=ENGINES["mujoco"], values=typed, **asked))
    return checks((), asked_of)


def test_an_engine_answers_for_every_point_that_it_takes_with_its_impedance_there() -> None:
    """What solimp makes of large errors is another point; (0.2, 0.2) is neutral at d = 0.87."""
    assert [each.verdict for each in all_points("-135000,-920", "0.002")] == ["converges", "diverges"]
    soft, past = all_points("-720,-12,0.8,0.95", "1/60", omega=Fraction(6))
    assert (soft.impedance, past.impedance) == (0.8, 0.95)
    assert soft.energy_rate is not None
    assert past.energy_rate is not None
    assert soft.energy_rate.gained < 0 < past.energy_rate.gained


def test_a_given_point_is_compared_with_the_least_error_where_the_motion_is_known() -> None:
    """alpha = beta = 20 1/s, which is 270 times the least on a motion that nobody asked about."""
    at: dict[str, Any] = {"alpha_hat": "0.4", "beta_hat": "0.04", "h": "0.01"}
    told = check(RK4, **at).cost
    assert told
    assert (told.times_least, told.times_least_velocity, told.least_at) == (None, None, None)
    compared = check(RK4, **at, omega=10).cost
    assert compared
    assert compared.times_least == pytest.approx(4.9, rel=0.01)


def test_the_largest_step_of_alpha_and_beta_ends_where_they_do() -> None:
    h = Fraction(largest_step(SYM, alpha=60, beta=55))
    assert 4 * 60 * h + 55**2 * h**2 == pytest.approx(4)  # 2 alpha_hat + beta_hat = 4
    assert largest_step(SYM, alpha=0, beta=1) == 0
    assert not step_answer(SYM, Fraction(0), ONE).safe
    rounded = next(column for column in columns.STEPS if column.key == "h_limit")
    assert rounded.text(step_answer(lookup("RK2"), Fraction(60), Fraction(60))) == "0.03333"  # mu = -60 h, to -2
    assert step_answer(lookup("RK2"), Fraction(50), Fraction(50)).sentence.endswith(": safe up to h = 0.04 s.")


def test_what_a_motion_gains_is_said_where_its_rate_is_given() -> None:
    """RK2 at (2, 1) makes a rotation break down after 1 / (2 g h omega^2), g = 1/4: 2 s; runs did after 2.08 s."""
    pumped = check("RK2", alpha=100, beta=100, h="1/100", omega=10)
    assert "breaks down after about 2.0" in pumped.sentence
    assert check("RK2", alpha=100, beta=100, h="1/100").energy_rate is None
    assert "gains" not in check("heun", alpha=20, beta=20, h="1/1000", omega=10).sentence


def test_a_run_says_that_it_has_no_soft_impedance() -> None:
    words = "The run is of hard constraints: an impedance d of 0.95 brakes besides."
    soft, hard = (
        check(engine=f"mujoco=-720,-12,{d},{d}", h="1/100", scene="pendulum").sentence for d in ("0.95", "0.9999")
    )
    assert (words in soft, words in hard) == (True, False)


@pytest.mark.parametrize(
    ("name", "point"), [("bullet", (1, 0.2)), ("jolt-spring", (1, 0.5)), ("xpbd", (0, 4)), ("brax-spring", (0.3, 0.1))]
)
def test_a_row_says_what_the_engines_own_step_does_to_a_motion(name: str, point: tuple[float, float]) -> None:
    """The shares that a step takes back, of velocity and error, are read from the step that the engine's source has."""
    engine, h, omega = ENGINES[name], Fraction(1, 60), Fraction(6)
    exact_point: Point = (rational(str(point[0])), rational(str(point[1])))
    (of_place, _), (taken, kept) = matrix(STEPS[name], float(h), *map(float, engine.values(exact_point, h)))
    a, b = (1 - of_place, 0.0) if engine.energy_class == "projected" else (1 - kept, -taken * float(h))
    assert engine.energy_class
    expected = 2 * spin_change(engine.energy_class, a, b, float(omega * h)) / float(h)
    assert engine_energy_rate(engine, exact_point, h, omega) == pytest.approx(expected, rel=1e-6)


def test_an_engine_with_another_integrator_is_judged_by_that_integrator() -> None:
    """The classes of engines are those of their own steps."""
    answer = check("RK2", engine="mujoco=-10000,-200", h="1/100", omega=10)
    assert "a motion of 10 rad/s gains" in answer.sentence.lower()


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("size", ["1e-307", "1e150"])
def test_points_at_the_ends_of_float64_are_judged_in_silence(size: str) -> None:
    """z² (1 + α̂ + β̂) - z (2 + α̂) + 1: at huge α̂ = β̂ the larger root is a half."""
    answer = check("implicit-euler", alpha_hat=size, beta_hat=size)
    assert answer.safe
    assert abs(answer.pole) == pytest.approx(0.5 if size == "1e150" else 1)
