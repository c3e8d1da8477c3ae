"""A window on the plane: what it says of the point under the mouse, and that it opens."""

from fractions import Fraction

import pytest
from matplotlib import pyplot
from matplotlib.backends.backend_agg import FigureCanvasAgg

from bezstab.methods.registry import lookup
from bezstab.regions.answer import MapConditions, map_answer
from bezstab.regions.figure import map_figure
from tests.cli.running import run


def test_the_point_under_the_mouse_has_its_gains_its_pole_and_its_proven_verdict() -> None:
    """B1, explicit Euler, has the poles 1/2 +- i/2 at (1, 1/2); on its edge alpha_hat = beta_hat no float64 decides."""
    (axes, _) = map_figure(map_answer(lookup("B1"), MapConditions(h=Fraction("0.01"), points=2), drawn=True)).axes
    words = "α̂ = {}, β̂ = {} (α = {} 1/s, β = {} 1/s at h = 0.01 s)\nB1: |z_p| = {}, {} (proven)"
    two_alpha, beta_squared = 1 / 0.01, 0.5 / 0.01**2
    assert axes.format_coord(two_alpha, beta_squared) == words.format(1, 0.5, 50, 70.7107, "0.707107", "converges")
    assert axes.format_coord(70, 7000) == words.format(0.7, 0.7, 35, 83.666, "1.000000", "marginal")


def test_a_window_opens_on_the_map(monkeypatch: pytest.MonkeyPatch) -> None:
    opened = []
    pyplot.switch_backend("agg")
    monkeypatch.setattr(FigureCanvasAgg, "required_interactive_framework", "a screen")
    monkeypatch.setattr(pyplot, "show", lambda: opened.append(pyplot.gcf().axes[0].get_title()))
    assert run("region --quality fast --figure window").exit_code == 0
    assert opened == ["B4: what a step multiplies errors by"]
    pyplot.close("all")


def test_without_a_screen_one_line_says_so() -> None:
    pyplot.switch_backend("agg")
    result = run("region --quality fast --figure window")
    assert (result.exit_code, result.stdout, result.stderr.count("\n")) == (2, "", 1)
    assert "window" in result.stderr
