"""Chains and arms whose constraints are solved one after another: loops over constraints, as engines do it.

h = 1; numbers of any kind. A matrix is what a step makes of unit vectors.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

State = list[Any]
"""Positions, velocities and kept impulses, one after another."""

Step = Callable[[State], State]


class Constraint(NamedTuple):
    """By how much each coordinate that is off by one opens it, and what sweeps take back of that.

    `share` of velocity sweeps, `of_positions` of those that move positions. `softness` is of its own inverse effective
    mass.
    """

    arms: Mapping[int, Any]
    share: Any = 0
    softness: Any = 0
    of_positions: Any = 0

    def of(self, values: Sequence[Any]) -> Any:
        return sum(arm * values[place] for place, arm in self.arms.items())

    def push(self, values: State, inverse: Sequence[Any], impulse: Any) -> None:
        for place, arm in self.arms.items():
            values[place] += inverse[place] * arm * impulse

    def gives(self, inverse: Sequence[Any]) -> Any:
        """Return how far an impulse of one opens it."""
        return sum(inverse[place] * arm * arm for place, arm in self.arms.items())


def swept_step(
    constraints: Sequence[Constraint],
    inverse: Sequence[Any],
    sweeps: int,
    *,
    kept: Any = 1,
    relaxation: Any = 1,
    relaxing: int = 0,
    positions: int = 0,
    pull: Sequence[Any] | None = None,
) -> Step:
    """Return a step: what pulls, kept impulses, sweeps, a move, hard sweeps without bias, sweeps over positions."""
    count = len(inverse)

    def sweep(x: State, v: State, impulses: State, biased: bool) -> None:
        for number, each in enumerate(constraints):
            gives = each.gives(inverse)
            softness = each.softness * biased
            wanted = each.of(v) + each.share * biased * each.of(x) + softness * gives * impulses[number]
            impulse = -relaxation * wanted / (gives * (1 + softness))
            each.push(v, inverse, impulse)
            impulses[number] += impulse

    def step(state: State) -> State:
        x, v = state[:count], [a + b for a, b in zip(state[count : 2 * count], pull or [0] * count, strict=True)]
        impulses = [kept * each for each in state[2 * count :]]
        for each, impulse in zip(constraints, impulses, strict=True):
            each.push(v, inverse, impulse)
        for _ in range(sweeps):
            sweep(x, v, impulses, True)
        x = [a + b for a, b in zip(x, v, strict=True)]
        for _ in range(relaxing):
            sweep(x, v, impulses, False)
        for _ in range(positions):
            for each in constraints:
                each.push(x, inverse, -each.of_positions * each.of(x) / each.gives(inverse))
        return x + v + impulses

    return step


def inverse_masses(bodies: int, ratio: Any) -> list[Any]:
    """Return those of unit masses, but for the last."""
    return [1] * (bodies - 1) + [1 / ratio]


def links(count: int, *settings: Any) -> list[Constraint]:
    """Return those of a straight chain: link i ties body i to body i - 1, the first to the world."""
    return [Constraint({link: 1, link - 1: -1} if link else {0: 1}, *settings) for link in range(count)]


def hard_step(inverse: Sequence[Any], sweeps: int, share: Any, **settings: Any) -> Step:
    """Return a step with a bias in the velocity: warm start, sweeps, move."""
    return swept_step(links(len(inverse), share), inverse, sweeps, **settings)


def soft_step(inverse: Sequence[Any], bias: float, mass_scale: float, relaxing: int) -> Step:
    """Return Box2D 3's substep: warm start, one soft sweep, a move, hard sweeps without bias."""
    return swept_step(links(len(inverse), bias, 1 / mass_scale - 1), inverse, 1, relaxing=relaxing)


def position_step(inverse: Sequence[Any], sweeps: int, share: Any, position_sweeps: int) -> Step:
    """Return the step of Jolt and of Box2D 2: velocities without bias, a move, then positions are pushed."""
    return swept_step(links(len(inverse), 0, 0, share), inverse, sweeps, positions=position_sweeps)


def columns(step: Step, bodies: int, one: Any = 1.0) -> list[State]:
    """Return what becomes of each unit vector: the columns of the step's matrix."""
    count = 3 * bodies
    return [step([one if i == j else 0 * one for i in range(count)]) for j in range(count)]


def at_rest(step: Step, bodies: int) -> FloatArray:
    """Return the state that a step with what pulls leaves as it is."""
    fallen = np.array(step([0.0] * 3 * bodies))
    matrix = np.array(columns(step, bodies)).T - fallen[:, np.newaxis]
    return np.linalg.solve(np.eye(len(fallen)) - matrix, fallen)


def arm_step(
    masses: Sequence[float],
    sweeps: int,
    share: float,
    motor: tuple[float, float],
    *,
    pull: tuple[float, float] = (0.0, 0.0),
    **settings: Any,
) -> Step:
    """Return a step of rods of length 2 that bend: each is held at its near end by a pin, then by a motor on the angle.

    Positions are the heights of their middles, then their angles. Pins take back a share of their error; position
    sweeps move them all the way. A `motor` has a share and a softness. `pull`: an acceleration of all rods across their
    line, and a force on the far end of the last one.
    """
    count = len(masses)
    constraints = []
    for rod in range(count):
        gap, bend = {rod: 1, count + rod: -1}, {count + rod: 1}
        if rod:
            gap |= {rod - 1: -1, count + rod - 1: -1}
            bend |= {count + rod - 1: -1}
        constraints += [Constraint(gap, share, 0, 1), Constraint(bend, *motor)]
    inverse = [*(1 / mass for mass in masses), *(3 / mass for mass in masses)]
    pulls = [pull[0]] * count + [0.0] * count
    for place in (count - 1, -1):
        pulls[place] += pull[1] * inverse[place]
    return swept_step(constraints, inverse, sweeps, pull=pulls, **settings)
