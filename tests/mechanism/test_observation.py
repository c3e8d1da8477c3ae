from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import accelerations
from bezstab.mechanism.observation import observe
from bezstab.mechanism.scene_files import load_scene, parse_scene, shipped_scenes
from bezstab.mechanism.simulation import simulated
from bezstab.mechanism.start import constraint_errors, initial_state
from bezstab.methods.registry import lookup
from tests.mechanism.test_scenes import pendulum
from tests.reference.literal_equation_9 import literal_equation_9


@pytest.mark.parametrize("name", shipped_scenes())
def test_the_generated_code_solves_the_literal_equation_9(name: str) -> None:
    mechanism, random = compiled_mechanism(load_scene(name)), np.random.default_rng(2)
    q, v = (state + random.normal(0, 0.01, (20, mechanism.size)) for state in initial_state(mechanism))
    t, two_alpha, beta_squared = random.uniform(0, 1, 20), 30.0, 500.0
    seen = observe(mechanism, t, q, v, two_alpha, beta_squared)
    literal = literal_equation_9(mechanism, two_alpha, beta_squared)
    for k in range(20):
        expected = literal(t[k], q[k], v[k])
        scale = max(np.abs(expected.accelerations).max(), np.abs(expected.multipliers).max())
        assert seen.c[k] == pytest.approx(expected.c, abs=1e-13)
        assert seen.cdot[k] == pytest.approx(expected.cdot, abs=1e-12)
        rounding = 1e-14 * np.linalg.cond(expected.matrix) * scale
        assert seen.multipliers[k] == pytest.approx(expected.multipliers, abs=rounding)
        found = accelerations(mechanism, t[k], two_alpha, beta_squared, q[k], v[k])
        assert found == pytest.approx(expected.accelerations.tolist(), abs=rounding)


@pytest.mark.parametrize("h", [1e-3, 7e-3, 2e-2])
def test_every_passage_through_a_singular_configuration_is_seen_whatever_the_step(h: float) -> None:
    """The slider meets the pivot whenever the crank stands upright; found by its angle alone."""
    mechanism = compiled_mechanism(load_scene("slider_crank_equal"))
    run = simulated(mechanism, lookup("RK4"), h=h, duration=8.0, alpha_hat=20 * h, beta_hat=100 * h**2)
    expected = run.t[np.flatnonzero(np.diff(np.floor(run.q[:, 0] / np.pi - 1 / 2)))] + h / 2
    assert len(expected) == 3
    assert run.singular_times == pytest.approx(expected, abs=h)


def test_where_nothing_is_singular_no_passage_is_seen() -> None:
    mechanism = compiled_mechanism(load_scene("four_bar"))
    run = simulated(mechanism, lookup("RK4"), h=1e-2, duration=10.0, alpha_hat=0.2, beta_hat=0.01)
    assert not run.singular_times.size


@pytest.mark.parametrize(
    ("joint", "c"),
    [
        # the distance (m) to the line through (0.3, -0.4) along (3, 4) / 5
        ({"type": "point-on-line", "direction": [3, 4]}, 0.6 * 2.6 - 0.8 * 2.4),
        ({"type": "distance", "length": 2.0}, (2.4**2 + 2.6**2 - 2**2) / 4),
    ],
)
def test_a_joint_holds_two_points_neither_of_which_lies_at_a_frames_origin(joint: dict[str, Any], c: float) -> None:
    """The second is at (2.5, 1.5) + (0.2, 0.7)."""
    joint |= {"bodies": ["ground", "bob"], "points": [[0.3, -0.4], [0.2, 0.7]]}
    mechanism = compiled_mechanism(parse_scene({**pendulum(), "joint": [joint]}))
    assert constraint_errors(mechanism, 0.0, np.array([2.5, 1.5])) == pytest.approx(c, rel=1e-14)
