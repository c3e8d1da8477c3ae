"""The constraint error that a method forces on a moving mechanism: predicted in metres, none fitted, and measured."""

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.motions import motion
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import simulated
from bezstab.methods.registry import lookup
from bezstab.runs.forced_runs import predicted_errors, settled_error
from bezstab.stability.choices import choose

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


@pytest.mark.parametrize(
    ("name", "scene"),
    [
        *((name, "driven_four_bar") for name in ("RK4", "B4", "hht", "heun")),
        *(("AB4", "andrews"), ("SYM", "slider_crank_light"), ("gauss4", "slider_crank_light")),
    ],
)
@pytest.mark.slow
def test_measured_over_predicted_is_one_whatever_the_gains(name: str, scene: str) -> None:
    """Of constraints; of a driven mechanism of the trajectory, too, which is off as its constraints say."""
    h, duration, allowed = SCENES[scene]
    mechanism, method = compiled_mechanism(load_scene(scene)), lookup(name)
    shares = SHARES if scene != "andrews" else (0.2, 0.5, 1.0)  # whose implicit steps take long
    robust = choose(method, "robust")
    points = [(share * robust.alpha_hat, share**2 * robust.beta_hat) for share in shares]
    predicted = predicted_errors(mechanism, method, h, points, duration)
    for share, point, forced in zip(shares, points, predicted, strict=True):
        run = simulated(mechanism, method, h=h, duration=duration, alpha_hat=point[0], beta_hat=point[1])
        assert run.failure is None
        assert settled_error(run, run.t) / forced.error == pytest.approx(1, abs=allowed)
        if forced.trajectory and share >= 0.5:
            later = run.t >= duration / 2
            off = np.abs(run.q - motion(mechanism, duration).at(run.t)[0])[later].max()
            assert off == pytest.approx(forced.trajectory, rel=0.03)
