import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bezstab.mechanism import compiled_mechanism, initial_state, load_scene
from bezstab.methods import lookup
from bezstab.show import plot
from bezstab.stability import region

B4 = lookup("B4")


def test_two_regions_share_given_axes_and_take_the_callers_style() -> None:
    axes = Figure().add_subplot()
    first = plot.region(region(B4), axes, color="red", linewidth=3)
    second = plot.region(region(lookup("AB4")), axes)
    assert axes.lines[:] == [first, second]
    assert (first.get_color(), first.get_linewidth()) == ("red", 3)


@pytest.mark.parametrize(
    ("scene_name", "pivots"),
    [
        ("slider_crank", {"crank": (0, 0)}),
        ("four_bar", {"crank": (0, 0), "rocker": (0.3, 0)}),
        (
            "andrews",
            {"K1": (0, 0), "K3": (-0.03635, 0.03273), "K5": (-0.06934, -0.00227), "K7": (-0.06934, -0.00227)},
        ),
    ],
)
def test_a_body_on_a_pivot_is_drawn_from_it_and_only_what_slides_is_a_square(
    scene_name: str, pivots: dict[str, tuple[float, float]]
) -> None:
    """Where pivots are: by hand from the scenes' files. No joint of a rigid body changes its distance as it turns."""
    scene = load_scene(scene_name)
    start = initial_state(compiled_mechanism(scene))[0]
    lines = {str(line.get_label()): line for line in plot.mechanism(scene, start)}
    for name, pivot in pivots.items():
        points = np.array(lines[name].get_xydata())
        assert len(points) == 2
        assert np.abs(points - pivot).sum(axis=1).min() == pytest.approx(0, abs=1e-15)
    axes = next(iter(lines.values())).axes
    assert isinstance(axes, Axes)
    squares = [line for line in axes.lines if line.get_marker() == "s"]
    assert len(squares) == (scene_name == "slider_crank")
    supports = {tuple(np.array(line.get_xydata())[0].tolist()) for line in axes.lines if line.get_marker() == 6}
    assert supports == set(pivots.values())


@pytest.mark.parametrize(("h", "names"), [(None, ("alpha", "beta")), (0.001, ("1/s", "1/s"))])
def test_axes_that_are_given_empty_are_labelled_and_others_left_alone(h: float | None, names: tuple[str, str]) -> None:
    stable = region(lookup("B4"))
    empty, titled, used = Figure().subplots(1, 3)
    titled.set_xlabel("mine")
    used.plot([0, 1], [0, 1])
    for axes in (empty, titled, used):
        plot.region(stable, axes, h)
    assert all(name in label for name, label in zip(names, (empty.get_xlabel(), empty.get_ylabel()), strict=True))
    assert (titled.get_xlabel(), titled.get_ylabel()) == ("mine", "")
    assert (used.get_xlabel(), used.get_ylabel()) == ("", "")
