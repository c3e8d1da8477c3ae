"""A run and what its constraints did, as one value."""

from bezstab.mechanism import compiled_mechanism, load_scene, simulated
from bezstab.methods import lookup


def test_all_that_is_told_of_a_run_that_breaks_down_ends_with_it() -> None:
    mechanism = compiled_mechanism(load_scene("driven_four_bar"))
    run = simulated(mechanism, lookup("B4"), h=1e-3, duration=5.0, alpha_hat=1.7, beta_hat=0.8, perturb=1e-4)
    assert run.failure
    assert "failed" in repr(run)
    assert len(run.t) == len(run.c) == len(run.driver_work) < 5001
