import io
import subprocess
import sys
from typing import Any

import matplotlib as mpl
import pytest

from bezstab.methods import lookup
from bezstab.show.plane_figures import comparison_figure
from bezstab.show.style import save
from bezstab.stability import region
from tests.show.test_plane_figures import drawn_map


def test_a_method_has_the_same_colour_everywhere_and_its_own_line() -> None:
    names = ["B3", "B4", "AB3", "AB4", "RK4@5", "SYM", "SIE", "ABM4"]
    looks = []
    for order in (names, names[::-1]):
        axes = comparison_figure([region(lookup(name)) for name in order]).axes[0]
        looks.append({str(line.get_label()): (line.get_color(), line.get_linestyle()) for line in axes.lines})
    assert looks[0] == looks[1]
    assert len(set(map(str, looks[0].values()))) == len(names)


@pytest.mark.parametrize("form", ["png", "svg", "pdf"])
def test_equal_figures_are_equal_bytes_whatever_the_users_settings(form: str) -> None:
    outputs = []
    own: dict[str, Any] = {"font.size": 20, "lines.linewidth": 9, "savefig.dpi": 10, "svg.hashsalt": "x"}
    for settings in ({}, own):
        with mpl.rc_context(settings):  # type: ignore[arg-type,unused-ignore]
            save(drawn_map()[0], form, file := io.BytesIO())  # type: ignore[arg-type]
        outputs.append(file.getvalue())
    assert outputs[0] == outputs[1]


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
