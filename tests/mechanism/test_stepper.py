"""The stepper without a runner: steps of any function, and changes of steps against differences and exact matrices."""

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import lane_function
from bezstab.mechanism.motions import motion
from bezstab.mechanism.programs import program_of
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.second_order_memory import memory
from bezstab.mechanism.stepper import Stepper, linearized_step
from bezstab.methods.registry import lookup
from bezstab.methods.step_matrices import step_matrix
from tests.mechanism.test_varying_runs import ONE_STEP

Array = NDArray[Any]
SCHEMES = ("B4", "RK4", "SYM", "ABM3", "verlet-half", "trapezoid", "bdf3", "hht", "radau5")


@pytest.mark.parametrize(
    ("name", "scene", "duration"), [*((name, "driven_four_bar", 1.0) for name in SCHEMES), ("RK4", "andrews", 0.03)]
)
def test_a_step_changes_as_the_difference_of_two_steps(name: str, scene: str, duration: float) -> None:
    """Beside the motion, by 1e-5 up and down: quadratic terms cancel, cubic ones are about 1e-10."""
    mechanism, method, h = compiled_mechanism(load_scene(scene)), lookup(name), 0.01 * duration
    accelerations, scheme = lane_function(mechanism, "accelerations"), method.scheme.second_order
    shares = np.array(memory(scheme).shares, float)
    times = duration * np.array([0.05, 0.07, 0.1])
    state_in_steps = np.stack([h**power * each for power, each in enumerate(motion(mechanism, duration).at(times))])
    start = np.einsum("ks,sti->kit", shares, state_in_steps)
    direction = np.random.default_rng(0).standard_normal(start.shape)
    gains = np.repeat([[2 * 15.0], [1e3]], times.size, axis=1)

    def handed_on(by: float) -> Array:
        stepper = Stepper(program_of(scheme), start + by * direction, h, accelerations)
        stepper.step(times[1], h, gains)
        return stepper.carried

    at = program_of(scheme), accelerations, float(times[1]), h, gains, start
    changes = linearized_step(*at, direction[..., np.newaxis])[..., 0]
    assert changes == pytest.approx((handed_on(1e-5) - handed_on(-1e-5)) / 2e-5, abs=1e-7)


def feedback_alone(_t: float, gains: Array, q: Array, v: Array) -> tuple[Array, float]:
    """Return the accelerations of a body on a line that nothing but the feedback moves."""
    return -gains[0] * v - gains[1] * q, 1.0


@pytest.mark.parametrize("name", ONE_STEP)
def test_of_any_linear_function_the_changes_are_those_of_the_exact_step_matrix(name: str) -> None:
    """No scene is needed. Eigenvalues, since what a method carries may be written in other quantities."""
    alpha_hat, beta_hat = Fraction(1, 5), Fraction(9, 10)
    method, h = lookup(name), 0.01
    program = program_of(method.scheme.second_order)
    size, multiple = len(program.powers), float(method.step_multiple)
    gains = np.array([[float(alpha_hat) / h], [float(beta_hat) / h**2]])
    carried, unit = np.zeros((size, 1, 1)), np.eye(size).reshape(size, 1, 1, size)
    found = linearized_step(program, feedback_alone, 0.0, h * multiple, gains, carried, unit)[:, 0, 0]
    exact = np.array(step_matrix(method, alpha_hat, beta_hat, False).at(Fraction(1)), dtype=np.float64)
    expected = np.poly(exact)
    shown = np.poly(found)
    longest = max(len(shown), len(expected))  # a quantity that is carried in vain has the eigenvalue zero
    assert np.pad(shown, (0, longest - len(shown))) == pytest.approx(
        np.pad(expected, (0, longest - len(expected))), abs=1e-12
    )
