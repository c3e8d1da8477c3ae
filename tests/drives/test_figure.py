"""Maps of drives, as they are drawn; that each point of a map is proven: test_held_torque.py."""

from fractions import Fraction

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet

from bezstab.drives.answer import judge_drive
from bezstab.drives.figure import drive_figure
from bezstab.drives.held_torque import verdict
from bezstab.engines.drives import Drive, Timing
from bezstab.methods.registry import lookup

H, INERTIA = Fraction("0.002"), Fraction("0.1")


def drawn(kd: int, kp: int, timing: Timing) -> Axes:
    drive = Drive(Fraction(kp), Fraction(kd), INERTIA)
    return drive_figure(judge_drive(drive, H, lookup("SYM"), timing), 40).axes[0]


def test_the_edge_is_that_of_stability_a_word_stands_where_it_is_true_and_a_star_at_the_gains_that_were_typed() -> None:
    timing = Timing(4, Fraction(1))
    axes = drawn(5, 200, timing)
    (edge,) = (each for each in axes.collections if isinstance(each, ContourSet))
    assert list(edge.levels) == [1]
    for text in axes.texts:
        kd, kp = axes.transLimits.inverted().transform(text.get_position())
        found = verdict(Drive(Fraction(kp), Fraction(kd), INERTIA), H, lookup("SYM"), timing)
        assert text.get_text() == {"converges": "stable"}.get(found, found)
    assert len(axes.texts) == 2
    (own,) = (line for line in axes.get_lines() if line.get_marker() == "*")
    assert np.array(own.get_xydata()).tolist() == [[5, 200]]


def test_the_law_is_drawn_where_there_is_one_and_gains_beyond_it_are_on_the_map() -> None:
    """Held for 4 steps: A > B 3 / 8, which is kp < 1000 / 3 kd, and 8 a + 4 b < 4."""
    axes = drawn(90, 20000, Timing(4))
    (line,) = (line for line in axes.get_lines() if line.get_label() == "closed form")
    kd, kp = np.transpose(line.get_xydata())
    assert kp == pytest.approx(np.minimum(kd * 1000 / 3, (1 - 2 * 0.02 * kd) / 4e-5))
    assert axes.get_xlim()[1] > 90
    assert axes.get_ylim()[1] > 20000
