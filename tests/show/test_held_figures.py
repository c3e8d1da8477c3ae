"""Maps of drives that are held or late: what is drawn, where, and in which units."""

from fractions import Fraction
from io import BytesIO

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

from bezstab.engines import Drive
from bezstab.methods import lookup
from bezstab.questions import HeldQuestion, held_answers
from bezstab.show import held_figure, save
from bezstab.stability import Timing, held_map, held_verdict

H = Fraction("0.002")
DRIVE = Drive(Fraction(200), Fraction(5), Fraction("0.1"))


def drawn(timing: Timing, drive: Drive = DRIVE) -> Figure:
    (answer,) = held_answers(HeldQuestion(drive=drive, h=H, timing=timing, methods=(lookup("SYM"),)))
    alpha_hat, beta_hat = drive.point(H)
    return held_figure(answer, held_map("SYM", timing, 40, (float(alpha_hat), float(beta_hat))))


def test_the_edge_parts_what_is_proven_stable_from_what_is_not() -> None:
    timing = Timing(4, Fraction(1))
    axes = drawn(timing).axes[0]
    (edge,) = [each for each in axes.collections if isinstance(each, ContourSet)]
    points = np.concatenate([path.vertices for path in edge.get_paths()])
    assert len(points) > 40
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    cell = np.array([(right - left) / 40, (top - bottom) / 40])
    for kd, kp in points[::10]:
        nearby = [
            held_verdict("SYM", *Drive(Fraction(kp + up), Fraction(kd + across), DRIVE.inertia).point(H), timing)
            for across in (-cell[0], 0, cell[0])
            for up in (-cell[1], 0, cell[1])
            if kd + across > 0 and kp + up > 0
        ]
        assert {"converges", "diverges"} <= set(nearby), (kd, kp)


def test_the_law_is_drawn_where_there_is_one_in_the_units_of_the_gains() -> None:
    """Held for 4 steps: A > B 3 / 8, which is kp < 1000 / 3 kd, and 8 a + 4 b < 4."""
    lines = {line.get_label(): line for line in drawn(Timing(4)).axes[0].get_lines()}
    kd, kp = (np.asarray(each) for each in lines["closed form"].get_data())
    assert kp == pytest.approx(np.minimum(kd * 1000 / 3, (1 - 2 * 0.02 * kd) / 4e-5))
    assert "closed form" not in {line.get_label() for line in drawn(Timing(4, Fraction(1))).axes[0].get_lines()}


def test_the_typed_gains_are_marked_and_the_axes_are_marked_twice() -> None:
    figure = drawn(Timing(4, Fraction(1)))
    axes = figure.axes[0]
    (own,) = (line for line in axes.get_lines() if line.get_marker() == "*")
    assert own.get_xydata().tolist() == [[5, 200]]  # type: ignore[union-attr]
    assert own.get_label() == "kp = 200, kd = 5"
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("kd (N m s/rad)", "kp (N m/rad)")
    save(figure, "png", BytesIO())  # an axis opposite takes its limits when it is drawn
    across, up = axes.child_axes
    h_by_inertia = 0.002 / 0.1
    assert across.get_xlim()[1] == pytest.approx(h_by_inertia * axes.get_xlim()[1])
    assert up.get_ylim()[1] == pytest.approx(0.002 * h_by_inertia * axes.get_ylim()[1])


def test_gains_outside_of_what_is_stable_are_on_the_map() -> None:
    axes = drawn(Timing(4), Drive(Fraction(20000), Fraction(90), Fraction("0.1"))).axes[0]
    assert axes.get_xlim()[1] > 90
    assert axes.get_ylim()[1] > 20000


@pytest.mark.parametrize(
    ("timing", "words"),
    [
        (Timing(), "explicit, computed in every step\nh = 0.002 s"),
        (Timing(4, Fraction(1)), "explicit, held 4 steps, 1 step late\nh = 0.002 s"),
        (
            Timing(4, Fraction(3, 2), Fraction(5)),
            "explicit, held 4 steps, 1.5 steps late\nvelocity filtered over 0.01 s, h = 0.002 s",
        ),
    ],
)
def test_the_title_says_when_the_torque_is_computed_and_applied(timing: Timing, words: str) -> None:
    assert drawn(timing).axes[0].get_title() == words


def test_equal_maps_are_equal_bytes() -> None:
    files = []
    for _ in range(2):
        file = BytesIO()
        save(drawn(Timing(2, Fraction(1, 2))), "png", file)
        plt.close("all")
        files.append(file.getvalue())
    assert files[0] == files[1]
