"""The reference motion against quadrature, and against itself at other steps."""

from typing import Any

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.evidence import reference_motion, reference_motions
from bezstab.mechanism import Mechanism, Trajectory, load_scene, simulate
from bezstab.methods import Method

LIGHT = "slider_crank_light"


@pytest.mark.promise(
    "The reference of `tradeoff`",
    computed="its own error estimate, against quadrature in thirty digits",
)
def test_the_reference_has_the_digits_it_claims() -> None:
    # one coordinate, by quadrature with 30 digits: see tests/mechanism/test_runner.py
    true = reference_motion(load_scene("slider_crank"), 1e-3, 2.0)
    assert true.error < 1e-12
    angles = true.at(np.array([1.0, 2.0]))[:, 0]
    assert angles == pytest.approx([1.822086334469, 2.872938352485], abs=max(true.error, 5e-13))


@pytest.mark.slow
def test_between_its_steps_the_reference_is_as_good() -> None:
    true, other = (reference_motion(load_scene(LIGHT), h, 0.5) for h in (1e-3, 1e-3 * np.sqrt(0.5)))
    assert np.abs(true.at(other.t[:-1]) - other.q[:-1]).max() < true.error + other.error + 1e-13


def test_at_its_steps_the_reference_is_its_own_history() -> None:
    true = reference_motion(load_scene(LIGHT), 1e-2, 0.1)
    assert true.at(true.t) == pytest.approx(true.q, abs=1e-15)


def test_a_reference_that_fails_says_where() -> None:
    with pytest.raises(NumericalError, match=r"the reference of .* fails at t = "):
        reference_motion(load_scene("four_bar"), 5.0, 500.0)


def test_halving_ends_where_rounding_takes_over_with_the_best_run(monkeypatch: pytest.MonkeyPatch) -> None:
    tried: list[float] = []

    def watched(mechanism: Mechanism, method: Method, h: float, *rest: Any) -> Trajectory:
        tried.append(h)
        return simulate(mechanism, method, h, *rest)

    monkeypatch.setattr(reference_motions, "simulate", watched)
    true = reference_motion(load_scene(LIGHT), 1e-3, 0.1)
    assert len(tried) < 5  # of five at most: h^4 is 1e-13 at the second
    assert true.t[1] in tried
    assert true.error < 1e-12
