"""Rate and amplitude of the motion that constraints see, where they are known; a mechanism at rest has none."""

import pytest

from bezstab.errors import InputError
from bezstab.mechanism import compiled_mechanism, constraint_motion, load_scene, parse_scene


def test_a_driven_crank_moves_its_constraints_about_as_fast_as_it_turns() -> None:
    """The crank of the four-bar is 0.1 m long and turns at 2 pi 1/s; the rocker adds what is faster."""
    found = constraint_motion(compiled_mechanism(load_scene("driven_four_bar")), 1.0)
    assert 1 < found.omega / 6.283185307179586 < 1.5
    assert 0.05 < found.amplitude < 0.1


def test_a_mechanism_at_rest_has_no_rate() -> None:
    hanging = parse_scene({
        "name": "plumb",
        "gravity": [0.0, -9.81],
        "body": [{"name": "bob", "mass": 1.0, "free": ["x", "y"]}],
        "joint": [{"type": "distance", "bodies": ["ground", "bob"], "points": [[0.0, 0.0], [0.0, 0.0]], "length": 1.0}],
        "initial": {"position": {"bob.x": 0.0, "bob.y": -1.0}, "velocity": {"bob.x": 0.0, "bob.y": 0.0}},
    })  # fmt: skip
    with pytest.raises(InputError, match="plumb is at rest"):
        constraint_motion(compiled_mechanism(hanging), 1.0)
