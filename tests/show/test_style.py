"""What all figures share: lines that are told apart, bytes that stay the same."""

import io

import matplotlib as mpl
import pytest

from bezstab.methods.registry import lookup
from bezstab.regions.answer import MapConditions
from bezstab.regions.figure import comparison_figure
from bezstab.show.file_forms import FIGURE_FORMS
from bezstab.show.style import line_at, new_axes, save, styled, with_legend
from bezstab.stability.regions import region


def test_lines_in_a_figure_differ_in_colour_or_dashes_and_neighbours_in_both() -> None:
    assert len({str(line_at(place)) for place in range(42)}) == 42
    for key in ("color", "linestyle"):
        assert len({str(line_at(place)[key]) for place in range(6)}) == 6


def test_a_label_that_is_wider_than_the_figure_is_broken_into_lines() -> None:
    with styled():
        figure, axes = new_axes("", "", "")
        axes.plot([0, 1], label=10 * "method of my own ")
        (legend,) = with_legend(figure).legends
        figure.draw_without_rendering()
        assert legend.get_window_extent().width < figure.bbox.width


@pytest.mark.parametrize("form", FIGURE_FORMS)
def test_equal_figures_are_equal_bytes_whatever_the_users_settings_and_the_day(
    form: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    outputs = []
    for settings in ({}, {"font.size": 20, "lines.linewidth": 9, "savefig.dpi": 10, "svg.hashsalt": "x"}):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", str(86400 * len(settings)))
        with mpl.rc_context(settings):  # type: ignore[arg-type,unused-ignore]
            save(comparison_figure([region(lookup("B4"))], MapConditions()), form, file := io.BytesIO())
        outputs.append(file.getvalue())
    assert outputs[0] == outputs[1]
    assert form != "svg" or b">B4</text>" in outputs[0]  # text stays text
