from fractions import Fraction

import numpy as np
import pytest

from bezstab.errors import NumericalError
from bezstab.methods import Method, RungeKutta
from bezstab.stability import poles
from bezstab.stability.mu_pencils import MuPencil, roots_in_z
from tests.reference.made_methods import multistep


def test_coefficients_beyond_float64_are_reported() -> None:
    huge, none = Fraction(10) ** 90, Fraction(0)
    rows = tuple(tuple(huge if column == row - 1 else none for column in range(4)) for row in range(4))
    method = Method("huge", RungeKutta(rows, (1 - huge, none, none, huge)), "constructed")  # R has huge^4 mu^4
    with pytest.raises(NumericalError, match="huge: products of its coefficients"):
        poles(method, 0.5, 0.1)


def test_a_leading_coefficient_vanishes_to_its_own_rounding_alone() -> None:
    # z^2 (1 - 7 mu / 10) - (1 - 13 mu / 10): nothing in z, from which a size could be taken by mistake
    method = multistep("gap", "1 0 -1", "7/10 0 13/10")
    place = 10 / 7 * (1 + np.finfo(float).eps * np.array([-2, -1, 0, 1, 2]))
    assert np.isinf(roots_in_z(MuPencil(method), place.astype(complex))).all()
    assert np.isfinite(roots_in_z(MuPencil(method), np.array([10 / 7 + 1e-9], complex))).all()
