from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import lookup, step_matrix
from bezstab.stability.lyapunov_quadratics import centred_form, proves_decay, rational_form

HALF, ONE = Fraction(1, 2), Fraction(1)
IDENTITY = [[ONE, Fraction(0)], [Fraction(0), ONE]]


def test_a_form_that_all_matrices_make_smaller_is_found() -> None:
    # both shrink the norm |T x|, in whose coordinates they are plain
    plain = np.array([[[0.5, 0.3], [0.0, 0.5]], [[0.5, 0.0], [0.3, 0.5]]])
    frame = np.array([[1.0, 0.0], [3.0, 10.0]])
    matrices = np.linalg.inv(frame) @ plain @ frame
    form = centred_form(matrices, np.full(2, 0.5))
    left = form - np.swapaxes(matrices, 1, 2) @ form @ matrices
    assert np.linalg.eigvalsh(form).min() > 0
    assert np.linalg.eigvalsh(left).min() > 0


@pytest.mark.promise("Steps that vary, proven (`check --h-min --h-max`)")
def test_a_form_is_proven_exactly_as_far_as_it_holds() -> None:
    # the length |x| under one step of implicit Euler without damping: M^T M = 1 / (1 + b s^2) where b = 1
    matrix = step_matrix(lookup("implicit-euler"), Fraction(0), ONE)
    assert proves_decay(IDENTITY, matrix, HALF)
    # it is no longer than before after any step, but one without length leaves it as it is
    assert not proves_decay(IDENTITY, matrix, Fraction(0))


def test_a_form_that_is_not_positive_proves_nothing() -> None:
    matrix = step_matrix(lookup("implicit-euler"), Fraction(0), ONE)
    negative = [[-entry for entry in row] for row in IDENTITY]
    assert not proves_decay(negative, matrix, HALF)


def test_rounding_keeps_small_entries_exact_in_units_of_the_last() -> None:
    assert rational_form(np.array([[8.0, 1.0], [1.0, 2.0]])) == [[Fraction(4), HALF], [HALF, ONE]]
