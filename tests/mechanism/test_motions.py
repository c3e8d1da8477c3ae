"""The motion as a function of time: between its steps, and closed where drivers begin anew."""

from dataclasses import replace

import numpy as np
import pytest

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.motions import STEPS, motion, regular_motion
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.scenes import Body
from tests.runs.driven_four_bar import swinging_four_bar

MECHANISM = compiled_mechanism(load_scene("driven_four_bar"))


@pytest.mark.parametrize(
    ("ratio", "period"),
    [(0, 1.0), (3 / 2, 2.0), (np.sqrt(2), None), (1 / 997, None)],  # two turns, three swings
)
@pytest.mark.slow
def test_drivers_that_turn_and_swing_begin_anew_after_their_common_period_if_there_is_one(
    ratio: float, period: float | None
) -> None:
    """Else there is a run, which did not look for a revolution of many turns."""
    along = motion(swinging_four_bar(2 * np.pi, 2 * np.pi * ratio), 0.05)
    assert along.closed is bool(period)
    assert along.duration == pytest.approx(period or 0.05, rel=1e-12)
    if period:
        assert along.q[-1][0] - along.q[0][0] == pytest.approx(2 * np.pi * period, abs=1e-6)
    else:
        assert len(along.t) == STEPS + 1


def test_a_motion_that_misses_its_start_is_refused_with_the_coordinate() -> None:
    scene = load_scene("driven_four_bar")
    free = Body(name="free", mass=1.0, inertia=1.0, center=(0.0, 0.0), free=("x",), locked={})
    drifting = replace(scene, bodies=(*scene.bodies, free), velocity={"free.x": 0.3}, position={"free.x": 0.0})
    with pytest.raises(InputError, match=r"free\.x is off by 0\.3 after one revolution"):
        motion(compiled_mechanism(drifting), 1.0)


def test_a_motion_through_a_singular_configuration_is_refused() -> None:
    with pytest.raises(NumericalError, match=r"goes through a singular configuration at t = 0\.7718 s"):
        regular_motion(compiled_mechanism(load_scene("slider_crank_equal")), 1.0)
