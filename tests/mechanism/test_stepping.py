"""Loops that take steps, numpy's and machine code's, alone and in batches: against plain steps; how runs end."""

import numpy as np
import pytest

from bezstab.mechanism import programs
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import Trajectory, march, simulate
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.units import feedback_gains

H = 1e-3  # s
EXPLICIT_KINDS = ("B4", "AB3", "ABM2", "RK4", "SYM", "verlet-half")
KINDS = (*EXPLICIT_KINDS, "bdf2", "gauss4", "sdirk2", "hht")
"""Of each kind of method one."""


def step_for(scene: str) -> float:
    """Return a step (s) that the scene bears: Andrews' mechanism turns a hundred times as fast as the others."""
    return 1e-5 if scene == "andrews" else H


def assert_alike(one: Trajectory, other: Trajectory, tolerance: float = 1e-12) -> None:
    """Check that two runs are the same but for rounding, and end alike; relative, of coordinates at least to 1."""
    assert one.t == pytest.approx(other.t, abs=1e-14 * one.t[-1])
    if one.failure and other.failure:  # on the way there rounding grows
        assert one.failure[:40] == other.failure[:40]
        return
    for q, other_q in ((one.q, other.q), (one.v, other.v)):
        assert q == pytest.approx(other_q, rel=tolerance, abs=tolerance * max(1, abs(q).max()))
    assert one.least_pivot == pytest.approx(other.least_pivot, rel=1e-9)
    for key in ("evaluations", "iterations", "failure"):
        assert getattr(one, key) == getattr(other, key)


@pytest.mark.parametrize(("name", "point"), [*((name, (0.2, 0.02)) for name in EXPLICIT_KINDS), ("AB3", (3.0, 3.0))])
@pytest.mark.slow
def test_machine_code_takes_the_steps_of_numpy(name: str, point: tuple[float, float]) -> None:
    """Those of a run that blows up, too, which ends at the same step in the same words."""
    asked = compiled_mechanism(load_scene("slider_crank")), lookup(name), H, 2000 * H, feedback_gains(*point, H)
    by_numpy, compiled = (simulate(*asked, compiled=each) for each in (False, True))
    assert_alike(by_numpy, compiled)
    assert ("blow-up" in str(compiled.failure)) is (point[0] == 3)


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
    gains = feedback_gains(np.array([0.05, 1.0]), np.array([0.01, 0.5]), H)
    start = np.repeat(np.concatenate(initial_state(mechanism))[:, np.newaxis], 2, axis=1)
    blocks = march(mechanism, method, even_steps(H, count, gains, (2,)), start, compiled=compiled)
    together = np.concatenate([block.states for block in blocks])
    for point in range(2):
        alone = simulate(mechanism, method, H, count * H, (gains[0][point], gains[1][point]))
        assert together[:, : mechanism.size, point] == pytest.approx(alone.q[1:], abs=1e-11)
