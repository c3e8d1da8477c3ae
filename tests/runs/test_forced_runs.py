"""The constraint error that a method forces on a moving mechanism: predicted in metres, none fitted, and measured."""

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import simulated
from bezstab.methods.registry import lookup
from bezstab.runs.forced_runs import predicted_errors, settled_error
from bezstab.stability.choices import choose
from tests.runs.gain_grids import METHODS
from tests.runs.samples import of_campaign

SCENES = {
    "driven_four_bar": (0.003, 1.0, 0.05),
    "slider_crank_light": (0.002, 2.0, 0.25),
    "andrews": (5e-5, 0.03, 0.25),
}
"""Step and duration (s), and by how much measured over predicted may be off one.

A driven mechanism without a freedom of its own follows its motion whatever the method; Andrews' has a spring.
Without what turning normals add gauss4 would be off by half.
"""
SHARES = (0.2, 0.3, 0.5, 0.7, 1.0)
"""Of the robust alpha and beta: what is forced changes some hundredfold over them."""

FEW = {("RK4", "driven_four_bar"), ("B4", "driven_four_bar"), ("hht", "driven_four_bar"), ("AB4", "andrews")}
FEW |= {("SYM", "slider_crank_light"), ("gauss4", "slider_crank_light")}


def robust_point(name: str, share: float = 1.0) -> tuple[float, float]:
    """Return the robust choice of a method, or that share of its alpha and beta."""
    chosen = choose(lookup(name), "robust")
    return share * chosen.alpha_hat, share**2 * chosen.beta_hat


def errors(name: str, scene: str, h: float, shares: Sequence[float], duration: float) -> Iterator[tuple[float, float]]:
    """Yield the predicted and the measured error (m, rad) at shares of the robust alpha and beta."""
    mechanism, method = compiled_mechanism(load_scene(scene)), lookup(name)
    points = [robust_point(name, share) for share in shares]
    for point, forced in zip(points, predicted_errors(mechanism, method, h, points, duration), strict=True):
        run = simulated(mechanism, method, h=h, duration=duration, alpha_hat=point[0], beta_hat=point[1])
        assert run.failure is None
        yield forced.error, settled_error(run, run.t)


@pytest.mark.parametrize(
    ("name", "scene"),
    sorted(of_campaign({*product(METHODS, SCENES)}, FEW)),
)
@pytest.mark.slow
def test_measured_over_predicted_is_one_whatever_the_gains(name: str, scene: str) -> None:
    h, duration, allowed = SCENES[scene]
    shares = SHARES if scene != "andrews" else (0.2, 0.5, 1.0)  # whose implicit steps take long
    for predicted, measured in errors(name, scene, h, shares, duration):
        assert measured / predicted == pytest.approx(1, abs=allowed)


@pytest.mark.parametrize("name", ["B4", "heun", "SYM", "SIE", "RK4", "AB4", "ABM4"])
def test_the_trajectory_of_a_driven_mechanism_is_off_as_its_constraints_say(name: str) -> None:
    h, duration, _ = SCENES["driven_four_bar"]
    mechanism, (alpha_hat, beta_hat) = compiled_mechanism(load_scene("driven_four_bar")), robust_point(name, 0.5)
    (forced,) = predicted_errors(mechanism, lookup(name), h, [(alpha_hat, beta_hat)], duration)
    run = simulated(mechanism, lookup(name), h=h, duration=duration, alpha_hat=alpha_hat, beta_hat=beta_hat)
    exactly, _, _ = motion(mechanism, duration).at(run.t)
    later = run.t >= duration / 2
    assert np.abs(run.q - exactly)[later].max() == pytest.approx(forced.trajectory, rel=0.03)
