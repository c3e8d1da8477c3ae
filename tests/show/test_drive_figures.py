"""Maps of drives that are held or late, and of chains: edges part what is proven stable from what is not."""

from fractions import Fraction

import numpy as np
import pytest
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure

from bezstab.engines import ENGINES, Drive
from bezstab.methods import lookup
from bezstab.questions import HeldQuestion, chain_map, held_answers
from bezstab.show import chains_figure, held_figure
from bezstab.stability import Timing, held_verdict

H = Fraction("0.002")
DRIVE = Drive(Fraction(200), Fraction(5), Fraction("0.1"))


def drawn(timing: Timing, drive: Drive = DRIVE) -> Figure:
    (answer,) = held_answers(
        HeldQuestion(drive=drive, h=H, methods=(lookup("SYM"),), every=timing.every, late=timing.late)
    )
    return held_figure(answer, 40)


def test_the_edge_parts_what_is_proven_stable_from_what_is_not() -> None:
    timing = Timing(4, Fraction(1))
    figure = drawn(timing)
    axes = figure.axes[0]
    assert axes.get_title().startswith("explicit, h = 0.002 s\nThe torque is computed every 4 steps (8 ms)")
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


@pytest.mark.slow
def test_the_line_of_chains_parts_what_decays_from_what_grows() -> None:
    engine = ENGINES["chipmunk"]
    one = chain_map(engine, (Fraction("0.9") ** 60,), Fraction(1, 60), Fraction(10), bodies=7, sweeps=12)
    boundary, own = chains_figure(engine, "Chipmunk", [one]).axes[0].get_lines()
    assert boundary.get_drawstyle() == "steps-pre"
    across, up = (np.asarray(each) for each in boundary.get_data())
    for bodies in range(1, 8):
        assert up[bodies - 1] < bodies < up[bodies]
        stable = np.arange(1, 13) > across[bodies - 1]
        assert ((one.z_abs[bodies - 1] < 1 - 1e-9) == stable).all()  # two bodies are marginal with one sweep
    assert np.asarray(own.get_xdata())[0] == pytest.approx(10)
