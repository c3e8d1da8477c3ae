import numpy as np
import pytest

from bezstab.stability import kick_response

STEPS = 100


def test_the_decay_is_the_linear_recursion() -> None:
    assert kick_response(np.array([0.5 + 0j]), STEPS) == pytest.approx(0.5 ** np.arange(STEPS + 1))
    two = kick_response(np.array([0.4 + 0j, 0.5 + 0j]), STEPS)
    k = np.arange(STEPS + 1)
    assert two == pytest.approx(5 * 0.5**k - 4 * 0.4**k)


@pytest.mark.filterwarnings("error")
def test_a_decay_that_grows_beyond_float64_ends_there_in_silence() -> None:
    grown = kick_response(np.array([1e5 + 0j]), STEPS)
    assert grown[:60] == pytest.approx(1e5 ** np.arange(60.0))
    assert not np.isfinite(grown[-1])
