"""Loops that take steps, numpy's and machine code's, alone and in batches: against plain steps; how runs end."""

import numpy as np
import pytest

from bezstab.mechanism import programs
from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import Trajectory, march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.units import feedback_gains

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


@pytest.mark.parametrize("name", EXPLICIT_KINDS)
@pytest.mark.slow
def test_machine_code_takes_the_steps_of_numpy(name: str) -> None:
    both(compiled_mechanism(load_scene("slider_crank")), name, 2000, feedback_gains(0.2, 0.02, H))


def test_a_blow_up_comes_at_the_same_step_in_the_same_words() -> None:
    run = both(compiled_mechanism(load_scene("pendulum")), "AB3", 3000, feedback_gains(3.0, 3.0, H))
    assert "blow-up" in str(run.failure)
    assert 1 < len(run.t) < 3001


def test_a_singular_configuration_ends_a_compiled_run() -> None:
    mechanism = compiled_mechanism(load_scene("pendulum"))
    state = (np.array([1e-160, 0.0]), np.array([0.0, 0.0]))  # the square of its length is no normal number
    assert simulate(mechanism, lookup("AB3"), H, 0.1, (0.0, 0.0), state, "euler", compiled=True).failure


def test_a_run_is_the_same_whatever_its_blocks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Jacobians are kept from one to the next."""
    mechanism = compiled_mechanism(load_scene("pendulum"))
    asked = mechanism, lookup("bdf2"), H, 0.1, feedback_gains(0.3, 0.04, H)
    whole = simulate(*asked)
    monkeypatch.setattr(programs, "NUMBERS_OF_A_BLOCK", 7 * 2 * mechanism.size)
    assert_alike(simulate(*asked), whole, tolerance=0.0)


@pytest.mark.parametrize(("name", "compiled"), [("SYM", False), ("SYM", True), ("gauss4", False)])
@pytest.mark.slow
def test_runs_side_by_side_are_those_of_each_alone(name: str, compiled: bool) -> None:
    """On a scene that is driven: where the time matters."""
    mechanism, method, count = compiled_mechanism(load_scene("driven_slider_crank")), lookup(name), 300
    gains = feedback_gains(np.array([0.05, 0.5, 1.0]), np.array([0.01, 0.2, 0.5]), H)
    start = np.repeat(np.concatenate(initial_state(mechanism))[:, np.newaxis], 3, axis=1)
    blocks = march(mechanism, method, even_steps(H, count, gains, (3,)), start, compiled=compiled)
    together = np.concatenate([block.states for block in blocks])
    for point in range(3):
        alone = simulate(mechanism, method, H, count * H, (gains[0][point], gains[1][point]))
        assert together[:, : mechanism.size, point] == pytest.approx(alone.q[1:], abs=1e-11)
