"""Compiled steps against Python's: every bit of every run, and whatever ends one."""

import importlib.util
import math
from dataclasses import dataclass
from typing import cast

import numpy as np
import pytest

from bezstab.compiling import COMPILED_CHOICE
from bezstab.errors import InputError
from bezstab.mechanism import (
    Mechanism,
    Trajectory,
    compiled_mechanism,
    load_scene,
    parse_scene,
    shipped_scenes,
    simulate,
)
from bezstab.mechanism import compiled_steps as module
from bezstab.mechanism.compiled import machine_code_of
from bezstab.mechanism.compiled_steps import blocks_of_steps, runs_compiled
from bezstab.mechanism.generated_code import (
    AccelerationCode,
    MachineCode,
    Stepper,
    Unpacked,
    Yielded,
    compiled_source,
    generator_source,
)
from bezstab.mechanism.newton_iterations import Work
from bezstab.methods import Method, lookup
from bezstab.units import feedback_gains

H = 1e-3  # s
QUICK = ("AB3", "ABM2", "RK2", "SYM", "verlet-half")
"""Of each kind of method one that compiles fast: multistep, PECE, Runge-Kutta, partitioned, second order."""
KINDS = ("B4", "ABM4", "RK4", "SYM", "yoshida4")
IMPLICIT = ("hht", "bdf3", "am3", "verlet-implicit", "gauss4", "sdirk2", "stable-pd", "trapezoid", "implicit-euler")
"""Of each kind of method that solves equations: of one group or two, of one evaluation or two."""
SCENES = [name for name in shipped_scenes() if name != "n_four_bar"]
"""Besides the chain of 40 four-bars, whose 160 constraints take numba a minute and more: with one method it must do."""
PAIRS = [("slider_crank", name) for name in KINDS]
PAIRS += [(scene, QUICK[number % len(QUICK)]) for number, scene in enumerate(SCENES)]
PAIRS += [("n_four_bar", "SYM")]
"""Every scene with some kind, and every kind with some scene."""
IMPLICIT_PAIRS = list(zip(SCENES, IMPLICIT, strict=True))
"""Likewise; for the chain of 40 four-bars, which takes minutes to compile, the same chain of twelve stands."""


def step_for(scene: str) -> float:
    """Return a step (s) that the scene bears: Andrews' mechanism turns a hundred times as fast as the others."""
    return 1e-5 if scene == "andrews" else H


def assert_same(one: Trajectory, other: Trajectory) -> None:
    """Check that two runs are the same in every bit, signs of zeros included, and in all that is said of them."""
    for a, b in ((one.t, other.t), (one.q, other.q), (one.v, other.v)):
        assert a.tobytes() == b.tobytes()
    for key in ("evaluations", "failure", "least_pivot", "pivot_time", "iterations"):
        assert getattr(one, key) == getattr(other, key)


def both(mechanism: Mechanism, method: Method, steps: int, gains: tuple[float, float], h: float = H) -> Trajectory:
    """Return a run of the scene, the same by Python and by compiled steps; h in s."""
    duration = steps * h * float(method.step_multiple)
    runs = [simulate(mechanism, method, h, duration, gains, compiled=compiled) for compiled in (False, True)]
    assert_same(*runs)
    return runs[1]


@pytest.mark.parametrize("name", QUICK)
def test_each_kind_of_method_is_the_same_to_the_last_bit(name: str) -> None:
    run = both(compiled_mechanism(load_scene("pendulum")), lookup(name), 500, feedback_gains(0.3, 0.04, H))
    assert run.failure is None
    assert len(run.t) == 501


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "name"), PAIRS)
def test_every_scene_is_the_same_to_the_last_bit(scene: str, name: str) -> None:
    h = step_for(scene)
    run = both(compiled_mechanism(load_scene(scene)), lookup(name), 3000, feedback_gains(0.3, 0.04, h), h)
    assert len(run.t) > 100


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "name"), IMPLICIT_PAIRS)
def test_newtons_method_is_the_same_to_the_last_bit_in_every_scene(scene: str, name: str) -> None:
    h = step_for(scene)
    run = both(compiled_mechanism(load_scene(scene)), lookup(name), 1000, feedback_gains(0.3, 0.04, h), h)
    assert len(run.t) == 1001
    assert (run.iterations or 0) > 2000


def chain_of_twelve() -> Mechanism:
    """Return a chain of so many four-bars that its accelerations are compiled in parts."""
    upright = {"position": {"rod0.theta": math.pi / 2}, "velocity": {"rod0.theta": -1.0}}
    links = {"count": 12, "length": 1.0, "mass": 1.0}
    mechanism = compiled_mechanism(parse_scene({"name": "chain", "four_bar_chain": links, "initial": upright}))
    assert len(machine_code_of(mechanism).parts) > 10
    return mechanism


@pytest.mark.slow
def test_newtons_method_is_the_same_to_the_last_bit_in_a_chain_compiled_in_parts() -> None:
    run = both(chain_of_twelve(), lookup("implicit-euler"), 100, feedback_gains(0.3, 0.04, H))
    assert len(run.t) == 101


