"""Answers about steps that vary: given feedback, an engine's values, and feedback that is proven."""

from fractions import Fraction
from math import inf

import pytest

from bezstab.engines.engine_list import engine_and_values
from bezstab.methods.registry import lookup
from bezstab.step_sequences.answer import answers, engine_points, proven_choice, steps, why_words
from bezstab.step_sequences.varying_steps import Steps, VaryingSteps

H_MIN, H_MAX = Fraction(1, 240), Fraction(1, 60)


def test_held_feedback_is_the_same_at_every_step() -> None:
    answer = steps("SYM", alpha=1, beta="1/2", h_min=0.005, h_max=0.01, hold=True)
    assert (answer.alpha_hat, answer.beta_hat) == (Fraction(1), Fraction(1, 2))
    assert answer.safe
    assert "α̂ = 1, β̂ = 0.5 at every step" in answer.sentence


def test_whether_an_engine_holds_is_known_from_its_values() -> None:
    """Bullet's ERP is a share of the error, whatever the step; MuJoCo's time constant is in s."""
    for engine, hold in (("bullet=0.2", True), ("mujoco=0.5,1", False), ("brax-spring=5000,20,1", False)):
        named, values = engine_and_values(engine)
        points, asked = engine_points(named, values, Steps(H_MIN, H_MAX))
        assert asked.hold == hold
        assert points[0] == ("as given", named.applied(values, H_MAX).point)


def test_feedback_that_changes_with_the_error_is_proven_at_each_of_its_points() -> None:
    """MuJoCo's solimp makes it weaker where the error is small: there it is proven, past its width it is refuted."""
    values = "mujoco=0.02,0.3,0.3,0.95"
    named, numbers = engine_and_values(values)
    both = answers((), Steps(Fraction(1, 1200), Fraction(1, 120)), engine=named, values=numbers)
    assert [(each.goal, each.verdict) for each in both] == [("as given", "proven"), ("past solimp's width", "refuted")]
    assert steps(engine=values, h_min="1/1200", h_max="1/120").goal == "past solimp's width"


def test_feedback_is_found_that_is_proven_where_there_is_some() -> None:
    """Of SYM, held over a thousandfold range, robust is refuted and fastest, (1, 1), proven."""
    asked = Steps(Fraction(1, 10**5), Fraction(1, 100), hold=True)
    found = proven_choice(lookup("SYM"), asked)
    assert (found.goal, found.verdict) == ("fastest", "proven")
    assert (float(found.alpha_hat), float(found.beta_hat)) == pytest.approx((1, 1))
    none = proven_choice(lookup("generalized-alpha"), asked)
    assert (none.goal, none.verdict) == ("robust", "refuted")
    assert none.sentence.endswith("No other choice is proven for these steps.")


WORDS: dict[str, tuple[tuple[int, ...], float | None]] = {
    "Each round of 2 s, then 2 of 1 s multiplies the error by 1.78": ((2, 1, 1), 1.777),
    "Each round of 2 s, then 1 s does not let the error decay": ((2, 1), 1.000001),
    "Each round of 2 s, then 1 s multiplies the error by inf": ((2, 1), inf),
    "A step of 2 s alone does not decay": ((2,), 3.0),
}


def test_a_sequence_in_words() -> None:
    for words, (sequence, growth) in WORDS.items():
        found = VaryingSteps("refuted", sequence=tuple(map(Fraction, sequence)), growth=growth)
        assert why_words(found) == words
