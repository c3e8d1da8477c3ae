from fractions import Fraction

import numpy as np
import pytest

from bezstab.engines import engine_and_values
from bezstab.errors import InputError
from bezstab.methods import lookup
from bezstab.questions.points import engine_holds, kick_response, meant_in_seconds

H = Fraction(1, 500)


def test_an_engines_clamps_are_noted_and_may_be_left_out() -> None:
    engine, values = engine_and_values("mujoco=0.0001,1")
    applied = engine.applied(values, H)
    assert applied.notes
    assert "refsafe raises timeconst" in applied.notes[0]
    typed = engine.applied(values, H, as_typed=True)
    assert typed.point == (Fraction(40), Fraction(400))
    assert typed.notes is None


def test_an_engine_may_take_further_points() -> None:
    engine, values = engine_and_values(f"mujoco={-0.54 / 0.002**2!r},{-1.84 / 0.002!r}")
    assert len(engine.applied(values, H).points) == 2


def test_an_engine_holds_alpha_hat_and_beta_hat_or_alpha_and_beta_or_is_refused() -> None:
    bullet, spring = engine_and_values("bullet=0.2"), engine_and_values("brax-spring=5000,20,1")
    assert engine_holds(*bullet, H, 2 * H, as_typed=False)
    assert not engine_holds(*spring, H, 2 * H, as_typed=False)
    with pytest.raises(InputError, match="box2d makes of these values neither"):
        engine_holds(*engine_and_values("box2d=60,2"), H, 2 * H, as_typed=False)


@pytest.mark.parametrize(
    ("alpha", "beta", "meant"),
    [("50", "50.5", True), ("1.5", "0.9", False), ("4", "3", False)],  # 4, 3: unstable, but no numbers of 1/s
)
def test_large_numbers_that_are_not_stable_are_meant_in_one_over_seconds(alpha: str, beta: str, meant: bool) -> None:
    assert meant_in_seconds([lookup("SYM")], (Fraction(alpha), Fraction(beta))) == meant
    assert not meant_in_seconds([lookup("implicit-euler")], (Fraction(alpha), Fraction(beta)))  # stable as typed


STEPS = 100


def test_the_decay_is_the_linear_recursion() -> None:
    assert kick_response(np.array([0.5 + 0j]), STEPS) == pytest.approx(0.5 ** np.arange(STEPS + 1))
    two = kick_response(np.array([0.4 + 0j, 0.5 + 0j]), STEPS)
    k = np.arange(STEPS + 1)
    assert two == pytest.approx(5 * 0.5**k - 4 * 0.4**k)


@pytest.mark.filterwarnings("error")
def test_a_decay_that_grows_beyond_float64_ends_there_in_silence() -> None:
    grown = kick_response(np.array([1e5 + 0j]), STEPS)
    assert grown[:60] == pytest.approx(1e5 ** np.arange(60.0))
    assert not np.isfinite(grown[-1])
