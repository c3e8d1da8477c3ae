"""Methods as programs: rows over registers, what a projection changes, and what is solved together."""

import pytest

from bezstab.mechanism.programs import Program, program_of
from bezstab.mechanism.second_order_memory import memory
from bezstab.methods.registry import lookup


def program(name: str) -> Program:
    """Return the program of a built-in method."""
    return program_of(lookup(name).scheme.second_order)


def test_a_projection_changes_what_is_carried_of_the_newest_state_and_nothing_older() -> None:
    names = [str(quantity) for quantity in memory(lookup("bdf2").scheme.second_order).carried]
    shares = dict(zip(names, program("bdf2").corrected, strict=True))
    assert {name for name, of_it in shares.items() if any(of_it)} == {"x0", "v0"}
    assert {"x[-1]", "v[-1]"} <= set(shares)


@pytest.mark.parametrize(("name", "together"), [("gauss4", [2]), ("sdirk2", [1, 1]), ("bdf3", [1]), ("yoshida4", [])])
def test_stages_that_wait_for_each_other_are_solved_together(name: str, together: list[int]) -> None:
    assert [last - first for first, last, waiting in program(name).groups if waiting] == together
