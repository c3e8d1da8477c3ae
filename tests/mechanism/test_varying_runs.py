import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mechanism import check_steps_may_vary, compiled_mechanism, load_scene, simulated, simulated_with_steps
from bezstab.methods import lookup

MECHANISM = compiled_mechanism(load_scene("slider_crank"))
H = 1 / 60
POINT = {"h": H, "alpha_hat": 4 * H, "beta_hat": (100 * H) ** 2}  # alpha = 2, beta = 100


@pytest.mark.parametrize("name", ["SYM", "RK4", "RK4@2"])
def test_equal_steps_are_the_run_of_constant_steps(name: str) -> None:
    method = lookup(name)
    constant = simulated(MECHANISM, method, duration=0.4, perturb=1e-6, **POINT)
    varying = simulated_with_steps(MECHANISM, method, sequence=[H], duration=0.4, perturb=1e-6, **POINT)
    held = simulated_with_steps(MECHANISM, method, sequence=[H], duration=0.4, perturb=1e-6, hold=True, **POINT)
    for run in (varying, held):
        assert run.t == pytest.approx(constant.t, abs=1e-12)  # sums of steps, against multiples
        assert run.q == pytest.approx(constant.q, abs=1e-9)
        assert run.multipliers == pytest.approx(constant.multipliers, rel=1e-6)
        assert run.trajectory.evaluations == constant.trajectory.evaluations


def test_steps_that_are_each_stable_grow_in_turn() -> None:
    # theory: 1e-6 grows to about 30 in 60 steps, until the linear range is left
    alternating = simulated_with_steps(
        MECHANISM, lookup("SYM"), sequence=[H, 9.17e-3], duration=0.5, perturb=1e-6, **POINT
    )
    alone = [
        simulated_with_steps(MECHANISM, lookup("SYM"), sequence=[step], duration=0.5, perturb=1e-6, **POINT)
        for step in (H, 9.17e-3)
    ]
    assert abs(alternating.c).max() > 1e-2
    assert all(abs(run.c).max() < 1e-4 for run in alone)


def test_the_times_are_sums_of_the_steps() -> None:
    run = simulated_with_steps(MECHANISM, lookup("RK4"), sequence=[0.01, 0.02], duration=0.045, **POINT)
    assert run.t == pytest.approx([0, 0.01, 0.03, 0.04, 0.06])


def test_held_parameters_follow_the_step() -> None:
    # one step of 2h with the parameters held is one step of constant 2h at the same alpha_hat, beta_hat
    point = {**POINT, "h": 2 * H}
    constant = simulated(MECHANISM, lookup("SYM"), duration=2 * H, perturb=1e-6, **point)
    held = simulated_with_steps(
        MECHANISM, lookup("SYM"), sequence=[2 * H], duration=2 * H, perturb=1e-6, hold=True, **POINT
    )
    fixed = simulated_with_steps(MECHANISM, lookup("SYM"), sequence=[2 * H], duration=2 * H, perturb=1e-6, **POINT)
    assert np.array_equal(held.q, constant.q)
    assert not np.array_equal(fixed.q, constant.q)


def test_a_run_that_breaks_down_says_when() -> None:
    run = simulated_with_steps(MECHANISM, lookup("SYM"), sequence=[0.05], duration=5, perturb=1e-3, **POINT)
    assert run.failure
    assert run.failure.startswith("at t = ")
    assert run.t[-1] < 5


@pytest.mark.parametrize(
    ("name", "reason"), [("B4", "its coefficients assume"), ("gauss4", "explicit"), ("verlet-old", "explicit")]
)
def test_methods_that_cannot_change_their_step_are_refused(name: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        check_steps_may_vary(lookup(name))
