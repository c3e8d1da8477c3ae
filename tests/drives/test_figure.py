"""Maps of drives: their edges part what is proven stable from what is not."""

from fractions import Fraction

import numpy as np
import pytest
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

from bezstab.drives.answer import judge_drive
from bezstab.drives.figure import drive_figure
from bezstab.drives.held_torque import verdict
from bezstab.engines.drives import Drive, Timing
from bezstab.methods.registry import lookup

SYM = lookup("SYM")
H = Fraction("0.002")
DRIVE = Drive(Fraction(200), Fraction(5), Fraction("0.1"))


def drawn(timing: Timing, drive: Drive = DRIVE) -> Figure:
    return drive_figure(judge_drive(drive, H, SYM, timing), 40)


def test_the_edge_parts_what_is_proven_stable_from_what_is_not() -> None:
    timing = Timing(4, Fraction(1))
    figure = drawn(timing)
    axes = figure.axes[0]
    assert axes.get_title().startswith(
        "Drive, explicit, 0.1 kg m², h = 0.002 s\nThe torque is computed every 4 steps (8 ms)"
    )
    (edge,) = [each for each in axes.collections if isinstance(each, ContourSet)]
    points = np.concatenate([path.vertices for path in edge.get_paths()])
    assert len(points) > 40
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    cell = np.array([(right - left) / 40, (top - bottom) / 40])
    for kd, kp in points[::10]:
        nearby = [
            verdict(Drive(Fraction(kp + up), Fraction(kd + across), DRIVE.inertia), H, SYM, timing)
            for across in (-cell[0], 0, cell[0])
            for up in (-cell[1], 0, cell[1])
            if kd + across > 0 and kp + up > 0
        ]
        assert {"converges", "diverges"} <= set(nearby), (kd, kp)
    for text in axes.texts:
        kd, kp = map(Fraction, axes.transLimits.inverted().transform(text.get_position()))
        found = verdict(Drive(kp, kd, DRIVE.inertia), H, SYM, timing)
        assert text.get_text() == {"converges": "stable"}.get(found, found)
    assert len(axes.texts) == 2
    (own,) = (line for line in axes.get_lines() if line.get_marker() == "*")
    assert (np.array(own.get_xydata()).tolist(), own.get_label()) == ([[5, 200]], "kp = 200, kd = 5")


def test_the_law_is_drawn_where_there_is_one_and_gains_beyond_it_are_on_the_map() -> None:
    """Held for 4 steps: A > B 3 / 8, which is kp < 1000 / 3 kd, and 8 a + 4 b < 4."""
    axes = drawn(Timing(4), Drive(Fraction(20000), Fraction(90), Fraction("0.1"))).axes[0]
    lines = {line.get_label(): line for line in axes.get_lines()}
    kd, kp = (np.asarray(each) for each in lines["closed form"].get_data())
    assert kp == pytest.approx(np.minimum(kd * 1000 / 3, (1 - 2 * 0.02 * kd) / 4e-5))
    assert axes.get_xlim()[1] > 90
    assert axes.get_ylim()[1] > 20000
