import io
import re
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise

import pytest
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import BboxBase

from bezstab.methods import lookup
from bezstab.show.plane_figures import comparison_figure
from bezstab.show.style import (
    COLOURS,
    COLUMN_WIDTH,
    column_figure,
    line_at,
    mark_powers,
    method_marker,
    save,
    styled,
)
from bezstab.stability import region

NAMES = ["rk45", "hht", "generalized-alpha", "newmark", "radau3", "B3", "B4", "AB4", "RK4@5", "SYM", "SIE", "ABM4"]


def test_methods_in_a_figure_differ_in_colour_and_dashes_whatever_their_family() -> None:
    axes = comparison_figure([region(lookup(name)) for name in NAMES]).axes[0]
    looks = {(str(line.get_color()), dashes_of(line)) for line in axes.lines[: len(NAMES)]}
    assert len(looks) == len(NAMES)
    places = [line_at(place) for place in range(42)]
    assert len({(line["color"], str(line["linestyle"])) for line in places}) == 42
    for key in ("color", "linestyle"):
        assert len({str(line[key]) for line in places[:6]}) == 6


def dashes_of(line: Line2D) -> str:
    """Return a line's own dashes: get_linestyle calls them all dashed."""
    return str(line._unscaled_dash_pattern)  # type: ignore[attr-defined]


def test_neighbouring_colours_differ_in_grey() -> None:
    """By a tenth of the way from black to white, which paper shows; dashes differ besides."""
    luminance = [float(rgb_to_grey(colour)) for colour in COLOURS]
    assert all(abs(one - next_one) > 0.1 for one, next_one in pairwise([*luminance, luminance[0]]))


def rgb_to_grey(colour: str) -> float:
    """Return the luma of ITU-R BT.601, as photocopiers have it."""
    red, green, blue = to_rgb(colour)
    return 0.299 * red + 0.587 * green + 0.114 * blue


def test_a_method_has_one_marker_and_the_usual_ones_differ() -> None:
    usual = ["B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM"]  # tradeoff's default
    assert len({str(method_marker(lookup(name))) for name in usual}) == len(usual)
    own = replace(lookup("RK4"), name="mine")
    assert method_marker(own) == method_marker(replace(own, source="elsewhere"))


@pytest.mark.parametrize("names", [NAMES, NAMES[:5], ["B4"]])
@pytest.mark.parametrize("own_name", ["short", "a method of mine with a long name " * 3, "x" * 90])
@pytest.mark.slow_except("short-names2")
def test_the_legend_lies_within_the_figure(names: list[str], own_name: str) -> None:
    regions = [region(lookup(name)) for name in names]
    regions.append(region(replace(lookup("RK2"), name=own_name)))
    figure = comparison_figure(regions)
    figure.savefig(io.BytesIO())
    assert_within(figure.legends[0].get_window_extent(), figure)
    assert figure.axes[0].bbox.height > 0.4 * COLUMN_WIDTH * figure.dpi


def assert_within(box: BboxBase, figure: Figure) -> None:
    assert box.x0 >= 0
    assert box.y0 >= 0
    assert box.x1 <= figure.bbox.x1
    assert box.y1 <= figure.bbox.y1


@pytest.mark.parametrize(
    "limits", [(2.6e3, 4.4e3), (1.01e3, 1.9e3), (3e2, 9e3), (2e-13, 5e3), (1e2, 1e5), (4e-3, 1.1e-1), (2.1e3, 2.2e3)]
)
def test_labels_of_a_logarithmic_axis_are_apart(limits: tuple[float, float]) -> None:
    with styled():
        figure = column_figure()
        axes = figure.add_subplot()
        axes.set(xscale="log", xlim=limits)
        mark_powers(axes.xaxis)
    figure.savefig(io.BytesIO())
    shown = [label for label in axes.get_xticklabels() if label.get_text()]
    assert len(shown) >= 2
    assert not any(label.get_text() for label in axes.get_xticklabels(minor=True))
    boxes = [label.get_window_extent() for label in shown]
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
    for label, place in zip(shown, axes.get_xticks(), strict=True):
        numbers = re.findall(r"[-\d.]+", label.get_text())
        factor = float(numbers[0]) if len(numbers) == 3 else 1.0
        assert factor * 10 ** float(numbers[-1]) == pytest.approx(place, rel=5e-3)  # three digits


def test_text_in_svg_is_text() -> None:
    save(comparison_figure([region(lookup("B4"))]), "svg", file := io.BytesIO())
    assert b">B4</text>" in file.getvalue()


@pytest.mark.slow
def test_two_processes_draw_the_same_bytes() -> None:
    code = (
        "import sys; from bezstab.show.plane_figures import comparison_figure; from bezstab.show.style import save;"
        "from bezstab.methods import lookup;"
        "from bezstab.stability import region;"
        "save(comparison_figure([region(lookup('B4'))]), 'svg', sys.stdout.buffer)"
    )
    runs = [
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, check=True, env={"PYTHONHASHSEED": seed}
        ).stdout
        for seed in ("1", "2")
    ]
    assert runs[0] == runs[1]
    assert b"<svg" in runs[0]
