"""Loops that take steps, numpy's and machine code's, alone and in batches: against plain steps; how runs end."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from bezstab.mechanism import programs
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import Block, Trajectory, march, resume, simulate, states_needed
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.mechanism.stepper import MOST_ITERATIONS, _inverses
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import implicit
from bezstab.stabilising import NOTHING, after_step
from bezstab.stability.arrays import FloatArray
from bezstab.units import feedback_gains
from tests.reference.plain_runs import plain_run

H = 1e-3  # s
EPS = np.finfo(float).eps
EXPLICIT_KINDS = ("B4", "AB3", "ABM2", "RK4", "SYM", "verlet-half")
KINDS = (*EXPLICIT_KINDS, "bdf2", "gauss4", "sdirk2", "hht")
"""Of each kind of method one."""


def step_for(scene: str) -> float:
    """Return a step (s) that the scene bears: Andrews' mechanism turns a hundred times as fast as the others."""
    return 1e-5 if scene == "andrews" else H


def assert_alike(one: Trajectory, other: Trajectory, tolerance: float = 1e-12, of_velocities: float = 0.0) -> None:
    """Check that two runs are the same but for rounding, and end alike; relative, of coordinates at least to 1.

    `of_velocities` (1/s) is what a unit of positions may add to the difference of velocities.
    """
    assert one.t == pytest.approx(other.t, abs=1e-14 * one.t[-1])
    if one.failure and other.failure:  # on the way there rounding grows
        assert one.failure[:40] == other.failure[:40]
        return
    of_size = max(1, abs(one.q).max())
    assert one.q == pytest.approx(other.q, rel=tolerance, abs=tolerance * of_size)
    close = tolerance * max(1, abs(one.v).max()) + of_velocities * of_size
    assert one.v == pytest.approx(other.v, rel=tolerance, abs=close)
    assert one.least_pivot == pytest.approx(other.least_pivot, rel=1e-9)
    for key in ("evaluations", "iterations", "failure"):
        assert getattr(one, key) == getattr(other, key)


def both(mechanism: Mechanism, name: str, count: int, gains: tuple[float, float], h: float = H) -> Trajectory:
    """Return a run of so many steps of h (s), the same by numpy and compiled."""
    method = lookup(name)
    duration = count * h * float(method.step_multiple)
    by_numpy, compiled = (simulate(mechanism, method, h, duration, gains, compiled=each) for each in (False, True))
    # BDF methods have velocities from differences of positions, each rounded some times: over h
    assert_alike(by_numpy, compiled, of_velocities=8 * EPS / h if name.startswith("bdf") else 0.0)
    return compiled


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.slow
def test_many_steps_are_the_plain_ones(name: str) -> None:
    """By numpy and, of explicit methods, compiled."""
    method, gains = lookup(name), feedback_gains(0.2, 0.02, H)
    solving = implicit(method)
    mechanism = compiled_mechanism(load_scene("pendulum" if solving else "slider_crank"))
    count = 100 if solving else 2000  # the plain steps of implicit methods take long
    run = simulate(mechanism, method, H, count * H, gains) if solving else both(mechanism, name, count, gains)
    states = np.concatenate([run.q, run.v], axis=1)
    first = states_needed(method)
    expected = plain_run(mechanism, method, H, gains, states[:first], count + 1 - first)
    n, tolerance = mechanism.size, 1e-10 if solving else 1e-12  # of velocities: rounding of positions over h
    assert states[first:, :n] == pytest.approx(expected[:, :n], abs=1e-12 * abs(states).max())
    assert states[first:, n:] == pytest.approx(expected[:, n:], abs=tolerance * abs(states).max())


@pytest.mark.parametrize("point", [{"name": "bdf2"}, {"name": "RK4", "after": after_step("projection")}])
def test_what_solves_equations_or_projects_is_not_compiled(point: dict[str, Any]) -> None:
    """Also where that is asked for."""
    mechanism, method = compiled_mechanism(load_scene("pendulum")), lookup(point["name"])
    after = point.get("after", NOTHING)
    gains = (0.0, 0.0) if after.projecting else (20.0, 100.0)
    plain, asked = (
        simulate(mechanism, method, H, 20 * H, gains, after=after, compiled=compiled) for compiled in (False, True)
    )
    assert_alike(plain, asked, tolerance=0.0)


