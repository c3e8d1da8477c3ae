"""The figure of chains: its line parts what decays from what grows."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.engines import ENGINES
from bezstab.questions import chain_map
from bezstab.show import chains_figure


@pytest.mark.slow
def test_the_line_of_chains_parts_what_decays_from_what_grows() -> None:
    engine = ENGINES["chipmunk"]
    one = chain_map(engine, (Fraction("0.9") ** 60,), Fraction(1, 60), Fraction(10), bodies=7, sweeps=12)
    boundary, own = chains_figure(engine, "Chipmunk", [one]).axes[0].get_lines()
    assert boundary.get_drawstyle() == "steps-pre"
    across, up = (np.asarray(each) for each in boundary.get_data())
    for bodies in range(1, 8):
        assert up[bodies - 1] < bodies < up[bodies]
        stable = np.arange(1, 13) > across[bodies - 1]
        assert ((one.z_abs[bodies - 1] < 1 - 1e-9) == stable).all()  # two bodies are marginal with one sweep
    assert np.asarray(own.get_xdata())[0] == pytest.approx(10)
