"""A straight chain of bodies whose links are solved one after another: loops over bodies and links, as engines do it.

Link i ties body i to body i - 1, the first to the world. h = 1; numbers of any kind. No matrices.
"""

from cmath import rect
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


def arm_step(
    masses: Sequence[float],
    sweeps: int,
    share: float,
    motor: tuple[float, float],
    *,
    length: float = 2.0,
    pull: tuple[float, float] = (0.0, 0.0),
    kept: float = 1.0,
    relaxation: float = 1.0,
    positions: int = 0,
) -> Callable[[State], State]:
    """Return a step of rods that bend: each is held at its near end by a pin and then by a motor on the angle there.

    A state is the heights of their middles, their angles, both rates and the impulses of pins and of motors. Pins take
    back a share of their error; with `positions` so many sweeps move them after the step, all the way. A `motor` has a
    share and a softness, of its own inverse effective mass. `pull`: an acceleration of all rods across their line, and
    a force on the far end of the last one.
    """
    count = len(masses)
    inertias = [mass * length**2 / 12 for mass in masses]

    def gap(y: State, angle: State, rod: int) -> float:
        far_end = y[rod - 1] + length / 2 * angle[rod - 1] if rod else 0.0
        return float(y[rod] - length / 2 * angle[rod] - far_end)

    def bend(angle: State, rod: int) -> float:
        return float(angle[rod] - (angle[rod - 1] if rod else 0.0))

    def push(y: State, angle: State, rod: int, force: float, torque: float) -> None:
        y[rod] += force / masses[rod]
        angle[rod] += (torque - length / 2 * force) / inertias[rod]
        if rod:
            y[rod - 1] -= force / masses[rod - 1]
            angle[rod - 1] -= (torque + length / 2 * force) / inertias[rod - 1]

    def gives(rod: int, force: float, torque: float) -> float:
        """Return how far a force or a torque of one at a joint opens it."""
        y, angle = [0.0] * count, [0.0] * count
        push(y, angle, rod, force, torque)
        return gap(y, angle, rod) if force else bend(angle, rod)

    def step(state: State) -> State:
        y, angle, v, turn, forces, torques = (state[i * count : (i + 1) * count] for i in range(6))
        v = [each + pull[0] for each in v]
        v[-1] += pull[1] / masses[-1]
        turn[-1] += pull[1] * length / 2 / inertias[-1]
        forces, torques = [kept * each for each in forces], [kept * each for each in torques]
        for rod in range(count):
            push(v, turn, rod, forces[rod], torques[rod])
        for _ in range(sweeps):
            for rod in range(count):
                force = -relaxation * (gap(v, turn, rod) + share * gap(y, angle, rod)) / gives(rod, 1, 0)
                push(v, turn, rod, force, 0.0)
                forces[rod] += force
                softness = motor[1] * gives(rod, 0, 1)
                wanted = bend(turn, rod) + motor[0] * bend(angle, rod) + softness * torques[rod]
                torque = -relaxation * wanted / (gives(rod, 0, 1) + softness)
                push(v, turn, rod, 0.0, torque)
                torques[rod] += torque
        y, angle = moved(y, v), moved(angle, turn)
        for _ in range(positions):
            for rod in range(count):
                push(y, angle, rod, -gap(y, angle, rod) / gives(rod, 1, 0), 0.0)
        return y + angle + v + turn + forces + torques

    return step


def hanging_errors(
    masses: Sequence[float], sweeps: int, share: float, *, pull: float, length: float, angle: float, steps: int
) -> list[list[float]]:
    """Return by how much each link is too long, step by step, of a chain let go at an angle that hangs in a plane.

    Impulse by impulse along the links where they are, with a bias in the velocity and kept impulses. `pull` is what
    gravity adds to velocities in a step, h = 1. Places and velocities are complex; gravity is along the real axis.
    """
    inverse = [1 / mass for mass in masses]
    places = [length * (number + 1) * rect(1, angle) for number in range(len(masses))]
    velocities, impulses, seen = [0j] * len(masses), [0.0] * len(masses), []
    for _ in range(steps):
        links = [error(places, link) for link in range(len(masses))]
        errors, along = [abs(link) - length for link in links], [link / abs(link) for link in links]
        velocities = [velocity + pull for velocity in velocities]
        for link, impulse in enumerate(impulses):
            push(velocities, inverse, link, impulse * along[link])
        for _ in range(sweeps):
            for link, direction in enumerate(along):
                rate = (error(velocities, link) * direction.conjugate()).real
                added = -(rate + share * errors[link]) / (inverse[link] + (inverse[link - 1] if link else 0))
                push(velocities, inverse, link, added * direction)
                impulses[link] += added
        places = moved(places, velocities)
        seen.append(errors)
    return seen
