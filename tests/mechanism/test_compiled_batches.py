"""Compiled batches against numpy's: every number of every run."""

from collections.abc import Iterator

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
from bezstab.mechanism.compiled_batches import LANES, batch_code
from bezstab.methods import Method, lookup
from bezstab.units import feedback_gains
from tests.mechanism.test_compiled_steps import PAIRS, step_for

FloatArray = NDArray[np.float64]
H = 1e-3  # s
STEPS = 300  # more than a block
QUICK = ("AB3", "SYM", "verlet-half")
POINTS = 70
"""No multiple of LANES // 2: the last group is short."""


def both(mechanism: Mechanism, method: Method, h: float) -> tuple[FloatArray, FloatArray]:
    """Return c of runs kicked up and down, some of which diverge, by numpy and compiled: (steps, m, 2, points)."""
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
        by_numpy = np.array([
            constraint_errors(mechanism, t, next(run)[0][: mechanism.size]) for t in times.tolist()
        ])  # fmt: skip
        compiled = np.full_like(by_numpy, np.inf)
        groups = resume_in_groups(mechanism, method, step, gains, history, slopes, undisturbed, STEPS)
        for some, blocks in groups:
            compiled[..., some] = np.concatenate(list(blocks))
    return by_numpy, compiled


def assert_same(mechanism: Mechanism, method: Method, h: float = H) -> None:
    """Check that each number is the same, and so are the places where there is none."""
    by_numpy, compiled = both(mechanism, method, h)
    np.testing.assert_array_equal(compiled, by_numpy)
    assert np.isfinite(by_numpy[-1]).any()
    assert np.abs(np.nan_to_num(by_numpy)).max() > 0


@pytest.mark.parametrize("name", QUICK)
def test_each_kind_of_method_is_the_same_to_the_last_bit(name: str) -> None:
    assert_same(compiled_mechanism(load_scene("pendulum")), lookup(name))


@pytest.mark.slow
@pytest.mark.parametrize(("scene", "name"), PAIRS)
def test_every_scene_is_the_same_to_the_last_bit(scene: str, name: str) -> None:
    assert_same(compiled_mechanism(load_scene(scene)), lookup(name), step_for(scene))


STEPPER = """
def run(start, h, two_alpha, beta_squared, state, past):
 k = 0
 (q0, v0,) = state
 (y_1_0, y_1_1,), (f_1_0, f_1_1,) = past[0]
 while True:
  worst_pivot = 1.0
  f0 = v0
  f1 = -beta_squared * q0
  v0 = v0 + h * f1
  q0 = q0 + h * (1.5 * f0 + -0.5 * f_1_0)
  f_1_0 = f0
  f_1_1 = f1
  k = k + 1
  yield (q0, v0,), (f0, f1,), worst_pivot
"""


def taken_by(source: str, steps: int, memory: list[float], gains: list[float]) -> list[float]:
    """Return c after so many steps of h = 0.5, as Python takes a batch function."""
    scope: dict[str, object] = {}
    exec(source, scope)
    batch = scope["batch"]
    errors = [0.0] * (LANES * steps)
    assert callable(batch)
    assert batch(0.0, 0.5, gains, 1, 0, steps, memory, errors) == steps
    return errors


def test_a_batch_is_the_stepper_for_each_run() -> None:
    code = batch_code(STEPPER, ["q0 + t"])
    assert code.entries == 8  # q0, v0, what is unpacked of the past, and the new slopes
    starts = [0.25 * lane for lane in range(LANES)]
    memory = starts + [1.0] * LANES + [0.0] * (6 * LANES)
    errors = taken_by(code.source, 3, memory, [0.0] * LANES + [float(lane % 3) for lane in range(LANES)])

    def one(q: float, beta_squared: float) -> Iterator[float]:
        v, before = 1.0, 0.0
        for k in range(3):
            slope = v
            v, q = v - 0.5 * beta_squared * q, q + 0.5 * (1.5 * slope - 0.5 * before)
            before = slope
            yield q + (1 + k) * 0.5

    for lane in range(LANES):
        assert errors[lane::LANES] == list(one(starts[lane], float(lane % 3)))


def test_pivots_and_what_no_run_needs_are_left_out() -> None:
    source = batch_code(STEPPER, ["q0"]).source
    assert "worst" not in source
    assert "yield" not in source
