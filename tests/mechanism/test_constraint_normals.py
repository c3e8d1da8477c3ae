"""What constraints see of a motion: its rate, and how their normals turn; by hand, and over closed motions."""

import numpy as np
import pytest

from bezstab.errors import InputError
from bezstab.mechanism.constraint_normals import constraint_motion, turning_normals
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene, parse_scene
from tests.mechanism.test_scenes import pendulum

OMEGA = 2 * np.pi  # rad/s, of both driven scenes


def test_a_mass_on_a_circle_does_not_turn_its_only_constraint_against_itself() -> None:
    turning = turning_normals(compiled_mechanism(load_scene("pendulum")), 1.0)
    # c = (x^2 + y^2 - l^2) / 2 l: C_q v is zero along the motion, and K = v . r / r^2 with it
    assert turning.kappa < 1e-9


@pytest.mark.slow
def test_theory_gives_the_largest_rates() -> None:
    four_bar = turning_normals(compiled_mechanism(load_scene("driven_four_bar")), 1.0)
    assert four_bar.kappa / OMEGA == pytest.approx(0.5, abs=0.05)
    andrews = turning_normals(compiled_mechanism(load_scene("andrews")), 0.03)
    assert andrews.kappa == pytest.approx(281, rel=0.01)  # 1/s, as its benchmark page says


def test_a_driven_crank_moves_its_constraints_about_as_fast_as_it_turns() -> None:
    """The crank of the four-bar is 0.1 m long; the rocker adds what is faster.

    Of a mechanism at rest tests/cli/mistakes.txt says what is said.
    """
    found = constraint_motion(compiled_mechanism(load_scene("driven_four_bar")), 1.0)
    assert 1 < found.omega / OMEGA < 1.5
    assert 0.05 < found.amplitude < 0.1


def test_a_body_that_spins_evenly_about_a_pin_shows_no_rate() -> None:
    initial = {"position": {"bob.x": 1.0, "bob.y": 0.0}, "velocity": {"bob.y": 3.0}}
    spinning = parse_scene(pendulum(gravity=[0, 0], initial=initial))
    with pytest.raises(InputError, match="turns evenly"):
        constraint_motion(compiled_mechanism(spinning), 1.0)
