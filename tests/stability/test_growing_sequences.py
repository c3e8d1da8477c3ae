from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import lookup, step_matrix
from bezstab.stability.growing_sequences import growing_words, grows

ONE, HALF = Fraction(1), Fraction(1, 2)


@pytest.mark.promise("Steps that vary, refuted")
def test_a_product_on_the_unit_circle_does_not_decay() -> None:
    # average acceleration without damping keeps the energy, whatever the step
    matrix = step_matrix(lookup("average-acceleration"), Fraction(0), ONE)
    assert grows(matrix, [ONE, HALF])
    # with damping it loses some
    assert not grows(step_matrix(lookup("average-acceleration"), HALF, ONE), [ONE, HALF])


def test_a_product_that_grows_by_less_than_a_percent_is_found() -> None:
    matrix = step_matrix(lookup("SYM"), Fraction(4, 60), Fraction(100, 60) ** 2)
    shortest = Fraction(179, 200)
    word = next(growing_words(matrix, shortest))
    assert grows(matrix, word)
    product = np.eye(2)
    for length in word:
        product = np.array(matrix.at(length), float) @ product
    assert 1 < np.abs(np.linalg.eigvals(product)).max() < 1.01
