"""A choice is judged whole, and says what faster and slower decay would change."""

from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest

from bezstab.engines.conversions import Point
from bezstab.engines.engine_list import ENGINES
from bezstab.errors import InputError
from bezstab.feedback import judgement
from bezstab.feedback.checking import check, largest_step
from bezstab.feedback.choosing import choose
from bezstab.goals import Goal
from bezstab.mechanism.equations import Mechanism
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.questions.scene_runs import SceneRun, scene_run
from bezstab.rationals import exact
from bezstab.stability.choices import choose as choose_point
from bezstab.stability.sweeps import chain, swept_growth
from tests.cli.running import run
from tests.methods.kinds import sampled

ASKED = r"RK4: α = 0\.56 ω, β = 0\.83 ω, ω the rate of your motion in rad/s: give omega or scene"


def test_a_choice_that_follows_the_motion_asks_for_its_rate() -> None:
    with pytest.raises(InputError, match=ASKED):
        choose("RK4", h="0.05", h_max="0.1")
    enough: list[dict[str, Any]] = [{"omega": 1}, {"omega_h": "0.01"}, {"settle": 2}, {"goal": "robust"}]
    for known in enough:
        assert choose("RK4", h="0.05", **known).safe


def test_the_rate_of_a_motion_alone_gives_alpha_and_beta_and_how_large_the_step_may_be() -> None:
    chosen, at_a_step = choose("RK4", omega=10), choose("RK4", omega=10, h="1/500")
    assert chosen.alpha
    assert chosen.beta
    assert (at_a_step.alpha, at_a_step.beta) == pytest.approx((chosen.alpha, chosen.beta), rel=1e-3)
    assert chosen.h_limit == pytest.approx(largest_step("RK4", alpha=exact(chosen.alpha), beta=exact(chosen.beta)))
    with pytest.raises(InputError, match="omega needs h"):
        choose("SYM", omega=10)


def test_a_step_alone_is_looked_for_without_margins(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delattr(judgement, "stability_margins")
    assert "safe up to h = 0.3229 s" in run("choose --method RK4 --omega 10").stdout


@pytest.mark.slow
def test_a_choice_that_is_not_safe_says_with_which_step_it_is() -> None:
    chosen = choose("B4", goal="fastest", scene="four_bar", h="0.005")
    assert not chosen.safe
    assert chosen.safe_with
    option, value = chosen.safe_with.split()
    assert option == "--h"
    taken = choose("B4", goal="fastest", scene="four_bar", h=value)
    assert (taken.safe, taken.safe_with) == (True, None)


def test_a_choice_whose_run_fails_says_that_the_goal_robust_is_safe(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run of the fastest point is made to gain energy; that of robust is as it is."""
    fastest, run = choose_point(lookup("SYM"), "fastest"), scene_run

    def gains_there(mechanism: Mechanism, method: Method, h: Fraction, point: Point, time: float | None) -> SceneRun:
        found = run(mechanism, method, h, point, time)
        there = abs(float(point[0]) - fastest.alpha_hat) < 0.1
        return replace(found, gained=1.0, sound=False) if there else found

    monkeypatch.setattr(judgement, "scene_run", gains_there)
    chosen = choose("SYM", goal="fastest", h="0.002", scene="driven_four_bar")
    assert (chosen.safe, chosen.safe_with) == (False, "--goal robust")
    assert chosen.sentence.endswith("With --goal robust it is safe.")


def test_faster_decay_costs_and_slower_decay_gains() -> None:
    chosen = choose("RK4", h="0.002", omega=5, trades=True)
    assert chosen.trades
    faster, slower = chosen.trades
    assert faster.z_abs < abs(chosen.pole) <= slower.z_abs
    assert min(faster.times_the_errors) > 1 > max(slower.times_the_errors)
    other = check("RK4", alpha_hat=chosen.point[0], beta_hat=chosen.point[1], h="0.002", omega=5).cost
    assert other
    assert other == chosen.cost


@pytest.mark.parametrize("goal", ["robust", "fastest"])
def test_a_choice_that_does_not_weigh_the_motion_says_what_that_costs(goal: Goal) -> None:
    """Also where that is little."""
    assert "A motion of 6 rad/s keeps its energy." in choose("SYM", goal=goal, h="1/600", omega=6).sentence
    assert "A motion of 6 rad/s gains" in choose("RK2", goal=goal, h="1/100", omega=6).sentence
    assert "In a run of 10 s: |c| at most" in choose("SYM", goal=goal, h="1/100", scene="pendulum").sentence
    in_an_engine = choose(engine="chipmunk", goal="robust", h="1/60", omega=6)
    assert "A body that spins about a pin at 6 rad/s loses" in in_an_engine.sentence


@pytest.mark.parametrize(
    "name",
    sampled(
        [name for name, each in ENGINES.items() if each.sweeping and each.parameters],
        quick=["bullet", "chipmunk", "pbd"],
    ),
)
def test_a_line_to_paste_is_stable_in_a_chain_of_ten_also_if_it_were_a_tenth_stronger(name: str) -> None:
    """From `choose` as from what `check` gives instead."""
    engine, h = ENGINES[name], Fraction(1, 60)
    chosen = choose(engine=name, h=h)
    assert chosen.safe
    assert chosen.swept_over == "a chain of 10 equal bodies"
    assert engine.sweeping
    stronger = Fraction(chosen.alpha_hat), Fraction(chosen.beta_hat * 1.1)
    try:
        values = tuple(map(Fraction, engine.values(stronger, h)))
    except InputError:  # it has no words for so strong a feedback
        values = tuple(map(Fraction, engine.values(chosen.point, h)))
    step = engine.sweeping.step(engine.sweeping.iterations, h, *values)
    pairs = range(10) if engine.sweeping.together else None
    assert swept_growth(chain(10), step, pairs).decays
    given = check(engine=f"{name}={','.join(engine.values(chosen.point, h))}", h=h, instead=True)
    assert given.swept_over == "one constraint alone"
    assert given.instead
    assert given.instead.setting == chosen.setting


@pytest.mark.parametrize(("engine", "h", "sag"), [("mujoco", "0.002", "0.001"), ("jolt-spring", "1/60", "0.002")])
def test_a_sag_is_kept_to_by_the_line_to_paste_and_by_no_weaker_one(engine: str, h: str, sag: str) -> None:
    """What sags more is softer; MuJoCo's own row holds its offset against MuJoCo: tests/stability."""
    chosen = choose(engine=engine, h=h, sag=sag)
    assert chosen.safe
    assert chosen.sag == pytest.approx(float(sag), rel=1e-6)
    values = ENGINES[engine].values(chosen.point, Fraction(h))
    again = check(engine=f"{engine}={','.join(values)}", h=h, load="9.81")
    assert again.sag == pytest.approx(chosen.sag, rel=1e-6)
    twice = choose(engine=engine, h=h, sag=sag, load="19.62")
    assert twice.beta_hat > 1.5 * chosen.beta_hat
