from fractions import Fraction

import numpy as np
import pytest

from bezstab.methods import lookup, step_matrix
from bezstab.stability.growing_sequences import growing_words, grows, growth_of

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


def test_growth_is_that_of_a_run() -> None:
    # theory: alpha = 2, beta = 100 at 1/60 s, here step by step: v' = v - (alpha_hat v + beta_hat c), c' = c + v'
    longest, short = 1 / 60, 0.00917
    c, v, before = 1.0, 0.0, 1.0
    for _ in range(60):
        before = abs(c) + abs(v)
        for h in (longest, short):
            v -= h * (4 * v + 100**2 * c)
            c += h * v
    matrix = step_matrix(lookup("SYM"), Fraction(4, 60), Fraction(100, 60) ** 2)
    word = [ONE, Fraction(short) * 60]
    # after 60 rounds the lesser pole is gone: their product is that of determinants, 0.6 a round
    assert growth_of(matrix, word) == pytest.approx((abs(c) + abs(v)) / before, rel=1e-9)
