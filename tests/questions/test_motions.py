from fractions import Fraction

import pytest

from bezstab.questions.motions import mechanism_of, motion_of, turn_too_far, turning_rate
from bezstab.stability.forced_errors import OMEGA_H

H = Fraction(1, 100)


def test_at_shorter_steps_a_motion_turns_less() -> None:
    by_rate = motion_of(Fraction(2), None, H, 2 * H)
    assert (by_rate.omega_h, by_rate.omega_h_max) == (Fraction(1, 50), Fraction(1, 25))
    assert motion_of(None, None, H, 2 * H).omega_h == OMEGA_H / 2
    by_angle = motion_of(None, None, H, 2 * H, omega_h=Fraction(1, 25))
    assert (by_angle.omega_h, by_angle.omega_h_max) == (Fraction(1, 50), Fraction(1, 25))


@pytest.mark.slow
def test_a_scene_turns_so_much_faster_as_it_moves_faster() -> None:
    once, twice = (mechanism_of("driven_four_bar", Fraction(speed), H) for speed in (1, 2))
    assert once
    assert twice
    assert turning_rate(twice) == pytest.approx(2 * turning_rate(once), rel=1e-6)
    assert not turn_too_far(once, 2 * H)
    (warning,) = turn_too_far(twice, 2 * H)
    assert warning.startswith("constraints of driven four-bar, 2 times as fast turn by κh = 0.13 a step: beyond 0.1 ")
