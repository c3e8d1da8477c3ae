"""Compiled batches against numpy's: every number of every run."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.mechanism import (
    Mechanism,
    compiled_mechanism,
    constraint_errors,
    initial_state,
    load_scene,
    march,
    resume,
    resume_in_groups,
    states_needed,
)
from bezstab.methods import Method, lookup
from bezstab.units import feedback_gains
from tests.mechanism.test_compiled_steps import IMPLICIT_PAIRS, PAIRS, SCENES, chain_of_twelve, step_for

FloatArray = NDArray[np.float64]
H = 1e-3  # s
STEPS = 300  # more than a block
QUICK = ("AB3", "SYM", "verlet-half", "implicit-euler")
POINTS = 70
"""No multiple of LANES // 2: the last group is short."""


def both(mechanism: Mechanism, method: Method, h: float) -> tuple[FloatArray, FloatArray]:
    """Return c and q of runs kicked up and down, by numpy and compiled; some diverge. (steps, m + n, 2, points)."""
    step = h * float(method.step_multiple)
    alpha_hat, beta_hat = np.linspace(0.1, 2.5, POINTS), np.linspace(0.02, 2.0, POINTS)
    gains = feedback_gains(alpha_hat, beta_hat, h)
    history = [tuple(np.full(POINTS, x) for x in np.concatenate(initial_state(mechanism)))]
    slopes = []
    with np.errstate(all="ignore"):  # what diverges runs into infinity
        for _, (state, slope, _) in zip(
            range(states_needed(method)), march(mechanism, method, step, gains, history[0], "rk4", np), strict=False
        ):
            history.append(state)
            slopes.append(slope)
        undisturbed = history[-1]
        kick = np.array([[1e-6], [-1e-6]])
        history[-1] = tuple(x + kick for x in undisturbed)
        run = resume(mechanism, method, step, gains, history, slopes, np, undisturbed=undisturbed)
        times = np.arange(len(history), len(history) + STEPS) * step
        states = [next(run)[0][: mechanism.size] for _ in times]
        by_numpy = np.array([
            [*constraint_errors(mechanism, t, q), *q] for t, q in zip(times.tolist(), states, strict=True)
        ])  # fmt: skip
        compiled = np.full_like(by_numpy, np.inf)
        groups = resume_in_groups(mechanism, method, step, gains, history, slopes, undisturbed, STEPS)
        for some, blocks in groups:
            compiled[..., some] = np.concatenate([np.concatenate(c_and_q, axis=1) for c_and_q in blocks])
    return by_numpy, compiled


def assert_same(mechanism: Mechanism, method: Method, h: float = H) -> None:
    """Check that each number is the same, and so are the places where there is none."""
    by_numpy, compiled = both(mechanism, method, h)
    np.testing.assert_array_equal(compiled, by_numpy)
    assert np.isfinite(by_numpy[-1]).any()
    assert np.abs(np.nan_to_num(by_numpy)).max() > 0


@pytest.mark.parametrize("name", QUICK)
def test_each_kind_of_method_is_the_same_to_the_last_bit(name: str) -> None:
    scene = "driven_slider_crank" if name == "SYM" else "pendulum"  # where the time matters, and where it does not
    assert_same(compiled_mechanism(load_scene(scene)), lookup(name))


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "name"), [pair for pair in PAIRS if pair[0] in SCENES] + IMPLICIT_PAIRS)
def test_every_scene_is_the_same_to_the_last_bit(scene: str, name: str) -> None:
    assert_same(compiled_mechanism(load_scene(scene)), lookup(name), step_for(scene))


@pytest.mark.slow
def test_a_chain_compiled_in_parts_is_the_same_to_the_last_bit() -> None:
    assert_same(chain_of_twelve(), lookup("implicit-euler"))
