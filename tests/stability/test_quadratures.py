import numpy as np
import pytest

from bezstab.stability.quadratures import tanh_sinh


def test_powers_at_the_ends_are_integrated_to_rounding_and_by_a_coarse_step_to_a_billionth() -> None:
    for power in (0.5, 1 / 3, 1.5, -0.25):
        exact = 2 ** (power + 1) / (power + 1)
        for step, accuracy in ((1 / 16, 1e-12), (1 / 4, 1e-9)):
            x, weights = tanh_sinh(0.0, 2.0, step)
            assert weights @ x**power == pytest.approx(exact, rel=accuracy)


def test_many_intervals_at_once_and_half_the_nodes_of_each() -> None:
    low, high = np.array([[0.0], [1.0]]), np.array([[1.0], [3.0]])
    x, weights = tanh_sinh(low, high, 1 / 8)
    exact = [2 / 3, (3**1.5 - 1) / 1.5]
    assert (weights * np.sqrt(x)).sum(axis=1) == pytest.approx(exact, rel=1e-12)
    assert 2 * (weights * np.sqrt(x))[:, ::2].sum(axis=1) == pytest.approx(exact, rel=1e-9)
