"""The motion as a function of time: between its steps, and closed where drivers begin anew."""

from dataclasses import replace

import numpy as np
import pytest

from bezstab.errors import InputError, NumericalError
from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.motions import STEPS, motion, regular_motion
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.scenes import Body
from tests.mechanism.four_bar_chains import four_bars
from tests.runs.driven_four_bar import swinging_four_bar

MECHANISM = compiled_mechanism(load_scene("driven_four_bar"))


@pytest.mark.parametrize(
    ("ratio", "period"),
    [(0, 1.0), (3 / 2, 2.0), (1, 1.0), *((each, None) for each in (np.sqrt(2), 1 / 997))],  # two turns, three swings
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


def test_between_steps_velocity_and_acceleration_are_the_positions_derivatives() -> None:
    along, t = motion(MECHANISM, 1.0), np.array([0.1001, 0.33337, 0.71234])
    step = 1e-4  # central differences: truncation (omega step)^2 = 4e-7 of v, rounding 1e-12 of q / step = 1e-8
    before, here, after = (along.at(t + each) for each in (-step, 0, step))
    for k in range(2):
        assert np.allclose((after[k] - before[k]) / (2 * step), here[k + 1], rtol=1e-5, atol=1e-5 * 10**k)


def test_a_motion_that_misses_its_start_is_refused_with_the_coordinate() -> None:
    scene = load_scene("driven_four_bar")
    free = Body(name="free", mass=1.0, inertia=1.0, center=(0.0, 0.0), free=("x",), locked={})
    drifting = replace(scene, bodies=(*scene.bodies, free), velocity={"free.x": 0.3}, position={"free.x": 0.0})
    with pytest.raises(InputError, match=r"free\.x is off by 0\.3 after one revolution"):
        motion(compiled_mechanism(drifting), 1.0)


@pytest.mark.parametrize("offset", [np.pi / 2, 1.5])
def test_a_motion_through_a_singular_configuration_is_refused(offset: float) -> None:
    """A parallelogram's rods lie along the ground twice a turn: a step meets that, or two steps lie around it."""
    driver = {"type": "driver", "coordinate": "rod0.theta", "offset": offset, "rate": 2 * np.pi}
    scene = four_bars(1, {}, [driver])
    with pytest.raises(NumericalError, match="singular configuration"):
        regular_motion(compiled_mechanism(scene), 1.0)
