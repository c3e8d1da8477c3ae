"""A run and what its constraints did, as one value."""

import numpy as np
import pytest

from bezstab.mechanism import compiled_mechanism, load_scene, observe, perturbed_state, simulate, simulated
from bezstab.methods import lookup

PENDULUM = compiled_mechanism(load_scene("pendulum"))
H, ALPHA_HAT, BETA_HAT = 1e-3, 1.0, 0.25
TWO_ALPHA, BETA_SQUARED = ALPHA_HAT / H, BETA_HAT / H**2


def test_it_is_the_run_from_the_perturbed_start_and_its_observation() -> None:
    both = simulated(
        PENDULUM, lookup("B4"), h=H, duration=0.1, alpha_hat=ALPHA_HAT, beta_hat=BETA_HAT, perturb=1e-4, start="euler"
    )
    state = perturbed_state(PENDULUM, 1e-4)
    run = simulate(PENDULUM, lookup("B4"), H, 0.1, (TWO_ALPHA, BETA_SQUARED), state, "euler")
    seen = observe(PENDULUM, run.t, run.q, run.v, TWO_ALPHA, BETA_SQUARED)
    for one, other in ((both.t, run.t), (both.q, run.q), (both.v, run.v), (both.c, seen.c), (both.energy, seen.energy)):
        assert np.array_equal(one, other)
    assert np.array_equal(both.cdot, seen.cdot)
    assert np.array_equal(both.multipliers, seen.multipliers)
    assert both.c[0, 0] == pytest.approx(1e-4, rel=1e-3)  # to first order in the perturbation


def test_all_that_is_told_of_a_run_that_breaks_down_ends_with_it() -> None:
    mechanism = compiled_mechanism(load_scene("driven_four_bar"))
    run = simulated(mechanism, lookup("B4"), h=H, duration=5.0, alpha_hat=1.7, beta_hat=0.8, perturb=1e-4)
    assert run.failure
    assert "failed" in repr(run)
    assert len(run.t) == len(run.c) == len(run.driver_work) < 5001
