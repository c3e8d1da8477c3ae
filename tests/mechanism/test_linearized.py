"""Jacobians of the acceleration against differences of it."""

import numpy as np
import pytest

from bezstab.mechanism import acceleration_function, acceleration_jacobians, compiled_mechanism, load_scene, motion


@pytest.mark.parametrize("name", ["slider_crank", "four_bar", "driven_four_bar", "pendulum", "andrews"])
def test_the_jacobians_are_the_slopes_of_the_acceleration(name: str) -> None:
    mechanism = compiled_mechanism(load_scene(name))
    t = np.array([0.0, 0.004, 0.01])
    q, v, _ = motion(mechanism, 0.03).at(t)
    gains = 300.0, 2e4
    by_q, by_v = acceleration_jacobians(mechanism, t, *gains, q, v)
    acceleration = acceleration_function(mechanism, np)
    size = mechanism.size
    # a difference over 2e-6 of each coordinate's size leaves 1e-12 of truncation and 1e-10 of rounding
    for k in range(size):
        for jacobian, which in ((by_q, 0), (by_v, 1)):
            state = [q, v]
            reach = 1e-6 * max(1.0, float(np.abs(state[which][:, k]).max()))
            shifted = []
            for sign in (1, -1):
                moved = [q.copy(), v.copy()]
                moved[which][:, k] += sign * reach
                a = acceleration(t, *gains, moved[0].T, moved[1].T)
                shifted.append(np.stack(np.broadcast_arrays(*a), axis=-1))
            slope = (shifted[0] - shifted[1]) / (2 * reach)
            assert np.allclose(jacobian[:, :, k], slope, rtol=1e-5, atol=1e-6 * np.abs(jacobian).max())


def test_the_gains_enter_the_jacobians_linearly() -> None:
    mechanism = compiled_mechanism(load_scene("four_bar"))
    q, v, _ = motion(mechanism, 0.1).at(np.array([0.05]))
    base, alpha, beta, both = (
        np.concatenate(acceleration_jacobians(mechanism, 0.05, *gains, q, v), axis=-1)
        for gains in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (70.0, 900.0))
    )
    assert np.allclose(both, base + 70 * (alpha - base) + 900 * (beta - base), rtol=1e-12, atol=1e-9)
