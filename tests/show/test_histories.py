import numpy as np
import pytest

from bezstab.show.histories import history_line
from bezstab.show.style import column_figure


def test_a_slow_history_is_its_line() -> None:
    t = np.linspace(0, 1, 5001)
    values = np.sin(2 * np.pi * 33 * t)
    line = history_line(axes := column_figure().add_subplot(), t, values)
    assert np.array(line.get_ydata()).tolist() == values.tolist()
    assert not axes.collections


@pytest.mark.parametrize("cycles", [150, 2500])
def test_a_fast_oscillation_is_its_envelope(cycles: int) -> None:
    """exp(-t) cos: between -exp(-t) and exp(-t), to what a column of the band and its decay in it come to."""
    t = np.linspace(0, 1, 10_001)
    line = history_line(axes := column_figure().add_subplot(), t, np.exp(-t) * np.cos(2 * np.pi * cycles * t))
    (band,) = axes.collections
    x, y = np.asarray(band.get_paths()[0].vertices, dtype=float).T
    assert np.isnan(np.array(line.get_ydata(), dtype=float)[100:-100]).all()
    assert np.abs(np.abs(y) / np.exp(-x) - 1).max() < 0.06
    assert (y > 0).any()
    assert (y < 0).any()
