"""What schemes carry, and when they evaluate, against what their authors say; starts on a parabola."""

from fractions import Fraction

import pytest

from bezstab.mechanism.second_order_memory import memory
from bezstab.methods import Quantity, SecondOrder, lookup, recipe, second_order_form

HALF, ONE, ZERO = Fraction(1, 2), Fraction(1), Fraction(0)

LEAPFROG = recipe({"w": "w[0] + a0", "x1": "x0 + w", "a1": "acceleration(x1, w)", "v1": "w + 1/2 a1"})
"""The velocity half a step back is what it carries."""

STOERMER = recipe({"x2": "2 x1 - x0 + a1", "v1": "1/2 x2 - 1/2 x0", "a1": "acceleration(x1, v1)"})
"""Central differences: the position is one step ahead of the velocity."""


def form(name: str) -> SecondOrder:
    return second_order_form(lookup(name).scheme)


def carried_names(scheme: SecondOrder) -> set[str]:
    return {str(quantity) for quantity in memory(scheme).carried}


def test_a_scheme_carries_what_the_next_turn_needs() -> None:
    assert carried_names(form("verlet-half")) == {"x0", "v0", "a0"}
    assert carried_names(LEAPFROG) == {"x0", "a0", "w[0]"}  # the old velocity is not used
    assert carried_names(STOERMER) == {"x0", "x1", "a0"}  # a0 is a guess of a1
    assert carried_names(form("bdf3")) == {"x0", "x[-1]", "x[-2]", "v0", "v[-1]", "v[-2]", "a0"}


def test_a_position_that_is_a_step_ahead_needs_a_state_more() -> None:
    assert (memory(STOERMER).newest, memory(STOERMER).past) == (1, 1)


@pytest.mark.parametrize(
    ("name", "moment"),
    [
        *(
            ("verlet-half", 1),
            ("stable-pd", 1),
            ("imex-euler", 0),
            ("SYM", 0),
            ("AB4", 0),
            ("bdf5", 1),
            ("trapezoid", 1),
        ),
        ("hht", Fraction(19, 20)),  # 1 + alpha
        ("generalized-alpha", Fraction(5, 9)),  # 1 - rho / (rho + 1)
    ],
)
def test_an_acceleration_is_taken_where_a_steady_motion_is_then(name: str, moment: Fraction) -> None:
    assert list(memory(form(name)).moments.values()) == [moment]


def test_a_helper_starts_with_what_belongs_to_the_state() -> None:
    remembered = memory(LEAPFROG)
    shares = dict(zip(remembered.carried, remembered.shares, strict=True))
    assert shares[Quantity("w", 0)] == (ZERO, ONE, -HALF)  # v - a / 2: half a step back
    assert shares[Quantity("x", 0)] == (ONE, ZERO, ZERO)
    assert shares[Quantity("a", 0)] == (ZERO, ZERO, ONE)
    ahead = recipe({"y": "y[0] + v1", "x1": "y - 1/2 v1", "v1": "v0 + a0", "a1": "acceleration(x1, v1)"})
    starts = dict(zip(memory(ahead).carried, memory(ahead).shares, strict=True))
    assert starts[Quantity("y", 0)][:2] == (ONE, HALF)  # a position half a step ahead
