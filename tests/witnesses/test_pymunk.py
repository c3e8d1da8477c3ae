"""pymunk (Chipmunk): a joint with error_bias e leaves e^h of an error each step: SYM at (1, 1 - e^h).

Source: Chipmunk's bias_coef(errorBias, dt) = 1 - errorBias^dt, and bias = -bias_coef error / dt in its joints.
"""

from typing import Any

import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.stability import spectral_radius

pymunk: Any = pytest.importorskip("pymunk")

H = 1 / 60
ERROR = 1e-3
STEPS = 12


def ratios(joint: str, error_bias: float) -> Any:
    """Return from step to step what is left of the error of a body's only joint, from the second on.

    The first step finds the body at rest and moves it with the velocity of one step later.
    """
    space = pymunk.Space()
    body = pymunk.Body(2, 3)
    body.position = (ERROR, 0)
    if joint == "pivot":
        held = pymunk.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    else:
        held = pymunk.PinJoint(space.static_body, body, (-1, 0), (0, 0))
        held.distance = 1
    held.error_bias = error_bias
    space.add(body, held)
    errors = []
    for _ in range(STEPS):
        space.step(H)
        errors.append(body.position.x)
    return np.array(errors[1:]) / np.array(errors[:-1])


@pytest.mark.parametrize("joint", ["pivot", "pin"])
@pytest.mark.parametrize("error_bias", [0.9, 1.1, 0.9**60, 0.1, 1e-20, 1.1**60])
def test_chipmunks_pole_is_that_of_its_error_bias(joint: str, error_bias: float) -> None:
    """Its limit is 1: at 0.9 and 1.1 of it the error falls and grows, as at stronger and weaker ones; to 1e-6."""
    left = error_bias**H
    assert float(spectral_radius(lookup("SYM"), 1, 1 - left)) == pytest.approx(left)
    assert ratios(joint, error_bias) == pytest.approx(left, abs=1e-6)
    assert (left < 1) is (error_bias < 1)


def test_the_default_leaves_nine_tenths_each_step() -> None:
    space = pymunk.Space()
    joint = pymunk.PivotJoint(space.static_body, pymunk.Body(1, 1), (0, 0), (0, 0))
    assert joint.error_bias**H == pytest.approx(0.9)
