"""Newton's method on equations with known roots: its Jacobian, its count, its end, and batches that fail in part."""

import math
from collections.abc import Sequence
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from bezstab.mechanism.newton_iterations import (
    MOST_ITERATIONS,
    NotConvergedError,
    Residual,
    Work,
    multiply,
    newton_solution,
    newton_solutions,
    no_inverse,
    rounding_of,
    total_size,
)

TOLERANCE = 1e-13


def circle_and_line(_: Any, known: Sequence[Any], unknown: Sequence[Any], values: Any) -> float:
    """Write what x^2 + y^2 = known^2 and x = y leave over, its solution known / sqrt(2) twice."""
    x, y = unknown
    values[0], values[1] = x * x + y * y - known[0] * known[0], x - y
    return 1.0


def slope_of_circle_and_line(_: Any, __: Any, unknown: Sequence[Any], direction: Sequence[Any], values: Any) -> None:
    """Write how that changes along a direction."""
    (x, y), (by_x, by_y) = unknown, direction
    values[0], values[1] = 2 * x * by_x + 2 * y * by_y, by_x - by_y


RESIDUAL = Residual(circle_and_line, slope_of_circle_and_line, evaluations=1)


def solved(
    residual: Residual,
    known: Sequence[Any],
    guess: Sequence[Any],
    inverse: list[Any] | None = None,
    tolerance: Any = TOLERANCE,
    work: Work | None = None,
) -> list[Any]:
    """Return the unknowns."""
    sought = list(guess)
    kept = no_inverse(len(sought)) if inverse is None else inverse
    pivot = newton_solution(residual, (0.0,), known, sought, kept, tolerance, (work or Work()).counts)
    assert pivot == 1.0
    return sought


def test_the_root_is_found_and_counted() -> None:
    work = Work()
    found = solved(RESIDUAL, (2.0,), (1.0, 1.5), work=work)
    assert found == pytest.approx([math.sqrt(2), math.sqrt(2)], rel=1e-14)
    assert 4 <= work.iterations <= 11
    jacobians = (work.evaluations - work.iterations) / 2  # two unknowns, an evaluation each
    assert jacobians in range(1, work.iterations + 1)


def test_a_linear_equation_takes_one_correction_one_to_see_it_and_one_more() -> None:
    def line(_: Any, known: Sequence[Any], unknown: Sequence[Any], values: Any) -> float:
        values[0] = 3.0 * unknown[0] - known[0]
        return 1.0

    def slope(_: Any, __: Any, ___: Any, direction: Sequence[Any], values: Any) -> None:
        values[0] = 3.0 * direction[0]

    work = Work()
    assert solved(Residual(line, slope, 1), (6.0,), (1e3,), work=work) == [2.0]
    assert (work.iterations, work.evaluations) == (3, 4)


def test_more_digits_take_more_iterations_to_their_own_rounding() -> None:
    with mp.workdps(30):
        found = solved(RESIDUAL, (mp.mpf(2),), (mp.mpf(1), mp.mpf(1.5)), tolerance=500 * rounding_of(mp))
        assert abs(found[0] - mp.sqrt(2)) < mp.mpf(10) ** -28


def test_what_has_no_root_does_not_converge() -> None:
    def no_root(_: Any, __: Any, unknown: Sequence[Any], values: Any) -> float:
        values[0] = unknown[0] * unknown[0] + 1.0
        return 1.0

    def slope(_: Any, __: Any, unknown: Sequence[Any], direction: Sequence[Any], values: Any) -> None:
        values[0] = 2 * unknown[0] * direction[0]

    with pytest.raises(NotConvergedError, match=rf"did not converge in {MOST_ITERATIONS} iterations \(last correction"):
        solved(Residual(no_root, slope, 1), (), (0.3,))


def test_what_leaves_the_numbers_does_not_converge() -> None:
    with pytest.raises(NotConvergedError, match="not finite"):
        solved(RESIDUAL, (math.nan,), (1.0, 1.5))


def test_a_batch_converges_point_by_point_and_fails_point_by_point() -> None:
    radius = np.array([[2.0, 4.0, np.nan], [30.0, np.inf, 0.1]])
    with np.errstate(all="ignore"):
        (x, y), pivot, _ = newton_solutions(
            RESIDUAL,
            (0.0,),
            (radius,),
            (np.array([1.0, 1.0, 1.0]), 1.5),
            None,
            TOLERANCE,
        )
    expected = radius / math.sqrt(2)
    good = np.isfinite(radius)
    assert x[good] == pytest.approx(expected[good], rel=1e-12)
    assert y[good] == pytest.approx(expected[good], rel=1e-12)
    assert np.isnan(x[~good]).all()
    assert np.isnan(y[~good]).all()
    assert pivot.shape == radius.shape


def test_each_library_has_its_rounding() -> None:
    assert rounding_of(math) == rounding_of(np) == 2.0**-52
    with mp.workdps(50):
        assert rounding_of(mp) < 1e-49


def test_a_jacobian_is_kept_as_long_as_it_serves() -> None:
    first, later, far, inverse = Work(), Work(), Work(), no_inverse(2)
    found = solved(RESIDUAL, (2.0,), (1.4, 1.4), inverse, work=first)
    found = solved(RESIDUAL, (2.01,), found, inverse, work=later)
    assert found == pytest.approx([2.01 / math.sqrt(2)] * 2, rel=1e-14)
    assert later.evaluations == later.iterations  # nothing but residuals
    found = solved(RESIDUAL, (20.0,), found, inverse, work=far)
    assert found == pytest.approx([20 / math.sqrt(2)] * 2, rel=1e-14)
    assert far.evaluations > far.iterations


def test_sums_are_taken_in_their_order_on_every_version_of_python() -> None:
    """From 3.12 on `sum` keeps what floats lose, which machine code does not."""
    assert total_size([1.0, -1e-16, 1e-16]) == 1.0
    rows = [0.0, 0.0]
    multiply([1.0, 1e-16, 2.0, 3.0], [1.0, 1.0], rows)
    assert rows == [1.0, 5.0]


def test_a_batch_has_the_bits_of_its_points_alone() -> None:
    """With the Jacobian of before, and without."""
    radius = np.geomspace(0.1, 30.0, 12)
    together: Any = (np.full(12, 1.0), np.full(12, 1.5))
    inverse: Any = None
    alone: Any = [[1.0, 1.5] for _ in radius]
    inverses = [no_inverse(2) for _ in radius]
    for factor in (1.0, 1.001, 5.0):
        for point, r in enumerate((factor * radius).tolist()):
            alone[point] = solved(RESIDUAL, (r,), alone[point], inverses[point])
        together, _, inverse = newton_solutions(RESIDUAL, (0.0,), (factor * radius,), together, inverse, TOLERANCE)
        np.testing.assert_array_equal(together, np.array(alone).T)
        np.testing.assert_array_equal(inverse, np.array(inverses).T)
