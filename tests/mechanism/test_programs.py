"""Methods as programs: rows over registers, as one writes them by hand."""

from fractions import Fraction

import pytest

from bezstab.mechanism.programs import Evaluation, Program, program_of
from bezstab.mechanism.second_order_memory import memory
from bezstab.methods import lookup, second_order_form

HALF, ONE, NONE = Fraction(1, 2), Fraction(1), Fraction(0)


def program(name: str) -> Program:
    """Return the program of a built-in method."""
    return program_of(second_order_form(lookup(name).scheme))


def test_velocity_verlet_is_the_program_of_the_books() -> None:
    """Registers x0, v0, a0 | a1 | x1, v1; the velocity of the feedback is that at the half step."""
    assert program("verlet-half") == Program(
        powers=(0, 1, 2),
        evaluations=(Evaluation((ONE, ONE, HALF, NONE), (NONE, ONE, HALF, NONE), ONE, guess=0),),
        groups=((0, 1, False),),
        combined=((ONE, ONE, HALF, NONE), (NONE, ONE, HALF, HALF)),
        moves=((4, 0), (5, 1), (3, 2)),
        state=(4, 5),
        corrected=((ONE, NONE), (NONE, ONE), (NONE, NONE)),
    )


def test_a_projection_changes_what_is_carried_of_the_newest_state_and_nothing_older() -> None:
    names = [str(quantity) for quantity in memory(second_order_form(lookup("bdf2").scheme)).carried]
    shares = dict(zip(names, program("bdf2").corrected, strict=True))
    assert {name for name, of_it in shares.items() if any(of_it)} == {"x0", "v0"}
    assert {"x[-1]", "v[-1]"} <= set(shares)


@pytest.mark.parametrize(("name", "together"), [("gauss4", [2]), ("sdirk2", [1, 1]), ("bdf3", [1]), ("yoshida4", [])])
def test_stages_that_wait_for_each_other_are_solved_together(name: str, together: list[int]) -> None:
    assert [last - first for first, last, waiting in program(name).groups if waiting] == together