def test_newtons_method_is_the_same_whether_it_converges_or_ends_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """By its iterations, too, and across blocks, which keep the Jacobian from step to step."""
    mechanism, method = compiled_mechanism(load_scene("pendulum")), lookup("bdf2")
    assert both(mechanism, method, 500, feedback_gains(0.3, 0.04, H)).failure is None
    assert "blow-up" in str(both(mechanism, method, 100, feedback_gains(-1.0, 0.1, 0.3), 0.3).failure)
    monkeypatch.setattr(module, "BLOCK", 7)
    assert both(mechanism, method, 50, feedback_gains(0.3, 0.04, H)).failure is None
    ended = both(mechanism, method, 400, (0.0, 0.0), 0.1)
    assert len(ended.t) > 10
    assert "Newton's method did not converge in 25 iterations" in str(ended.failure)


def test_a_block_may_end_after_any_number_of_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "BLOCK", 7)
    mechanism = compiled_mechanism(load_scene("pendulum"))
    for name, steps in (("AB3", 2), ("AB3", 3), ("AB3", 9), ("AB3", 50), ("verlet-half", 50)):
        both(mechanism, lookup(name), steps, feedback_gains(0.3, 0.04, H))


def test_a_blow_up_comes_at_the_same_step_in_the_same_words() -> None:
    run = both(compiled_mechanism(load_scene("pendulum")), lookup("AB3"), 3000, feedback_gains(3.0, 3.0, H))
    assert "blow-up" in str(run.failure)
    assert 1 < len(run.t) < 3001


def test_a_singular_configuration_ends_both_alike() -> None:
    mechanism = compiled_mechanism(load_scene("pendulum"))
    state = (np.array([1e-160, 0.0]), np.array([0.0, 0.0]))  # the square of its length is no normal number
    runs = [
        simulate(mechanism, lookup("AB3"), H, 0.1, (0.0, 0.0), state, "euler", compiled=compiled)
        for compiled in (False, True)
    ]
    assert_same(*runs)
    assert runs[1].failure


@dataclass(frozen=True)
class OneCoordinate:
    """As much of a mechanism as steps need."""

    size: int = 1


@pytest.mark.parametrize(
    "refused", ["1.0 / q0", "sqrt(q0 - 0.5)", "sin(1e308 * (2.0 - q0))", "cos(1e308 * (2.0 - q0))"]
)
def test_what_python_refuses_is_refused_after_the_steps_before(refused: str, monkeypatch: pytest.MonkeyPatch) -> None:
    stepper = Stepper(
        arguments="state, past",
        opening=("k = 0", Unpacked(("q0", "v0"), "(q0, v0,) = state")),
        turn=("worst_pivot = 1.0", "q0 = q0 - 1.0", f"v0 = {refused}", Yielded(("q0", "v0"), ("v0", "v0"))),
    )
    in_python = []
    with pytest.raises((ArithmeticError, ValueError)) as wanted:
        in_python.extend(compiled_source(generator_source(stepper), math)["run"](0.0, 0.1, 0.0, 0.0, (4.0, 0.0), ()))
    for name in ("stepper_of", "machine_stepper_of"):
        monkeypatch.setattr(module, name, lambda mechanism, method: stepper)
    monkeypatch.setattr(module, "machine_code_of", lambda mechanism: MachineCode(AccelerationCode(1, 0, (), ()), ()))
    states: list[list[float]] = []
    mechanism, method = cast(Mechanism, OneCoordinate()), lookup("RK1")
    for cached in (module._machine_block, module._python_block):
        cached.cache_clear()
    blocks = blocks_of_steps(mechanism, method, 0.0, 0.1, (0.0, 0.0), ((4.0, 0.0), ()), 9, Work())
    with pytest.raises(type(wanted.value)) as seen:
        states.extend(state for block in blocks for state in block.states.tolist())
    assert str(seen.value) == str(wanted.value)
    assert len(states) == 3
    assert [state[0] for state in states] == [3.0, 2.0, 1.0]


def test_runs_are_compiled_where_that_pays_or_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism, method = compiled_mechanism(load_scene("four_bar")), lookup("AB2")
    for choice, evaluations, expected in (
        ("auto", 10, False),
        ("auto", 10**8, True),
        ("no", 10**8, False),
        ("yes", 10, True),
    ):
        monkeypatch.setenv(COMPILED_CHOICE, choice)
        assert runs_compiled(mechanism, method, evaluations) is expected
        assert runs_compiled(mechanism, lookup("bdf2"), evaluations) is expected
    monkeypatch.setenv(COMPILED_CHOICE, "maybe")
    with pytest.raises(InputError, match="BEZSTAB_COMPILED=maybe: expected auto, yes or no"):
        runs_compiled(mechanism, method, 10)


def test_a_step_too_long_to_be_compiled_is_refused_where_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism, method = compiled_mechanism(load_scene("four_bar")), lookup("bdf2")
    monkeypatch.setenv(COMPILED_CHOICE, "yes")
    assert runs_compiled(mechanism, method, 10)
    monkeypatch.setattr(module, "MOST_LINES_ASKED_FOR", 50)
    with pytest.raises(InputError, match=r"--compiled yes: a step of bdf2 on .+ is \d+ lines of code"):
        runs_compiled(mechanism, method, 10)


def test_without_numba_runs_are_pythons_unless_it_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    mechanism, method = compiled_mechanism(load_scene("four_bar")), lookup("AB2")
    monkeypatch.delenv(COMPILED_CHOICE, raising=False)
    assert not runs_compiled(mechanism, method, 10**8)
    monkeypatch.setenv(COMPILED_CHOICE, "yes")
    with pytest.raises(InputError, match=r"pip install 'bezstab\[fast\]'"):
        runs_compiled(mechanism, method, 10)
