from fractions import Fraction

import numpy as np

from bezstab.methods.registry import lookup
from bezstab.methods.step_matrices import step_matrix
from bezstab.step_sequences.lyapunov_quadratics import proves_decay

HALF, ONE = Fraction(1, 2), Fraction(1)
IDENTITY = np.array([[ONE, Fraction(0)], [Fraction(0), ONE]])


def test_a_form_is_proven_exactly_as_far_as_it_holds() -> None:
    # the length |x| under one step of implicit Euler without damping: M^T M = 1 / (1 + b s^2) where b = 1
    matrix = step_matrix(lookup("implicit-euler"), Fraction(0), ONE)
    assert proves_decay(IDENTITY, matrix, HALF)
    # it is no longer than before after any step, but one without length leaves it as it is
    assert not proves_decay(IDENTITY, matrix, Fraction(0))


def test_a_form_that_is_not_positive_proves_nothing() -> None:
    # explicit Euler without damping: M^T M = 1 + s^2, so that -|x|^2 falls with each step
    assert not proves_decay(-IDENTITY, step_matrix(lookup("RK1"), Fraction(0), ONE), HALF)
