"""A planar mechanism as data: bodies with their free coordinates, joints, forces, springs, gravity, initial state."""

import cmath
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import ClassVar

from bezstab.errors import InputError

Point = tuple[float, float]

FASTEST = 1e100  # times as fast as given, and the inverse the slowest: its square is within float64
GROUND = "ground"
COORDINATES = ("x", "y", "theta")
"""What a body in the plane can have free: its frame's origin (m, in the ground's axes) and its angle (rad)."""


@dataclass(frozen=True)
class Body:
    """A rigid body; its frame's origin is its centre of mass unless x and y are locked (m, kg, kg m2, rad).

    Of x, y and theta those in `free` are coordinates of the model, the others stay at `locked`. With x and y locked
    the inertia is about the frame's origin, the pivot, and `center` is the centre of mass in the body's frame.
    """

    name: str
    free: tuple[str, ...]
    mass: float
    inertia: float
    locked: Mapping[str, float] = field(hash=False)
    center: Point

    @property
    def turns_in_place(self) -> bool:
        """Whether its frame's origin stays where it is, a pivot, and the body turns about it."""
        return "theta" in self.free and not {"x", "y"} & set(self.free)


@dataclass(frozen=True)
class Between:
    """What is between a point of one body and a point of another, or of the ground; points in m in the body's frame."""

    bodies: tuple[str, str]
    points: tuple[Point, Point]


@dataclass(frozen=True)
class Revolute(Between):
    """The points coincide: two constraints, c in m."""

    kind: ClassVar = "revolute"


@dataclass(frozen=True)
class PointOnLine(Between):
    """The second body's point stays on the line through the first's, along a direction fixed in the first; c in m."""

    kind: ClassVar = "point-on-line"
    direction: Point


@dataclass(frozen=True)
class Distance(Between):
    """Two points keep their distance: c = (d^2 - length^2) / (2 length), all in m."""

    kind: ClassVar = "distance"
    length: float


@dataclass(frozen=True)
class Driver:
    """A coordinate follows offset + rate t + acceleration t^2 / 2 + amplitude sin(frequency t + phase).

    In m or rad, as the coordinate is; t in s, frequency in rad/s, phase in rad.
    """

    coordinate: str
    offset: float
    rate: float
    acceleration: float
    amplitude: float
    frequency: float
    phase: float

    @property
    def moves(self) -> bool:
        """Whether the coordinate does not just stay where it is."""
        return self.rate != 0 or self.acceleration != 0 or (self.amplitude != 0 and self.frequency != 0)


Joint = Revolute | PointOnLine | Distance | Driver


@dataclass(frozen=True)
class Force:
    """A constant force (N, in the ground's axes) at a body's point, and a constant torque (N m)."""

    body: str
    point: Point
    force: Point
    torque: float


@dataclass(frozen=True)
class Spring(Between):
    """A spring and a damper, side by side.

    At the distance L of the points they pull with stiffness (L - free_length) + damping dL/dt (N/m, m, N s/m; N).
    """

    stiffness: float
    free_length: float
    damping: float


@dataclass(frozen=True)
class Scene:
    """A planar mechanism; coordinates are called body.x, body.y and body.theta, in the order of the bodies.

    `gravity` in m/s2. `position` (m, rad) and `velocity` (m/s, rad/s) hold the coordinates that are given at the
    start, and the others follow from the constraints, found from `guess`. `duration` (s) is how long a motion that no
    driver closes is worth looking at; 0 where nobody says.
    """

    name: str
    gravity: Point
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    forces: tuple[Force, ...]
    springs: tuple[Spring, ...]
    position: Mapping[str, float] = field(hash=False)
    velocity: Mapping[str, float] = field(hash=False)
    guess: Mapping[str, float] = field(hash=False)
    duration: float = 0.0

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The free coordinates, in order."""
        return tuple(f"{body.name}.{axis}" for body in self.bodies for axis in body.free)

    @property
    def attachments(self) -> tuple[tuple[str, Point], ...]:
        """Each body's or the ground's name, and the point in its frame (m), wherever a joint holds it."""
        joined = (joint for joint in self.joints if isinstance(joint, Between))
        return tuple(end for joint in joined for end in zip(joint.bodies, joint.points, strict=True))

    def joint_places(self, q: Sequence[float]) -> dict[str, list[Point]]:
        """Return where the joints of each body, and of the ground, are in a state q, in m and ascending.

        The pivot of a body that turns in its place is one of them.
        """
        free = dict(zip(self.coordinates, q, strict=True))
        origins, turns = {GROUND: 0j}, {GROUND: 1 + 0j}  # numbers x + iy
        places: dict[str, set[complex]] = {}
        for body in self.bodies:
            x, y, theta = (free.get(f"{body.name}.{axis}", body.locked.get(axis, 0.0)) for axis in COORDINATES)
            origins[body.name], turns[body.name] = complex(x, y), cmath.rect(1, theta)
            places[body.name] = {complex(x, y)} if body.turns_in_place else set()
        for name, local in self.attachments:
            places.setdefault(name, set()).add(origins[name] + complex(*local) * turns[name])
        return {name: sorted((at.real, at.imag) for at in joints) for name, joints in places.items() if joints}


def at_speed(scene: Scene, factor: float) -> Scene:
    """Return the scene with its initial velocities and its drivers so many times as fast, and a name that says so.

    A driver's f(t) becomes f(factor t): the same course in less time, all its rates times the factor. The same scene
    for a factor of 1. InputError for one that is not positive, and where nothing in the scene has a speed.
    """
    if not 1 / FASTEST <= factor <= FASTEST:  # nor if it is not a number
        raise InputError(f"speed {factor:g}: expected {1 / FASTEST:g} to {FASTEST:g}")
    if factor == 1:
        return scene
    drivers = [joint for joint in scene.joints if isinstance(joint, Driver)]
    if not drivers and not any(scene.velocity.values()):
        raise InputError(f"--speed {factor:g}: {scene.name} starts at rest and has no driver")
    return replace(
        scene,
        name=f"{scene.name}, {factor:g} times as fast",
        joints=tuple(_faster(joint, factor) if isinstance(joint, Driver) else joint for joint in scene.joints),
        velocity={name: factor * rate for name, rate in scene.velocity.items()},
    )


def _faster(driver: Driver, factor: float) -> Driver:
    return replace(
        driver,
        rate=factor * driver.rate,
        acceleration=factor**2 * driver.acceleration,
        frequency=factor * driver.frequency,
    )
