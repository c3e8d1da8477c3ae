"""What all figures share: lines that are told apart, bytes that stay the same, text that lies within."""

import io
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import matplotlib as mpl
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import BboxBase

from bezstab.evidence import map_rows, simulated_verdicts, verdict_map
from bezstab.mechanism import at_speed, compiled_mechanism, initial_state, load_scene, simulated
from bezstab.methods import lookup
from bezstab.show import FIGURE_FORMS
from bezstab.show.plane_figures import comparison_figure, verdict_figure
from bezstab.show.run_figures import history_figure, scene_figure
from bezstab.show.style import COLUMN_WIDTH, column_figure, line_at, mark_powers, method_marker, save, styled
from bezstab.stability import region

NAMES = ["rk45", "hht", "generalized-alpha", "newmark", "radau3", "B3", "B4", "AB4", "RK4@5", "SYM", "SIE", "ABM4"]


def dashes_of(line: Line2D) -> str:
    """Return a line's own dashes: get_linestyle calls them all dashed."""
    return str(line._unscaled_dash_pattern)  # type: ignore[attr-defined]


@pytest.mark.slow
def test_methods_in_a_figure_differ_in_colour_dashes_and_marker() -> None:
    axes = comparison_figure([region(lookup(name)) for name in NAMES]).axes[0]
    looks = {(str(line.get_color()), dashes_of(line)) for line in axes.lines[: len(NAMES)]}
    assert len(looks) == len(NAMES)
    for key in ("color", "linestyle"):  # of neighbours both
        assert len({str(line_at(place)[key]) for place in range(6)}) == 6
    usual = ["B2", "B3", "B4", "AB2", "AB4", "ABM4", "RK4", "SIE", "SYM"]  # tradeoff's default
    assert len({str(method_marker(lookup(name))) for name in usual}) == len(usual)


def long_figures() -> Iterator[tuple[Figure, list[BboxBase]]]:
    """Yield figures with much text, drawn, with the boxes of what could reach beyond them."""
    regions = [region(lookup(name)) for name in NAMES]
    for own_name in ("a method of mine with a long name " * 3, "x" * 90):
        figure = comparison_figure([*regions, region(replace(lookup("RK2"), name=own_name))])
        figure.savefig(io.BytesIO())
        assert figure.axes[0].bbox.height > 0.4 * COLUMN_WIDTH * figure.dpi
        yield figure, [figure.legends[0].get_window_extent()]
    rows = map_rows(load_scene("slider_crank_light"), lookup("SYM"), 1e-3, 2)
    cells = verdict_map(rows, [simulated_verdicts(each) for each in rows])
    figure = verdict_figure(replace(cells, method=lookup("generalized-alpha")), region(lookup("SYM")))
    figure.savefig(io.BytesIO())
    yield figure, [figure.axes[0].title.get_window_extent()]
    crank = compiled_mechanism(at_speed(load_scene("slider_crank_light"), 3.0))
    for name, alpha_hat in (("generalized-alpha", 1 / 3), ("AB4", 1.5)):
        run = simulated(crank, lookup(name), h=0.001, duration=0.2, alpha_hat=alpha_hat, beta_hat=0.8)
        figure = history_figure(run)
        figure.savefig(io.BytesIO())
        yield figure, [figure.texts[0].get_window_extent()]
    scene = load_scene("andrews")
    figure = scene_figure(scene, initial_state(compiled_mechanism(scene))[0])
    figure.savefig(io.BytesIO())
    yield figure, [text.get_window_extent() for text in figure.axes[0].texts]


@pytest.mark.slow
def test_titles_legends_and_names_lie_within_the_figure() -> None:
    for figure, boxes in long_figures():
        assert boxes
        for box in boxes:
            assert min(box.x0, box.y0) >= 0
            assert box.x1 <= figure.bbox.x1
            assert box.y1 <= figure.bbox.y1


@pytest.mark.parametrize("limits", [(2.6e3, 4.4e3), (1.01e3, 1.9e3), (2e-13, 5e3), (4e-3, 1.1e-1), (2.1e3, 2.2e3)])
def test_labels_of_a_logarithmic_axis_are_apart(limits: tuple[float, float]) -> None:
    with styled():
        figure = column_figure()
        axes = figure.add_subplot()
        axes.set(xscale="log", xlim=limits)
        mark_powers(axes.xaxis)
    figure.savefig(io.BytesIO())
    shown = [label for label in axes.get_xticklabels() if label.get_text()]
    assert len(shown) >= 2
    boxes = [label.get_window_extent() for label in shown]
    assert all(left.x1 < right.x0 for left, right in pairwise(boxes))
    for label, place in zip(shown, axes.get_xticks(), strict=True):
        numbers = re.findall(r"[-\d.]+", label.get_text())
        factor = float(numbers[0]) if len(numbers) == 3 else 1.0
        assert factor * 10 ** float(numbers[-1]) == pytest.approx(place, rel=5e-3)  # three digits


@pytest.mark.parametrize("form", FIGURE_FORMS)
def test_equal_figures_are_equal_bytes_whatever_the_users_settings(form: str) -> None:
    outputs = []
    for settings in ({}, {"font.size": 20, "lines.linewidth": 9, "savefig.dpi": 10, "svg.hashsalt": "x"}):
        with mpl.rc_context(settings):  # type: ignore[arg-type,unused-ignore]
            save(comparison_figure([region(lookup("B4"))]), form, file := io.BytesIO())
        outputs.append(file.getvalue())
    assert outputs[0] == outputs[1]
    assert form != "svg" or b">B4</text>" in outputs[0]  # text stays text


@pytest.mark.slow
def test_two_processes_draw_the_same_bytes() -> None:
    code = (
        "import sys; from bezstab.show.plane_figures import comparison_figure; from bezstab.show.style import save;"
        "from bezstab.methods import lookup;"
        "from bezstab.stability import region;"
        "save(comparison_figure([region(lookup('B4'))]), 'svg', sys.stdout.buffer)"
    )
    first, second = (
        subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, env={"PYTHONHASHSEED": seed})
        for seed in ("1", "2")
    )
    assert first.stdout == second.stdout
    assert b"<svg" in first.stdout
