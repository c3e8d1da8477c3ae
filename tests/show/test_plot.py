import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.scenes import Scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.show import plot
from bezstab.stability.arrays import FloatArray
from bezstab.stability.regions import region

B4 = lookup("B4")


def test_two_regions_share_given_axes_and_take_the_callers_style() -> None:
    axes = Figure().add_subplot()
    first = plot.region(region(B4), axes, color="red", linewidth=3)
    second = plot.region(region(lookup("AB4")), axes)
    assert axes.lines[:] == [first, second]
    assert (first.get_color(), first.get_linewidth()) == ("red", 3)


def test_a_body_on_a_pivot_is_drawn_from_it_and_only_what_slides_is_a_square() -> None:
    """Where pivots are: by hand from the scene's file."""
    pivots = {"K1": (0, 0), "K3": (-0.03635, 0.03273), "K5": (-0.06934, -0.00227), "K7": (-0.06934, -0.00227)}
    axes = Figure().add_subplot()
    lines = {str(line.get_label()): line for line in plot.mechanism(*at_start("andrews"), axes)}
    for name, pivot in pivots.items():
        first, second = np.array(lines[name].get_xydata())
        assert pytest.approx(pivot, abs=1e-15) in (first, second)
    supports = {tuple(np.array(line.get_xydata())[0].tolist()) for line in axes.lines if line.get_marker() == 6}
    assert supports == set(pivots.values())
    squares = [sum(line.get_marker() == "s" for line in drawn.lines) for drawn in (axes, slider_crank())]
    assert squares == [0, 1]


def at_start(name: str) -> tuple[Scene, FloatArray]:
    scene = load_scene(name)
    return scene, initial_state(compiled_mechanism(scene))[0]


def slider_crank() -> Axes:
    plot.mechanism(*at_start("slider_crank"), axes := Figure().add_subplot())
    return axes
