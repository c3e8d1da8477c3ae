from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bezstab.stability.root_finding import (
    STRIDE,
    horner,
    roots_of_table,
)


@given(st.lists(st.floats(-4, 4), min_size=10, max_size=10), st.integers(1, 3 * STRIDE))
@settings(deadline=None)
def test_the_roots_have_their_sum_and_their_product(numbers: list[float], count: int) -> None:
    table = np.array([numbers[:3], numbers[3:6], numbers[6:9], [1.0, 0.0, 0.0]])  # cubic in y, monic
    x = np.linspace(-1 + 0.3j, 1 + 0.3j, count, dtype=np.complex128)
    y = roots_of_table(table, x)
    size = 1 + np.abs(table).sum()
    assert np.abs(y.sum(axis=0) + horner(table[2], x)).max() < 1e-7 * size  # a triple root keeps a third of the digits
    assert np.abs(y.prod(axis=0) + horner(table[0], x)).max() < 1e-7 * size**3


def test_roots_of_very_different_size_keep_their_digits() -> None:
    exact = np.array([1e-12, 1e-3, 1.0, 1e7, 1e15])
    product = [Fraction(1)]  # ascending
    for root in exact.tolist():
        product = [
            below - Fraction(root) * c
            for below, c in zip([Fraction(0), *product], [*product, Fraction(0)], strict=True)
        ]
    ascending = [float(c) for c in product]
    found = roots_of_table(np.array(ascending)[:, np.newaxis], np.array([0j]))[:, 0]
    assert np.sort(found.real) == pytest.approx(exact, rel=1e-13)


def test_roots_whose_powers_leave_float64_keep_their_digits() -> None:
    exact = np.array([1e-120, 1.0, 1e120])
    ascending = [-1.0, 1e120, -1e120, 1.0]  # of the product, where each coefficient is one term and trifles
    found = roots_of_table(np.array(ascending)[:, np.newaxis], np.array([0j]))[:, 0]
    assert np.sort(found.real) == pytest.approx(exact, rel=1e-13)
