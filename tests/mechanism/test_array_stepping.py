"""Steps by numpy's arrays: batches against runs alone, and against the same compiled."""

from collections.abc import Iterable

import numpy as np
import pytest

from bezstab.mechanism import (
    Block,
    How,
    compiled_mechanism,
    initial_state,
    load_scene,
    march,
    resume,
    states_needed,
)
from bezstab.methods import lookup
from bezstab.units import feedback_gains
from tests.reference.plain_second_order import FloatArray

H = 1e-3  # s


@pytest.mark.promise("Compiled runs (`--compiled`)")
@pytest.mark.parametrize("name", ["SYM", "gauss4"])
@pytest.mark.slow
def test_kicked_runs_are_the_same_in_a_batch_compiled_and_alone(name: str) -> None:
    """With SYM on a scene that is driven: where the time matters. Some diverge, and are no numbers alike."""
    scene = "driven_slider_crank" if name == "SYM" else "slider_crank"
    mechanism, method, points = compiled_mechanism(load_scene(scene)), lookup(name), 70
    gains = feedback_gains(np.linspace(0.05, 3.0, points), np.linspace(0.01, 2.0, points), H)
    start = np.concatenate(initial_state(mechanism))
    blocks = march(mechanism, method, H, gains, start[:, np.newaxis], "rk4", states_needed(method))
    history = [np.repeat(start[:, np.newaxis], points, axis=1), *(state for block in blocks for state in block.states)]
    undisturbed = history[-1]
    history[-1] = undisturbed[:, np.newaxis] + np.array([[1e-6], [-1e-6]])
    count = 300
    together = states_of(resume(mechanism, method, H, gains, history, count, undisturbed=undisturbed))
    assert together.shape == (count, 2 * mechanism.size, 2, points)
    compiled = states_of(resume(mechanism, method, H, gains, history, count, How(compiled=True), undisturbed))
    with np.errstate(invalid="ignore"):  # of what is infinite
        calm = (np.abs(together[:, :, 0] - together[:, :, 1]) < 1e-2).all(axis=(0, 1))
    assert calm.any()
    assert compiled[..., calm] == pytest.approx(together[..., calm], abs=1e-9)
    for point in np.flatnonzero(calm)[:2]:
        alone = states_of(
            resume(
                mechanism,
                method,
                H,
                (float(gains[0][point]), float(gains[1][point])),
                [*(state[:, point] for state in history[:-1]), history[-1][:, 0, point]],
                count,
                undisturbed=undisturbed[:, point],
            )
        )
        assert alone == pytest.approx(together[:, :, 0, point], abs=1e-9)


def states_of(blocks: Iterable[Block]) -> FloatArray:
    """Return all states of blocks."""
    return np.concatenate([block.states for block in blocks])
