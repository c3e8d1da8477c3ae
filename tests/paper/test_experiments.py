import numpy as np
import pytest

from bezstab.methods import lookup
from bezstab.paper.experiments import experiment, largest, pole
from bezstab.stability import dominant_pole


def test_an_experiment_begins_with_its_kick_and_its_largest_error_is_that_between_two_times() -> None:
    run = experiment("B4", 0.6, 0.35, duration=0.05, kick=1e-3)
    assert run.c[0, 0] == pytest.approx(1e-3)
    assert pole(run) == dominant_pole(lookup("B4"), 0.6, 0.35)
    assert largest(run, 0, 0.05) == np.abs(run.c[:, 0]).max()
    assert largest(run, 0.01, 0.02) == np.abs(run.c[10:21, 0]).max()
