"""What a second-order scheme carries from step to step and how it starts.

A turn of its equations gives x1, v1, accelerations and helpers at their latest steps. What the next turn needs of them,
one step further back, is carried. All of it is read off the three exact motions of the scheme: a helper that starts has
the value that belongs to the state there, that of the motion at rest times x, and so on.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cache

from bezstab.errors import InputError
from bezstab.methods.scheme_motions import ACCELERATED, AT_REST, STEADY, Motions, exact_motions, value_at_start
from bezstab.methods.second_order import SecondOrder
from bezstab.methods.step_equations import Assignment, Evaluation, Quantity

POSITION, VELOCITY, ACCELERATION = "x", "v", "a"
Equation = Assignment | Evaluation
STATE = (POSITION, VELOCITY, ACCELERATION)

Shares = tuple[Fraction, Fraction, Fraction]
"""Of x, v and a (h = 1): a value as the sum of these shares of them."""


@dataclass(frozen=True)
class Memory:
    """What a scheme carries from turn to turn.

    `carried` names the quantities by their step as a turn begins, each name's oldest first; the newest state has step 0
    then. `shares` say what a carried quantity starts with, in terms of the state at step `state_steps`, in the same
    order.
    """

    carried: tuple[Quantity, ...]
    shares: tuple[Shares, ...]
    state_steps: tuple[int, ...]


@cache
def memory(scheme: SecondOrder) -> Memory:
    """Return what the scheme carries. InputError where its turn ends with no state."""
    carried = tuple(_carried(scheme))
    for equation in scheme.equations:
        if equation.result.name in (POSITION, VELOCITY) and equation.result.step > 1:
            raise InputError(f"{equation.result}: a step that a run can take ends with x1 and v1, none later")
    motions = exact_motions(scheme)
    # a quantity starts from the state of its own step, where the history of the scheme has it
    state_steps = tuple(max(min(quantity.step, 0), scheme.oldest) for quantity in carried)
    shares = (
        _shares(motions, quantity, quantity.step - state_step)
        for quantity, state_step in zip(carried, state_steps, strict=True)
    )
    return Memory(carried, tuple(shares), state_steps)


def _carried(scheme: SecondOrder) -> list[Quantity]:
    """Return what a turn needs and does not give, or reports, or takes as a guess of what it has to solve for."""
    latest = {equation.result.name: equation.result.step for equation in scheme.equations}
    needed = [quantity for equation in scheme.equations for quantity in equation.used]
    needed += [Quantity(POSITION, 1), Quantity(VELOCITY, 1)]  # which are reported
    for group in scheme.groups:
        if is_solved_together(group):
            found = (equation.result for equation in group if isinstance(equation, Evaluation))
            needed += [Quantity(result.name, result.step - 1) for result in found]
    earliest: dict[str, int] = {}
    for quantity in needed:
        earliest[quantity.name] = min(quantity.step, earliest.get(quantity.name, quantity.step))
    return [Quantity(name, step) for name in earliest for step in range(earliest[name], latest[name])]


def is_solved_together(group: tuple[Equation, ...]) -> bool:
    """Return whether the equations of a group wait for each other, or one for itself."""
    return len(group) > 1 or group[0].result in group[0].used


def _shares(motions: Motions, quantity: Quantity, steps_later: int) -> Shares:
    """Return the shares of x, v and a that a quantity so many steps after them starts with."""
    if quantity.name in STATE and steps_later == 0:
        at_rest, steady, accelerated = (Fraction(int(quantity.name == name)) for name in STATE)
        return at_rest, steady, accelerated
    here = ((Fraction(1), Quantity(quantity.name, steps_later)),)
    at_rest, steady, accelerated = (value_at_start(motions, here, motion) for motion in (AT_REST, STEADY, ACCELERATED))
    return at_rest, steady, accelerated
