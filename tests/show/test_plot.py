import numpy as np
import pytest
from matplotlib.figure import Figure

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.show import plot
from bezstab.stability.regions import region

B4 = lookup("B4")


def test_two_regions_share_given_axes_and_take_the_callers_style() -> None:
    axes = Figure().add_subplot()
    first = plot.region(region(B4), axes, color="red", linewidth=3)
    second = plot.region(region(lookup("AB4")), axes)
    assert axes.lines[:] == [first, second]
    assert (first.get_color(), first.get_linewidth()) == ("red", 3)


ANDREWS = {"K1": (0, 0), "K3": (-0.03635, 0.03273), "K5": (-0.06934, -0.00227), "K7": (-0.06934, -0.00227)}


@pytest.mark.parametrize(("scene_name", "pivots"), [("slider_crank", {"crank": (0, 0)}), ("andrews", ANDREWS)])
def test_a_body_on_a_pivot_is_drawn_from_it_and_only_what_slides_is_a_square(
    scene_name: str, pivots: dict[str, tuple[float, float]]
) -> None:
    """Where pivots are: by hand from the scenes' files."""
    scene = load_scene(scene_name)
    start = initial_state(compiled_mechanism(scene))[0]
    axes = Figure().add_subplot()
    lines = {str(line.get_label()): line for line in plot.mechanism(scene, start, axes)}
    for name, pivot in pivots.items():
        points = np.array(lines[name].get_xydata())
        assert len(points) == 2
        assert np.abs(points - pivot).sum(axis=1).min() == pytest.approx(0, abs=1e-15)
    squares = [line for line in axes.lines if line.get_marker() == "s"]
    assert len(squares) == (scene_name == "slider_crank")
    supports = {tuple(np.array(line.get_xydata())[0].tolist()) for line in axes.lines if line.get_marker() == 6}
    assert supports == set(pivots.values())
