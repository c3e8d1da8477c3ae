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
    complex_library,
    newton_solution,
    newton_solutions,
    rounding_of,
)

TOLERANCE = 1e-13


def circle_and_line(_: Any, known: Sequence[Any], unknown: Sequence[Any]) -> tuple[Any, ...]:
    """Return what x^2 + y^2 = known^2 and x = y leave over, its solution known / sqrt(2) twice."""
    x, y = unknown
    return x * x + y * y - known[0] * known[0], x - y


RESIDUAL = Residual(lambda *entries: (circle_and_line(*entries), 1.0), circle_and_line, evaluations=1)


def test_the_root_is_found_and_counted() -> None:
    work = Work()
    found, pivot, _ = newton_solution(RESIDUAL, (0.0,), (2.0,), (1.0, 1.5), None, TOLERANCE, work)
    assert found == pytest.approx([math.sqrt(2), math.sqrt(2)], rel=1e-14)
    assert pivot == 1.0
    assert 4 <= work.iterations <= 11
    jacobians = (work.evaluations - work.iterations) / 2  # two unknowns, an evaluation each
    assert jacobians in range(1, work.iterations + 1)


def test_a_linear_equation_takes_one_correction_one_to_see_it_and_one_more() -> None:
    def line(_: Any, known: Sequence[Any], unknown: Sequence[Any]) -> tuple[Any, ...]:
        return (3.0 * unknown[0] - known[0],)

    work = Work()
    found, _, _ = newton_solution(
        Residual(lambda *entries: (line(*entries), 0.5), line, 1), (0.0,), (6.0,), (1e3,), None, TOLERANCE, work
    )
    assert found == (2.0,)
    assert (work.iterations, work.evaluations) == (3, 4)


def test_more_digits_take_more_iterations_to_their_own_rounding() -> None:
    with mp.workdps(30):
        found, _, _ = newton_solution(
            RESIDUAL, (0,), (mp.mpf(2),), (mp.mpf(1), mp.mpf(1.5)), None, 500 * rounding_of(mp), Work()
        )
        assert abs(found[0] - mp.sqrt(2)) < mp.mpf(10) ** -28


def test_what_has_no_root_does_not_converge() -> None:
    def no_root(_: Any, __: Any, unknown: Sequence[Any]) -> tuple[Any, ...]:
        return (unknown[0] * unknown[0] + 1.0,)

    residual = Residual(lambda *entries: (no_root(*entries), 1.0), no_root, 1)
    with pytest.raises(NotConvergedError, match=rf"did not converge in {MOST_ITERATIONS} iterations \(last correction"):
        newton_solution(residual, (0.0,), (), (0.3,), None, TOLERANCE, Work())


def test_what_leaves_the_numbers_does_not_converge() -> None:
    with pytest.raises(NotConvergedError, match="not finite"):
        newton_solution(RESIDUAL, (0.0,), (math.nan,), (1.0, 1.5), None, TOLERANCE, Work())


def test_a_batch_converges_point_by_point_and_fails_point_by_point() -> None:
    radius = np.array([[2.0, 4.0, np.nan], [30.0, np.inf, 0.1]])
    with np.errstate(all="ignore"):
        (x, y), pivot, _ = newton_solutions(
            Residual(lambda *entries: (circle_and_line(*entries), np.ones(entries[2][0].shape)), circle_and_line, 1),
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


def test_each_library_has_its_complex_one_and_its_rounding() -> None:
    assert complex_library(math).sqrt(-1) == 1j
    assert complex_library(np) is np
    assert rounding_of(math) == rounding_of(np) == 2.0**-52
    with mp.workdps(50):
        assert rounding_of(mp) < 1e-49


def test_a_jacobian_is_kept_as_long_as_it_serves() -> None:
    first, later, far = Work(), Work(), Work()
    found, _, inverse = newton_solution(RESIDUAL, (0.0,), (2.0,), (1.4, 1.4), None, TOLERANCE, first)
    found, _, inverse = newton_solution(RESIDUAL, (0.0,), (2.01,), found, inverse, TOLERANCE, later)
    assert found == pytest.approx([2.01 / math.sqrt(2)] * 2, rel=1e-14)
    assert later.evaluations == later.iterations  # nothing but residuals
    found, _, _ = newton_solution(RESIDUAL, (0.0,), (20.0,), found, inverse, TOLERANCE, far)
    assert found == pytest.approx([20 / math.sqrt(2)] * 2, rel=1e-14)
    assert far.evaluations > far.iterations
