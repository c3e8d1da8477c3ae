import mpmath as mp
import numpy as np
import pytest

from tests.reference.one_coordinate_motion import DIGITS, motion, slider_crank_energies


def test_the_reference_agrees_with_the_published_angles() -> None:
    passages = motion(slider_crank_energies("45"), np.pi / 4, np.pi / 3, [1, 2])
    angles = [float(passage.angle) for passage in passages.values()]
    assert angles == pytest.approx([1.822086334469, 2.872938352485], abs=5e-13)


def test_the_reference_has_the_digits_it_is_asked_for() -> None:
    energies, time = slider_crank_energies("45"), mp.mpf(1) / 25
    usual = motion(energies, np.pi / 4, 10 * np.pi, [time])[time]
    finer = motion(energies, np.pi / 4, 10 * np.pi, [time], digits=DIGITS + 15)[time]
    with mp.workdps(DIGITS):
        assert abs(usual.angle - finer.angle) < mp.mpf(10) ** (4 - DIGITS)  # Newton's last step
