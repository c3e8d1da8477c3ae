from fractions import Fraction

from bezstab.methods.registry import lookup
from bezstab.methods.step_matrices import step_matrix
from bezstab.step_sequences.growing_sequences import grows

ONE, HALF = Fraction(1), Fraction(1, 2)


def test_a_product_on_the_unit_circle_does_not_decay() -> None:
    # average acceleration without damping keeps the energy, whatever the step
    matrix = step_matrix(lookup("average-acceleration"), Fraction(0), ONE)
    assert grows(matrix, [ONE, HALF])
    # with damping it loses some
    assert not grows(step_matrix(lookup("average-acceleration"), HALF, ONE), [ONE, HALF])
