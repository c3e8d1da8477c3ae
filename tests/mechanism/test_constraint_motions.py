"""Rate and amplitude of the motion that constraints see; of one at rest tests/cli/mistakes.txt says what is said."""

import math

from bezstab.mechanism import compiled_mechanism, constraint_motion, load_scene


def test_a_driven_crank_moves_its_constraints_about_as_fast_as_it_turns() -> None:
    """The crank of the four-bar is 0.1 m long and turns at 2 pi 1/s; the rocker adds what is faster."""
    found = constraint_motion(compiled_mechanism(load_scene("driven_four_bar")), 1.0)
    assert 1 < found.omega / (2 * math.pi) < 1.5
    assert 0.05 < found.amplitude < 0.1
