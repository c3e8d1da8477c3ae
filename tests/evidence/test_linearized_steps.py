"""A linearised step against differences of the step itself."""

import numpy as np
import pytest

from bezstab.evidence.linearized_steps import Changes, Course, course_of_steps, on_the_motion, take_step_itself
from bezstab.methods import Quantity, lookup
from bezstab.stability import FloatArray
from bezstab.units import feedback_gains
from tests.evidence.driven_four_bar import four_bar

STEPS = 100


def course_of(name: str) -> tuple[Course, FloatArray]:
    """Return a course over the four-bar's revolution, and the gains of one point, shape (2, 1)."""
    course = course_of_steps(four_bar(), lookup(name), 1 / STEPS, 1.0)
    return course, np.array(feedback_gains(np.array([0.3]), np.array([0.1]), course.step))


def step_from(course: Course, gains: FloatArray, carried: FloatArray) -> FloatArray:
    """Return what the method itself makes of what its first step starts with, shape (rows,)."""
    names = course.memory.carried
    values = dict(zip(names, np.split(carried[np.newaxis], len(names), axis=1), strict=True))
    take_step_itself(course, gains, 0, values)
    return np.concatenate([values[Quantity(each.name, each.step + 1)][0] for each in names])


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "ABM3", "verlet-half"])
def test_a_step_changes_as_the_difference_of_two_steps(name: str) -> None:
    """From the motion of the mechanism, by 1e-5 up and down: quadratic terms cancel, cubic ones are about 1e-10."""
    course, gains = course_of(name)
    start = np.concatenate(list(on_the_motion(course, 0).values()), axis=1)[0]
    direction = np.random.default_rng(0).standard_normal(start.size)
    up, down = (step_from(course, gains, start + sign * 1e-5 * direction) for sign in (1, -1))
    changes = Changes(course, gains, direction[np.newaxis, :, np.newaxis], 0)
    changes.take_step()
    assert changes.carried()[0, :, 0] == pytest.approx((up - down) / 2e-5, abs=1e-7)


@pytest.mark.parametrize("name", ["B4", "SYM", "ABM3", "RK4"])
def test_jacobians_that_all_points_share_are_those_of_each(name: str) -> None:
    """At states, in predicted ones and in second stages; the motion is known to some 1e-12."""
    course, gains = course_of(name)
    start = np.eye(course.rows)[np.newaxis]
    shared = Changes(course, gains, start, 0)
    own = Changes(course, gains, start, 0, lambda k: take_step_itself(course, gains, k, on_the_motion(course, k)))
    for _ in range(3):
        shared.take_step()
        own.take_step()
    assert own.carried() == pytest.approx(shared.carried(), rel=1e-11, abs=1e-11)


def test_gains_move_the_third_stage_of_a_runge_kutta_method_and_nothing_before() -> None:
    found = {name: len(course_of(name)[0].jacobians) for name in ("B4", "ABM3", "RK2", "RK4")}
    assert found == {"B4": 1, "ABM3": 2, "RK2": 2, "RK4": 2}


def test_after_a_revolution_the_motion_is_where_it_was_but_for_a_turn() -> None:
    """The motion is known to 1e-11 of a turn."""
    course, _ = course_of("B4")
    after, before = (on_the_motion(course, k) for k in (STEPS, 0))
    for quantity in course.memory.carried:
        moved = after[quantity] - before[quantity]
        if quantity.name == "x":
            assert moved[0, 0] == pytest.approx(2 * np.pi, abs=1e-10)
            moved = moved[:, 1:]
        assert np.abs(moved).max() < 1e-10


@pytest.mark.parametrize("name", ["trapezoid", "bdf2", "implicit-midpoint"])
def test_a_step_of_an_implicit_method_ends_on_the_motion_but_for_its_local_error(name: str) -> None:
    """Of order three for methods of order two, and h v, which the step carries, is a displacement: of order four."""

    def missed(steps: int) -> float:
        course = course_of_steps(four_bar(), lookup(name), 1 / steps, 1.0)
        gains = np.array(feedback_gains(np.array([0.3]), np.array([0.1]), course.step))
        values = on_the_motion(course, 3)
        take_step_itself(course, gains, 3, values)
        velocity = Quantity("v", 0)
        return float(np.abs(values[Quantity("v", 1)] - on_the_motion(course, 4)[velocity]).max())

    assert np.log2(missed(200) / missed(400)) == pytest.approx(4, abs=0.2)
