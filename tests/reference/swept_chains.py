"""A straight chain of bodies whose links are solved one after another: loops over bodies and links, as engines do it.

Link i ties body i to body i - 1, the first to the world. h = 1; numbers of any kind. No matrices.
"""

from collections.abc import Callable, Sequence
from typing import Any

State = list[Any]
"""Positions, velocities and kept impulses of all bodies and links, one after another."""


def inverse_masses(bodies: int, ratio: Any) -> list[Any]:
    """Return those of unit masses, but for the last."""
    return [1] * (bodies - 1) + [1 / ratio]


def error(values: Sequence[Any], link: int) -> Any:
    """Return by how much a link is too long, or grows."""
    return values[link] - (values[link - 1] if link else 0)


def push(values: list[Any], inverse: Sequence[Any], link: int, impulse: Any) -> None:
    """Apply an impulse of a link to the velocities, or positions, of the bodies that it ties."""
    values[link] += inverse[link] * impulse
    if link:
        values[link - 1] -= inverse[link - 1] * impulse


def sweep(
    x: State, v: State, impulses: State, inverse: Sequence[Any], bias: Any = 0, mass_scale: Any = 1, relaxation: Any = 1
) -> None:
    """Solve each link for its own rate: hard, or soft with a mass scale below 1."""
    for link in range(len(inverse)):
        both = inverse[link] + (inverse[link - 1] if link else 0)
        hard = mass_scale * (error(v, link) + bias * error(x, link)) / both
        impulse = -relaxation * (hard + (1 - mass_scale) * impulses[link])
        push(v, inverse, link, impulse)
        impulses[link] += impulse


def begun(state: State, inverse: Sequence[Any], kept: Any = 1) -> tuple[State, State, State]:
    """Return positions, velocities and impulses once what is kept of the impulses is applied."""
    x, v, impulses = (state[i * len(inverse) : (i + 1) * len(inverse)] for i in range(3))
    impulses = [kept * each for each in impulses]
    for link, impulse in enumerate(impulses):
        push(v, inverse, link, impulse)
    return x, v, impulses


def moved(x: State, v: State) -> State:
    return [a + b for a, b in zip(x, v, strict=True)]


def hard_step(
    inverse: Sequence[Any], sweeps: int, share: Any, kept: Any = 1, relaxation: Any = 1
) -> Callable[[State], State]:
    """Return a step with a bias in the velocity: warm start, sweeps, move."""

    def step(state: State) -> State:
        x, v, impulses = begun(state, inverse, kept)
        for _ in range(sweeps):
            sweep(x, v, impulses, inverse, share, relaxation=relaxation)
        return moved(x, v) + v + impulses

    return step


def soft_step(inverse: Sequence[Any], bias: float, mass_scale: float, relaxing: int) -> Callable[[State], State]:
    """Return Box2D 3's substep: warm start, one soft sweep, a move, hard sweeps without bias."""

    def step(state: State) -> State:
        x, v, impulses = begun(state, inverse)
        sweep(x, v, impulses, inverse, bias, mass_scale)
        x = moved(x, v)
        for _ in range(relaxing):
            sweep(x, v, impulses, inverse)
        return x + v + impulses

    return step


def position_step(inverse: Sequence[Any], sweeps: int, share: Any, position_sweeps: int) -> Callable[[State], State]:
    """Return the step of Jolt and of Box2D 2: velocities without bias, a move, then positions are pushed."""
    without_bias = hard_step(inverse, sweeps, 0)

    def step(state: State) -> State:
        state = without_bias(state)
        x = state[: len(inverse)]
        for _ in range(position_sweeps):
            for link in range(len(inverse)):
                both = inverse[link] + (inverse[link - 1] if link else 0)
                push(x, inverse, link, -share * error(x, link) / both)
        return x + state[len(inverse) :]

    return step


def columns(step: Callable[[State], State], bodies: int, one: Any = 1.0) -> list[State]:
    """Return what becomes of each unit vector: the columns of the step's matrix."""
    count = 3 * bodies
    return [step([one if i == j else 0 * one for i in range(count)]) for j in range(count)]
