from fractions import Fraction

import numpy as np
import pytest

from bezstab.stability.root_finding import (
    roots_of_table,
)


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
