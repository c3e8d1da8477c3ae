import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mechanism import (
    Simulation,
    check_steps_may_vary,
    compiled_mechanism,
    load_scene,
    simulated,
    simulated_with_steps,
)
from bezstab.methods import lookup

MECHANISM = compiled_mechanism(load_scene("slider_crank"))
H = 1 / 60
ALPHA_HAT, BETA_HAT = 4 * H, (100 * H) ** 2  # alpha = 2, beta = 100 for a step of H


def run_with(sequence: list[float], duration: float, method: str = "SYM", hold: bool = False) -> Simulation:
    """Return the run that starts a thousandth of a millimetre off."""
    return simulated_with_steps(
        MECHANISM,
        lookup(method),
        sequence=sequence,
        h=H,
        duration=duration,
        alpha_hat=ALPHA_HAT,
        beta_hat=BETA_HAT,
        hold=hold,
        perturb=1e-6,
    )


def constant_run(h: float, duration: float, method: str = "SYM") -> Simulation:
    """Return the same at constant steps."""
    return simulated(
        MECHANISM, lookup(method), h=h, duration=duration, alpha_hat=ALPHA_HAT, beta_hat=BETA_HAT, perturb=1e-6
    )


@pytest.mark.parametrize("name", ["SYM", "RK4", "RK4@2"])
@pytest.mark.parametrize("hold", [False, True])
def test_equal_steps_are_the_run_of_constant_steps(name: str, hold: bool) -> None:
    constant = constant_run(H, 0.4, name)
    run = run_with([H], 0.4, name, hold)
    assert run.t == pytest.approx(constant.t, abs=1e-12)  # sums of steps, against multiples
    assert run.q == pytest.approx(constant.q, abs=1e-9)
    assert run.multipliers == pytest.approx(constant.multipliers, rel=1e-6)
    assert run.trajectory.evaluations == constant.trajectory.evaluations


def test_steps_that_are_each_stable_grow_in_turn() -> None:
    # theory: 1e-6 grows to about 30 in 60 steps, until the linear range is left
    steps = [H, 9.17e-3]
    assert abs(run_with(steps, 0.5).c).max() > 1e-2
    assert all(abs(run_with([step], 0.5).c).max() < 1e-4 for step in steps)


def test_the_times_are_sums_of_the_steps() -> None:
    assert run_with([0.01, 0.02], 0.045, "RK4").t == pytest.approx([0, 0.01, 0.03, 0.04, 0.06])


def test_held_parameters_follow_the_step() -> None:
    # a step of 2H with the parameters held is a constant step of 2H at the same alpha_hat, beta_hat
    constant = constant_run(2 * H, 2 * H)
    assert np.array_equal(run_with([2 * H], 2 * H, hold=True).q, constant.q)
    assert not np.array_equal(run_with([2 * H], 2 * H).q, constant.q)


def test_a_run_that_breaks_down_says_when() -> None:
    run = run_with([0.05], 5)
    assert run.failure
    assert run.failure.startswith("at t = ")
    assert run.t[-1] < 5


@pytest.mark.parametrize(
    ("name", "reason"), [("B4", "its coefficients assume"), ("gauss4", "explicit"), ("verlet-old", "explicit")]
)
def test_methods_that_cannot_change_their_step_are_refused(name: str, reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        check_steps_may_vary(lookup(name))
