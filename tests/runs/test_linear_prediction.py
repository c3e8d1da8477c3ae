"""Linear prediction against responses whose poles are known because they were put in."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.runs.kicks import LINEAR
from bezstab.runs.linear_prediction import fit_dominant_pole, fit_window
from bezstab.stability.arrays import FloatArray
from tests.reference.sampled_responses import for_every_kick, two_poles

root = st.tuples(st.floats(0.4, 0.999), st.floats(0, np.pi))


@given(root, st.floats(0.2, 0.9), st.floats(0, 2 * np.pi))
def test_a_recursion_gives_back_its_dominant_pole(dominant: tuple[float, float], ratio: float, phase: float) -> None:
    modulus, angle = dominant
    if abs(np.sin(angle)) < 1e-2 or abs(np.cos(phase)) < 1e-2:
        return  # a double pole, or none of the dominant one
    fit = fit_window(two_poles(60, modulus, angle, phase, ratio), order=4)
    assert fit
    # RESIDUAL allows order 2 when the third pole has all but gone
    assert abs(fit.pole) == pytest.approx(modulus, abs=2e-3)


def test_what_cannot_be_measured_is_said() -> None:
    k = np.arange(1001)
    noise = np.random.default_rng(1).normal(0, 1, k.size)
    for name, response in {
        "gone at once": 1e-3**k + 1e-12 * noise,
        "noise": noise,
        "two of equal modulus": 0.99**k * (np.cos(0.5 * k) + np.cos(0.9 * k + 1)),
    }.items():
        responses, sizes = for_every_kick(response)
        fit, reason = fit_dominant_pole(responses, order=2, sizes=sizes, limits=LINEAR)
        assert fit is None, name
        assert "fit" in reason


@pytest.mark.parametrize("response", [np.zeros(50), np.full(50, np.nan), np.zeros(0)])
def test_silence_gaps_and_too_few_samples_are_refused(response: FloatArray) -> None:
    assert fit_dominant_pole(response[:, np.newaxis], order=2)[0] is None
