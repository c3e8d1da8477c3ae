from fractions import Fraction

import numpy as np
import pytest

from bezstab.stability.root_finding import roots_of_rows


def test_roots_of_very_different_size_keep_their_digits() -> None:
    exact = np.array([1e-12, 1e-3, 1.0, 1e7, 1e15])
    product = [Fraction(1)]  # ascending
    for root in exact.tolist():
        product = [
            below - Fraction(root) * c
            for below, c in zip([Fraction(0), *product], [*product, Fraction(0)], strict=True)
        ]
    ascending = [float(c) for c in product]
    found = roots_of_rows(np.array(ascending)[:, np.newaxis])[:, 0]
    assert np.sort(found.real) == pytest.approx(exact, rel=1e-13)


def test_where_one_root_is_infinite_or_beyond_float64_the_others_are_found() -> None:
    # (z - 1) (z - 2) (z - 3) as a cubic of a quartic's form; and times (z - 1e120), whose powers overflow
    ascending = np.array([[-6.0, 11.0, -6.0, 1.0, 0.0], [6e120, -11e120, 6e120, -1e120, 1.0]]).T
    found = roots_of_rows(ascending)
    assert np.isfinite(found).sum(axis=0).tolist() == [3, 3]
    for column in found.T:
        assert np.sort(column[np.isfinite(column)].real) == pytest.approx([1, 2, 3], rel=1e-13)
