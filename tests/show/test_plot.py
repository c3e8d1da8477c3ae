import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.start import initial_state
from bezstab.methods.registry import lookup
from bezstab.show import plot
from bezstab.stability.regions import region
from tests.show.drawn import lines_of

B4 = lookup("B4")


def test_two_regions_share_given_axes_and_take_the_callers_style() -> None:
    axes = Figure().add_subplot()
    first = plot.region(region(B4), axes, color="red", linewidth=3)
    second = plot.region(region(lookup("AB4")), axes)
    assert axes.lines[:] == [first, second]
    assert (first.get_color(), first.get_linewidth()) == ("red", 3)


def mechanism(name: str) -> Axes:
    scene, axes = load_scene(name), Figure().add_subplot()
    plot.mechanism(scene, initial_state(compiled_mechanism(scene))[0], axes)
    return axes


def test_a_body_on_a_pivot_is_drawn_from_it() -> None:
    """Where pivots are: by hand from the scene's file."""
    lines = lines_of(mechanism("andrews"))
    for name, pivot in {"K1": (0, 0), "K3": (-0.03635, 0.03273), "K7": (-0.06934, -0.00227)}.items():
        assert pytest.approx(pivot, abs=1e-15) in lines[name].tolist()


@pytest.mark.parametrize(("name", "sliders"), [("andrews", 0), ("slider_crank", 1)])
def test_what_slides_alone_is_a_square(name: str, sliders: int) -> None:
    assert [line.get_marker() for line in mechanism(name).lines].count("s") == sliders