def test_newtons_method_ends_runs_and_keeps_its_jacobian_across_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    mechanism = compiled_mechanism(load_scene("pendulum"))

    def bdf2(count: int, gains: tuple[float, float], h: float = H) -> Trajectory:
        return simulate(mechanism, lookup("bdf2"), h, count * h, gains)

    run = bdf2(500, feedback_gains(0.3, 0.04, H))
    assert run.failure is None
    assert run.iterations is not None
    assert run.iterations + 20 >= 3 * 500
    assert run.evaluations < 1.2 * run.iterations  # Jacobians are kept as long as they serve
    assert "blow-up" in str(bdf2(100, feedback_gains(-1.0, 0.1, 0.3), 0.3).failure)
    monkeypatch.setattr(programs, "NUMBERS_OF_A_BLOCK", 7 * 2 * mechanism.size)
    assert_alike(bdf2(500, feedback_gains(0.3, 0.04, H)), run, tolerance=0.0)
    ended = bdf2(400, (0.0, 0.0), 0.1)
    assert len(ended.t) > 10
    assert f"Newton's method did not converge in {MOST_ITERATIONS} iterations (last correction " in str(ended.failure)


def test_a_blow_up_comes_at_the_same_step_in_the_same_words() -> None:
    run = both(compiled_mechanism(load_scene("pendulum")), "AB3", 3000, feedback_gains(3.0, 3.0, H))
    assert "blow-up" in str(run.failure)
    assert 1 < len(run.t) < 3001


@pytest.mark.parametrize("compiled", [False, True])
def test_a_singular_configuration_ends_a_run(compiled: bool) -> None:
    mechanism = compiled_mechanism(load_scene("pendulum"))
    state = (np.array([1e-160, 0.0]), np.array([0.0, 0.0]))  # the square of its length is no normal number
    run = simulate(mechanism, lookup("AB3"), H, 0.1, (0.0, 0.0), state, "euler", compiled=compiled)
    assert run.failure


@pytest.mark.parametrize("name", ["SYM", "gauss4"])
@pytest.mark.slow
def test_kicked_runs_are_the_same_in_a_batch_compiled_and_alone(name: str) -> None:
    """With SYM on a scene that is driven: where the time matters. Some diverge, and are no numbers alike."""
    scene = "driven_slider_crank" if name == "SYM" else "slider_crank"
    mechanism, method, points = compiled_mechanism(load_scene(scene)), lookup(name), 70
    gains = feedback_gains(np.linspace(0.05, 3.0, points), np.linspace(0.01, 2.0, points), H)
    start = np.concatenate(initial_state(mechanism))
    together_at_first = np.repeat(start[:, np.newaxis], points, axis=1)
    blocks = march(mechanism, method, even_steps(H, states_needed(method), gains, (points,)), together_at_first)
    history = [together_at_first, *(state for block in blocks for state in block.states)]
    undisturbed = history[-1]
    history[-1] = undisturbed[:, np.newaxis] + np.array([[1e-6], [-1e-6]])
    count, first = 300, len(history) - 1
    after = even_steps(H, count, gains, (2, points), first)
    together = states_of(resume(mechanism, method, after, history, undisturbed=undisturbed))
    assert together.shape == (count, 2 * mechanism.size, 2, points)
    compiled = states_of(resume(mechanism, method, after, history, True, undisturbed))
    with np.errstate(invalid="ignore"):  # of what is infinite
        calm = (np.abs(together[:, :, 0] - together[:, :, 1]) < 1e-2).all(axis=(0, 1))
    assert calm.any()
    assert compiled[..., calm] == pytest.approx(together[..., calm], abs=1e-9)
    for point in np.flatnonzero(calm)[:2]:
        alone = states_of(
            resume(
                mechanism,
                method,
                even_steps(H, count, (gains[0][point], gains[1][point]), first=first),
                [*(state[:, point] for state in history[:-1]), history[-1][:, 0, point]],
                undisturbed=undisturbed[:, point],
            )
        )
        assert alone == pytest.approx(together[:, :, 0, point], abs=1e-9)


def states_of(blocks: Iterable[Block]) -> FloatArray:
    """Return all states of blocks."""
    return np.concatenate([block.states for block in blocks])


def test_a_matrix_without_inverse_spoils_no_other() -> None:
    found = _inverses(np.stack([np.eye(2), np.ones((2, 2)), np.array([[0.0, 2.0], [4.0, 0.0]])]))
    assert not np.isfinite(found[1]).all()
    assert np.array_equal(found[0], np.eye(2))
    assert np.array_equal(found[2], [[0.0, 0.25], [0.5, 0.0]])
