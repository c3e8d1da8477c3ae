from dataclasses import replace

import numpy as np
import pytest

from bezstab.evidence import VerdictMap
from bezstab.mechanism import load_scene
from bezstab.methods import lookup
from bezstab.show.disagreement import agreement, disagreements_beyond_band, farthest_disagreement

NO, YES = False, True
VERDICTS = VerdictMap(
    scene=load_scene("pendulum"),
    method=lookup("SYM"),
    h=1e-3,
    run=2000,
    alpha_hat=np.array([0.1, 0.2]),
    beta_hat=np.array([0.1, 0.2]),
    z_abs=np.array([[0.9, 1.001], [1.1, 0.7]]),
    diverges=np.array([[YES, NO], [YES, YES]]),
    broken=np.array([[NO, NO], [NO, YES]]),
)


def test_two_of_three_judged_runs_disagree_and_one_of_them_beyond_the_band() -> None:
    assert agreement(VERDICTS) == pytest.approx(1 / 3)
    assert farthest_disagreement(VERDICTS) == pytest.approx(0.1)
    assert disagreements_beyond_band(VERDICTS) == 1


def test_without_a_judged_run_there_is_no_agreement() -> None:
    nothing = replace(VERDICTS, broken=np.ones((2, 2), bool))
    assert (agreement(nothing), farthest_disagreement(nothing), disagreements_beyond_band(nothing)) == (None, None, 0)
