"""The figure of chains: its line parts what decays from what grows."""

import numpy as np
import pytest

from bezstab.chains.answer import chain, chain_map
from bezstab.chains.figure import chain_figure


@pytest.mark.slow
def test_the_line_of_chains_parts_what_decays_from_what_grows() -> None:
    answer = chain("chipmunk", h="1/60", bodies=7, mass_ratio=40)
    z_abs = chain_map(answer.engine, answer.values, answer.h, answer.links)
    axes = chain_figure(answer).axes[0]
    boundary, own = axes.get_lines()
    edge = np.asarray(boundary.get_xdata())[:-1, np.newaxis]
    # two bodies are marginal with one sweep
    assert ((z_abs < 1 - 1e-9) == (np.arange(1, z_abs.shape[1] + 1) > edge)).all()
    assert np.asarray(own.get_xdata())[0] == 10


def test_a_figure_without_an_edge_says_why() -> None:
    """Bullet's steps take so large a fraction of an error away that its size is multiplied by 1.1."""
    axes = chain_figure(chain("bullet=2.1", h="1/60", bodies=3)).axes[0]
    assert [text.get_text() for text in axes.texts] == ["diverges"]
    assert axes.get_lines()[0].get_label() == "no number of sweeps up to 50 is stable"
