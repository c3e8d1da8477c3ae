from fractions import Fraction
from io import BytesIO

import matplotlib.pyplot as plt
import numpy as np
import pytest

from bezstab.engines import ENGINES
from bezstab.questions import chain_map
from bezstab.show import chains_figure, save

CHIPMUNK = ENGINES["chipmunk"]
VALUES, H = (Fraction("0.9") ** 60,), Fraction(1, 60)


@pytest.mark.slow
def test_the_line_parts_what_decays_from_what_grows_and_equal_figures_are_equal_bytes() -> None:
    one = chain_map(CHIPMUNK, VALUES, H, Fraction(10), bodies=7, sweeps=12)
    files = []
    for _ in range(2):
        figure = chains_figure(CHIPMUNK, "Chipmunk", [one])
        axes = figure.axes[0]
        (boundary, own) = axes.get_lines()
        file = BytesIO()
        save(figure, "png", file)
        files.append(file.getvalue())
        plt.close("all")
    assert files[0] == files[1]
    across, up = (np.asarray(each) for each in boundary.get_data())
    for bodies in range(1, 8):
        edge = across[2 * (bodies - 1)]
        assert up[2 * (bodies - 1)] < bodies < up[2 * (bodies - 1) + 1]
        stable = np.arange(1, 13) > edge
        assert ((one.z_abs[bodies - 1] < 1 - 1e-9) == stable).all()  # two bodies are marginal with one sweep
    assert np.asarray(own.get_xdata())[0] == pytest.approx(10)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == [
        "$|z| = 1$: stable to the right",
        "its own 10 sweeps",
    ]
