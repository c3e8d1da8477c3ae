"""Jacobians of the acceleration and changes of steps against differences."""

from typing import Any

import mpmath as mp
import numpy as np
import pytest

from bezstab.mechanism import (
    Mechanism,
    changes_handed_on,
    compiled_mechanism,
    load_scene,
    memory,
    motion,
    state_function,
    steps_taken,
)
from bezstab.mechanism.linearized import acceleration_jacobians
from bezstab.methods import lookup
from bezstab.stability import FloatArray


def exact_slopes(mechanism: Mechanism, gains: tuple[float, float], state: FloatArray) -> FloatArray:
    """Return the derivatives of qddot by q and v, shape (n, 2n), from differences over 1e-25 in fifty digits."""
    acceleration, columns = state_function(mechanism, "accelerations", mp), []
    with mp.workdps(50):
        small, exact = mp.mpf("1e-25"), [mp.mpf(number) for number in state.tolist()]

        def at(moved: list[Any]) -> list[Any]:
            return list(acceleration([mp.mpf(0.3), *gains, *moved])[: mechanism.size])

        here = at(exact)
        for k in range(len(exact)):
            there = at([number + small * (i == k) for i, number in enumerate(exact)])
            columns.append([float((b - a) / small) for a, b in zip(here, there, strict=True)])
    return np.transpose(columns)


@pytest.mark.parametrize("name", ["slider_crank", "driven_slider_crank", "driven_four_bar", "andrews"])
@pytest.mark.slow_except("slider_crank", "driven_four_bar")
def test_the_jacobians_are_the_slopes_to_rounding(name: str) -> None:
    """Off the constraints, too; solving for lambda loses two digits."""
    mechanism = compiled_mechanism(load_scene(name))
    q, v, _ = motion(mechanism, 0.03).at(np.linspace(0, 0.03, 3))
    random, gains = np.random.default_rng(0), (300.0, 2e4)
    q, v = q + random.normal(0, 1e-3, q.shape), v + random.normal(0, 1e-3, v.shape)
    found = acceleration_jacobians(mechanism, 0.3, *gains, q, v)
    for place in range(3):
        expected = exact_slopes(mechanism, gains, np.concatenate([q[place], v[place]]))
        assert np.abs(found[place] - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "ABM3", "verlet-half", "trapezoid", "bdf3", "hht", "radau5"])
def test_a_step_changes_as_the_difference_of_two_steps(name: str) -> None:
    """Beside the motion, by 1e-5 up and down: quadratic terms cancel, cubic ones are about 1e-10."""
    four_bar, method, h = compiled_mechanism(load_scene("driven_four_bar")), lookup(name), 0.01
    shares = np.array(memory(method.scheme.second_order).shares, float)
    t, times = 0.07, np.array([0.05, 0.07, 0.1])
    state_in_steps = np.stack([h**power * each for power, each in enumerate(motion(four_bar, 1.0).at(times))])
    start = np.einsum("ks,sti->tki", shares, state_in_steps)
    direction = np.random.default_rng(0).standard_normal(start.shape)
    gains = np.tile([[2 * 15.0], [1e3]], times.size)
    up, here, down = (steps_taken(four_bar, method, h, t, gains, start + by * direction) for by in (1e-5, 0, -1e-5))
    changes = changes_handed_on(method, here.jacobians, direction[..., np.newaxis])[..., 0]
    assert changes == pytest.approx((up.handed_on - down.handed_on) / 2e-5, abs=1e-7)
