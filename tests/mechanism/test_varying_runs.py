from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from bezstab.compiling import COMPILED_CHOICE
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.scenes import at_speed
from bezstab.mechanism.simulation import simulated
from bezstab.methods.registry import lookup
from bezstab.methods.step_matrices import step_matrix
from tests.mechanism.test_stepping import assert_alike

AT_REST = compiled_mechanism(at_speed(load_scene("driven_slider_crank"), 1e-9))
ONE_STEP = (
    *("SYM", "RK4@2", "ruth3", "rkn4", "verlet-half", "verlet-predicted", "verlet-old", "verlet-implicit"),
    *("average-acceleration@2", "hht", "imex-euler", "stable-pd", "trapezoid", "sdirk2", "gauss4"),
)


@pytest.mark.parametrize("name", ONE_STEP)
@pytest.mark.parametrize("hold", [False, True])
def test_errors_follow_the_product_of_the_step_matrices(name: str, hold: bool) -> None:
    """Of a mechanism all but at rest: its first constraint's error before and after rounds, by exact matrices."""
    alpha_hat, beta_hat, h = Fraction(1, 5), Fraction(9, 10), 0.01
    lengths = Fraction(1), Fraction(5, 8), Fraction(3, 10)
    method = lookup(name)
    run = simulated(
        AT_REST,
        method,
        sequence=[float(length) * h for length in lengths],
        h=h,
        duration=float(sum(lengths) * method.step_multiple) * h * 6,
        alpha_hat=float(alpha_hat),
        beta_hat=float(beta_hat),
        hold=hold,
        perturb=1e-7,
    )
    errors = run.c[:: len(lengths), 0]
    assert len(errors) == 7
    one_step = step_matrix(method, alpha_hat, beta_hat, hold)
    product = np.eye(one_step.size)
    for length in lengths:
        product = np.array(one_step.at(length), dtype=np.float64) @ product
    # Cayley and Hamilton: a matrix is a root of its own characteristic polynomial, so errors satisfy that recursion
    left_over = np.convolve(errors, np.poly(product), mode="valid")
    # rounding of coordinates near 1 m is 1e-16 m, of the first error 1e-9, and adds up over 18 steps
    assert abs(left_over).max() < 1e-7 * abs(errors).max()


@pytest.mark.slow
def test_compiled_runs_are_those_of_python(monkeypatch: pytest.MonkeyPatch) -> None:
    pendulum, method, sequence = compiled_mechanism(load_scene("pendulum")), lookup("verlet-half"), [1e-3, 2.5e-3, 2e-3]
    point: dict[str, Any] = {"sequence": sequence, "h": 1e-3, "duration": 1.0, "alpha_hat": 0.3, "beta_hat": 0.04}
    for hold in (False, True):
        runs = []
        for choice in ("no", "yes"):
            monkeypatch.setenv(COMPILED_CHOICE, choice)
            runs.append(simulated(pendulum, method, perturb=1e-6, hold=hold, **point))
        assert_alike(runs[0], runs[1])
