"""Linearised steps against differences of the steps themselves."""

import numpy as np
import pytest

from bezstab.evidence.floquet import columns_of, gains_on
from bezstab.evidence.linearized_steps import (
    Course,
    Values,
    course_of_steps,
    linearized_step,
    on_the_motion,
    take_steps,
)
from bezstab.methods import Quantity, lookup
from bezstab.stability import FloatArray
from tests.evidence.driven_four_bar import four_bar

STEPS = 100


def course_of(name: str, steps: int = STEPS) -> tuple[Course, FloatArray]:
    """Return a course over the four-bar's revolution, and the gains of one point, shape (2, 1)."""
    course = course_of_steps(four_bar(), lookup(name), 1 / steps, 1.0)
    return course, gains_on(course, lookup(name), np.array([0.3]), np.array([0.1]))


def at_one_point(values: Values) -> Values:
    return {quantity: value[:, np.newaxis] for quantity, value in values.items()}


@pytest.mark.parametrize(
    "name", ["B4", "RK4", "SYM", "ABM3", "verlet-half", "trapezoid", "bdf3", "hht", "gauss4", "radau5"]
)
def test_a_step_changes_as_the_difference_of_two_steps(name: str) -> None:
    """From the motion of the mechanism, by 1e-5 up and down: quadratic terms cancel, cubic ones are about 1e-10."""
    course, gains = course_of(name)
    start = at_one_point(on_the_motion(course))
    direction = np.random.default_rng(0).standard_normal((1, course.rows, 1))
    directions = columns_of(course, direction)
    up, down = (
        take_steps(course, gains, {each: start[each] + sign * 1e-5 * directions[each][..., 0] for each in start})[0]
        for sign in (1, -1)
    )
    _, answers = take_steps(course, gains, start)
    for k in (0, 7, STEPS - 1):
        changes = linearized_step(course, [answer[k] for answer in answers], directions)
        for quantity, change in changes.items():
            later = Quantity(quantity.name, quantity.step + 1)
            assert change[0, :, 0] == pytest.approx((up[later] - down[later])[k, 0] / 2e-5, abs=1e-7)


def test_a_step_before_the_revolution_is_its_last_but_for_a_turn() -> None:
    """The crank has turned by 2 pi, nothing else has moved; the motion is known to 1e-11 of a turn."""
    start = on_the_motion(course_of("bdf2")[0])
    moved = start[Quantity("x", 0)][-1] - start[Quantity("x", -1)][0]
    assert moved[0] == pytest.approx(2 * np.pi, abs=1e-10)
    assert np.abs(moved[1:]).max() < 1e-10


@pytest.mark.parametrize("name", ["trapezoid", "bdf2", "implicit-midpoint"])
def test_a_step_of_an_implicit_method_ends_on_the_motion_but_for_its_local_error(name: str) -> None:
    """Of order three for methods of order two, and h v, which the step carries, is a displacement: of order four."""

    def missed(steps: int) -> float:
        course, gains = course_of(name, steps)
        start = on_the_motion(course)
        after, _ = take_steps(course, gains, at_one_point(start), places_on_it=True)
        return float(np.abs(after[Quantity("v", 1)][3, 0] - start[Quantity("v", 0)][4]).max())

    assert np.log2(missed(200) / missed(400)) == pytest.approx(4, abs=0.2)
