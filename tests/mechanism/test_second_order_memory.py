"""What schemes carry, and when they evaluate, against what their authors say; starts on a parabola."""

from fractions import Fraction

import pytest

from bezstab.errors import InputError
from bezstab.mechanism.programs import program_of
from bezstab.mechanism.second_order_memory import memory
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.step_equations import Quantity

LEAPFROG = recipe({"w": "w[0] + a0", "x1": "x0 + w", "a1": "acceleration(x1, w)", "v1": "w + 1/2 a1"})
"""The velocity half a step back is what it carries."""

STOERMER = recipe({"x2": "2 x1 - x0 + a1", "v1": "1/2 x2 - 1/2 x0", "a1": "acceleration(x1, v1)"})
"""Central differences: the position is one step ahead of the velocity, so that no run can take it."""


@pytest.mark.parametrize(
    ("name", "moment"),
    [
        *(("stable-pd", 1), ("imex-euler", 0), ("bdf5", 1)),
        ("hht", Fraction(19, 20)),  # 1 + alpha
        ("generalized-alpha", Fraction(5, 9)),  # 1 - rho / (rho + 1)
    ],
)
def test_an_acceleration_is_taken_where_a_steady_motion_is_then(name: str, moment: Fraction) -> None:
    assert list(program_of(lookup(name).scheme.second_order).moments) == [float(moment)]


def test_a_helper_starts_with_what_belongs_to_the_state() -> None:
    ahead = recipe({"y": "y[0] + v1", "x1": "y - 1/2 v1", "v1": "v0 + a0", "a1": "acceleration(x1, v1)"})
    starts = dict(zip(memory(ahead).carried, memory(ahead).shares, strict=True))
    assert starts[Quantity("y", 0)][:2] == (Fraction(1), Fraction(1, 2))


def test_a_scheme_whose_step_ends_with_no_state_is_refused() -> None:
    with pytest.raises(InputError, match="x2: a step that a run can take ends with x1 and v1, none later"):
        memory(STOERMER)
