"""A straight chain of bodies whose links are solved one after another: loops over bodies and links, as engines do it.

Link i ties body i to body i - 1, the first to the world. Unit masses, but for the last; h = 1. No matrices.
"""

from collections.abc import Callable, Sequence
from typing import Any

State = list[Any]
"""Positions, velocities and kept impulses of all bodies and links, one after another: numbers of any kind."""


def error(values: Sequence[Any], link: int) -> Any:
    """Return by how much a link is too long, or grows."""
    return values[link] - (values[link - 1] if link else 0)


def push(values: list[Any], inverse_masses: Sequence[Any], link: int, impulse: Any) -> None:
    """Apply an impulse of a link to the velocities, or positions, of the bodies that it ties."""
    values[link] += inverse_masses[link] * impulse
    if link:
        values[link - 1] -= inverse_masses[link - 1] * impulse


def hard_step(
    bodies: int, ratio: Any, sweeps: int, share: Any, kept: Any = 1, relaxation: Any = 1
) -> Callable[[State], State]:
    """Return a step with a bias in the velocity: warm start, sweeps, move."""
    inverse_masses = [1] * (bodies - 1) + [1 / ratio]

    def step(state: State) -> State:
        x, v, impulses = (state[i * bodies : (i + 1) * bodies] for i in range(3))
        for link in range(bodies):
            impulses[link] = kept * impulses[link]
            push(v, inverse_masses, link, impulses[link])
        for _ in range(sweeps):
            for link in range(bodies):
                inverse = inverse_masses[link] + (inverse_masses[link - 1] if link else 0)
                impulse = -relaxation * (error(v, link) + share * error(x, link)) / inverse
                push(v, inverse_masses, link, impulse)
                impulses[link] += impulse
        return [a + b for a, b in zip(x, v, strict=True)] + v + impulses

    return step


def soft_step(bodies: int, ratio: Any, bias: float, mass_scale: float, relaxing: int = 1) -> Callable[[State], State]:
    """Return Box2D 3's substep: warm start, one soft sweep, a move, hard sweeps without bias."""
    inverse_masses = [1] * (bodies - 1) + [1 / ratio]

    def sweep(x: State, v: State, impulses: State, bias: float, mass_scale: float) -> None:
        for link in range(bodies):
            inverse = inverse_masses[link] + (inverse_masses[link - 1] if link else 0)
            impulse = -mass_scale * (error(v, link) + bias * error(x, link)) / inverse
            impulse -= (1 - mass_scale) * impulses[link]
            push(v, inverse_masses, link, impulse)
            impulses[link] += impulse

    def step(state: State) -> State:
        x, v, impulses = (state[i * bodies : (i + 1) * bodies] for i in range(3))
        for link in range(bodies):
            push(v, inverse_masses, link, impulses[link])
        sweep(x, v, impulses, bias, mass_scale)
        x = [a + b for a, b in zip(x, v, strict=True)]
        for _ in range(relaxing):
            sweep(x, v, impulses, 0.0, 1.0)
        return x + v + impulses

    return step


def position_step(bodies: int, ratio: Any, sweeps: int, share: Any, position_sweeps: int) -> Callable[[State], State]:
    """Return the step of Jolt and of Box2D 2: velocities without bias, a move, then positions are pushed."""
    inverse_masses = [1] * (bodies - 1) + [1 / ratio]
    without_bias = hard_step(bodies, ratio, sweeps, 0)

    def step(state: State) -> State:
        state = without_bias(state)
        x = state[:bodies]
        for _ in range(position_sweeps):
            for link in range(bodies):
                inverse = inverse_masses[link] + (inverse_masses[link - 1] if link else 0)
                push(x, inverse_masses, link, -share * error(x, link) / inverse)
        return x + state[bodies:]

    return step


def columns(step: Callable[[State], State], bodies: int, one: Any = 1.0) -> list[State]:
    """Return what becomes of each unit vector: the columns of the step's matrix."""
    count = 3 * bodies
    return [step([one if i == j else 0 * one for i in range(count)]) for j in range(count)]
