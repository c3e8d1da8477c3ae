from fractions import Fraction

import pytest

from bezstab.engines import ENGINES
from bezstab.errors import InputError
from bezstab.questions import Chain, Question, answers

CHIPMUNK = ENGINES["chipmunk"]
DEFAULT = (Fraction("0.9") ** 60,)


def test_a_chain_decides_whether_an_answer_is_safe() -> None:
    asked = Chain(10, Fraction(10))
    (unsafe,) = answers(Question(engine=CHIPMUNK, values=DEFAULT, h=Fraction(1, 60), chain=asked))
    assert unsafe.verdict == "converges"
    assert not unsafe.safe
    assert unsafe.chain
    assert unsafe.chain.stable_iterations == 12
    enough = Chain(10, Fraction(10), iterations=12)
    (safe,) = answers(Question(engine=CHIPMUNK, values=DEFAULT, h=Fraction(1, 60), chain=enough))
    assert safe.safe
    assert enough.words == "a chain of 10 with the last body 10 times as heavy"
    assert Chain(3).words == "a chain of 3"


def test_the_engines_own_sweeps_are_taken_unless_others_are_asked_about() -> None:
    (answer,) = answers(Question(engine=ENGINES["ode"], values=(Fraction("0.2"),), h=Fraction(1, 60), chain=Chain(2)))
    assert answer.chain
    assert answer.chain.iterations == 20
    assert answer.chain.alone == pytest.approx(0.8, abs=1e-9)


def test_the_strongest_feedback_that_a_chain_allows() -> None:
    """A share of all of the error is stable in short chains, and there is nothing to set in an engine without words."""
    for name, setting in (("bullet", "ERP = 0.999999999"), ("physx", None)):
        chosen = Question(engine=ENGINES[name], goal="robust", h=Fraction(1, 60), chain=Chain(3))
        (answer,) = answers(chosen)
        assert answer.chain_setting == setting


def test_a_chain_needs_an_engine_that_sweeps() -> None:
    with pytest.raises(InputError, match="--chain needs --engine"):
        Question(point=(Fraction(1), Fraction(1)), chain=Chain(2), methods=())
    with pytest.raises(InputError, match="mujoco solves all constraints together"):
        Question(engine=ENGINES["mujoco"], values=(Fraction("0.02"), Fraction(1)), h=Fraction(1, 60), chain=Chain(2))
