"""Constraint errors of joints, by hand; springs and forces are held by the work that they do (`test_energies`)."""

from typing import Any

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.observation import observe
from bezstab.mechanism.scene_files import parse_scene
from tests.mechanism.test_scenes import pendulum


@pytest.mark.parametrize(
    ("joint", "c", "cdot"),
    [
        # the distance (m) to the line through (0.3, -0.4) along (3, 4) / 5
        ({"type": "point-on-line", "direction": [3, 4]}, 0.6 * 2.6 - 0.8 * 2.4, 0.6 * 1.5 - 0.8 * 0.5),
        ({"type": "distance", "length": 2.0}, (2.4**2 + 2.6**2 - 2**2) / 4, (2.4 * 0.5 + 2.6 * 1.5) / 2),
    ],
)
def test_a_joint_holds_two_points_neither_of_which_lies_at_a_frames_origin(
    joint: dict[str, Any], c: float, cdot: float
) -> None:
    """The second is at (2.5, 1.5) + (0.2, 0.7), and moves with (0.5, 1.5)."""
    joint |= {"bodies": ["ground", "bob"], "points": [[0.3, -0.4], [0.2, 0.7]]}
    mechanism = compiled_mechanism(parse_scene({**pendulum(), "joint": [joint]}))
    seen = observe(mechanism, np.zeros(1), np.array([[2.5, 1.5]]), np.array([[0.5, 1.5]]), 0.0, 0.0)
    assert (seen.c[0, 0], seen.cdot[0, 0]) == pytest.approx((c, cdot), rel=1e-14)
