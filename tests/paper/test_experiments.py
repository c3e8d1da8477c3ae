import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper.experiments import experiment
from bezstab.stability import dominant_pole

RUN = experiment("B4", 0.6, 0.35, duration=0.05, kick=1e-3)


def test_an_experiment_begins_with_its_kick_and_knows_its_pole() -> None:
    assert RUN.c[0] == pytest.approx(1e-3)
    assert RUN.c.shape == RUN.cdot.shape == RUN.t.shape == (51,)
    assert RUN.pole == dominant_pole(lookup("B4"), 0.6, 0.35)
    assert RUN.failure is None


def test_the_largest_error_is_that_between_two_times() -> None:
    assert RUN.largest(0, 0.05) == np.abs(RUN.c).max()
    assert RUN.largest(0.01, 0.02) == np.abs(RUN.c[10:21]).max()
