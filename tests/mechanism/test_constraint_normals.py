"""How the normals of the constraints turn: by hand where that can be done, and over closed motions."""

import numpy as np
import pytest

from bezstab.mechanism import compiled_mechanism, load_scene, turning_normals

OMEGA = 2 * np.pi  # rad/s, of both driven scenes


@pytest.mark.parametrize("name", ["driven_four_bar", "driven_slider_crank"])
def test_the_trace_of_k_has_no_mean_over_a_closed_motion(name: str) -> None:
    turning = turning_normals(compiled_mechanism(load_scene(name)), 1.0)
    traces = np.trace(turning.rates[:-1], axis1=1, axis2=2)
    assert turning.closed
    # equal weights are exact for a periodic function of so few harmonics; the rest is the motion's 1e-11
    assert abs(traces.mean()) < 1e-7 * np.abs(traces).max()


def test_a_mass_on_a_circle_does_not_turn_its_only_constraint_against_itself() -> None:
    turning = turning_normals(compiled_mechanism(load_scene("pendulum")), 1.0)
    # c = (x^2 + y^2 - l^2) / 2 l: C_q v is zero along the motion, and K = v . r / r^2 with it
    assert turning.kappa < 1e-9


def test_theory_gives_the_largest_rates() -> None:
    four_bar = turning_normals(compiled_mechanism(load_scene("driven_four_bar")), 1.0)
    assert four_bar.kappa / OMEGA == pytest.approx(0.5, abs=0.05)
    andrews = turning_normals(compiled_mechanism(load_scene("andrews")), 0.03)
    assert andrews.kappa == pytest.approx(281, rel=0.01)  # 1/s, as its benchmark page says
