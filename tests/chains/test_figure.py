"""The figure of chains: its line parts what decays from what grows."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.chains.answer import chain, chain_map
from bezstab.chains.figure import chain_figure


@pytest.mark.slow
def test_the_line_of_chains_parts_what_decays_from_what_grows() -> None:
    answer = chain("chipmunk", h="1/60", bodies=7, mass_ratio=10)
    z_abs = chain_map(answer.engine, answer.values, answer.h, 7, Fraction(10), both_ends=False)
    boundary, own = chain_figure(answer).axes[0].get_lines()
    assert boundary.get_drawstyle() == "steps-pre"
    across, up = (np.asarray(each) for each in boundary.get_data())
    for bodies in range(1, 8):
        assert up[bodies - 1] < bodies < up[bodies]
        stable = np.arange(1, z_abs.shape[1] + 1) > across[bodies - 1]
        assert ((z_abs[bodies - 1] < 1 - 1e-9) == stable).all()  # two bodies are marginal with one sweep
    assert np.asarray(own.get_xdata())[0] == pytest.approx(10)
