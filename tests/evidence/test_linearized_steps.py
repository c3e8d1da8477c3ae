"""Linearised steps against differences of the steps themselves."""

import numpy as np
import pytest

from bezstab.evidence.floquet import columns_of, gains_on
from bezstab.evidence.linearized_steps import course_of_steps, linearized_step, on_the_motion, take_steps
from bezstab.methods import Quantity, lookup
from tests.evidence.driven_four_bar import four_bar

STEPS = 100


@pytest.mark.parametrize("name", ["B4", "RK4", "SYM", "ABM3", "verlet-half", "trapezoid", "bdf3", "hht", "radau5"])
def test_a_step_changes_as_the_difference_of_two_steps(name: str) -> None:
    """From the motion of the mechanism, by 1e-5 up and down: quadratic terms cancel, cubic ones are about 1e-10."""
    course = course_of_steps(four_bar(), lookup(name), 1 / STEPS, 1.0)
    gains = gains_on(course, lookup(name), np.array([0.3]), np.array([0.1]))
    start = {quantity: value[:, np.newaxis] for quantity, value in on_the_motion(course).items()}
    directions = columns_of(course, np.random.default_rng(0).standard_normal((1, course.rows, 1)))
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
    start = on_the_motion(course_of_steps(four_bar(), lookup("bdf2"), 1 / STEPS, 1.0))
    moved = start[Quantity("x", 0)][-1] - start[Quantity("x", -1)][0]
    assert moved == pytest.approx([2 * np.pi, *np.zeros(len(moved) - 1)], abs=1e-10)
