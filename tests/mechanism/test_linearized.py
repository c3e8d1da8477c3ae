"""Changes of steps against differences."""

import numpy as np
import pytest

from bezstab.mechanism import (
    changes_handed_on,
    compiled_mechanism,
    load_scene,
    memory,
    motion,
    steps_taken,
)
from bezstab.methods import lookup

SCHEMES = ("B4", "RK4", "SYM", "ABM3", "verlet-half", "trapezoid", "bdf3", "hht", "radau5")


@pytest.mark.parametrize(
    ("name", "scene", "duration"), [*((name, "driven_four_bar", 1.0) for name in SCHEMES), ("RK4", "andrews", 0.03)]
)
def test_a_step_changes_as_the_difference_of_two_steps(name: str, scene: str, duration: float) -> None:
    """Beside the motion, by 1e-5 up and down: quadratic terms cancel, cubic ones are about 1e-10."""
    mechanism, method, h = compiled_mechanism(load_scene(scene)), lookup(name), 0.01 * duration
    shares = np.array(memory(method.scheme.second_order).shares, float)
    times = duration * np.array([0.05, 0.07, 0.1])
    state_in_steps = np.stack([h**power * each for power, each in enumerate(motion(mechanism, duration).at(times))])
    start = np.einsum("ks,sti->tki", shares, state_in_steps)
    direction = np.random.default_rng(0).standard_normal(start.shape)
    gains = np.tile([[2 * 15.0], [1e3]], times.size)
    up, here, down = (
        steps_taken(mechanism, method, h, times[1], gains, start + by * direction) for by in (1e-5, 0, -1e-5)
    )
    changes = changes_handed_on(method, here.jacobians, direction[..., np.newaxis])[..., 0]
    assert changes == pytest.approx((up.handed_on - down.handed_on) / 2e-5, abs=1e-7)
