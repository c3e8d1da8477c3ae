"""A planar mechanism as checked data: bodies with their free coordinates, joints, forces, initial state; from TOML.

Nothing in a scene is ever executed: every entry is a number, a name or a list of them.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeGuard

from bezstab.errors import InputError, unknown_name
from bezstab.files import read_toml

Point = tuple[float, float]

GROUND = "ground"
COORDINATES = ("x", "y", "theta")
LEAST = 1e-100  # of a number that is not 0, and of the inverse of the largest: so their squares are within float64
SIZE = "0 or of size 1e-100 to 1e100"
NOWHERE = (0.0, 0.0)  # no displacement, direction or force


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


@dataclass(frozen=True)
class Revolute:
    """One point of each body coincides: two constraints."""

    bodies: tuple[str, str]
    points: tuple[Point, Point]


@dataclass(frozen=True)
class PointOnLine:
    """The second body's point stays on the line through the first's, along a direction fixed in the first."""

    bodies: tuple[str, str]
    points: tuple[Point, Point]
    direction: Point


@dataclass(frozen=True)
class Distance:
    """Two points keep their distance: c = (d^2 - length^2) / (2 length)."""

    bodies: tuple[str, str]
    points: tuple[Point, Point]
    length: float


@dataclass(frozen=True)
class Driver:
    """A coordinate follows offset + rate t + acceleration t^2 / 2 + amplitude sin(frequency t + phase)."""

    coordinate: str
    offset: float
    rate: float
    acceleration: float
    amplitude: float
    frequency: float
    phase: float


Joint = Revolute | PointOnLine | Distance | Driver


@dataclass(frozen=True)
class Force:
    """A constant force (N, in the ground's axes) at a body's point, and a constant torque (N m)."""

    body: str
    point: Point
    force: Point
    torque: float


@dataclass(frozen=True)
class Scene:
    """A planar mechanism; coordinates are called body.x, body.y and body.theta, in the order of the bodies."""

    name: str
    gravity: Point
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    forces: tuple[Force, ...]
    position: Mapping[str, float] = field(hash=False)
    velocity: Mapping[str, float] = field(hash=False)
    guess: Mapping[str, float] = field(hash=False)

    @property
    def coordinates(self) -> tuple[str, ...]:
        """The free coordinates, in order."""
        return tuple(f"{body.name}.{axis}" for body in self.bodies for axis in body.free)

    @property
    def attachments(self) -> tuple[tuple[str, Point], ...]:
        """Each body's or the ground's name, and the point in its frame (m), wherever a joint holds it."""
        joined = (joint for joint in self.joints if not isinstance(joint, Driver))
        return tuple(end for joint in joined for end in zip(joint.bodies, joint.points, strict=True))


class Table:
    """One TOML table that hands out checked entries and, at the end, names the keys that nobody asked for."""

    def __init__(self, data: object, where: str) -> None:
        if not isinstance(data, dict):
            raise InputError(f"{where}: expected a table")
        self.data: dict[str, Any] = data
        self.where = where
        self.unread = set(data)
        self.within: list[Table] = []

    def get(self, key: str, valid: Callable[[Any], bool], expected: str, default: object = None) -> Any:
        """Return a valid entry; InputError, with what was expected, if it is not, or missing without a default."""
        self.unread.discard(key)
        if key not in self.data and default is None:
            raise InputError(f"{self.where}: {key} is missing")
        value = self.data.get(key, default)
        if not valid(value):
            raise InputError(f"{self.where}: {key} = {value!r}: expected {expected}")
        return value

    def text(self, key: str) -> str:
        """Return one line of text."""
        return str(self.get(key, lambda x: isinstance(x, str) and x != "" and x.isprintable(), "a name"))

    def number(self, key: str, default: float | None = None, positive: bool = False) -> float:
        """Return a number."""
        if positive:
            return float(
                self.get(key, lambda x: _is_number(x) and x > 0, "a positive number, 1e-100 to 1e100", default)
            )
        return float(self.get(key, _is_number, f"a number, {SIZE}", default))

    def point(self, key: str, default: Point | None = None) -> Point:
        """Return a pair of numbers."""
        x, y = self.get(key, _is_point, f"two numbers, {SIZE}", default)
        return float(x), float(y)

    def numbers(self, key: str, allowed: Sequence[str]) -> dict[str, float]:
        """Return a table of numbers, none if absent, with keys among the allowed ones."""
        value = self.get(key, _are_numbers, f"a table of numbers, {SIZE}", {})
        unknown = [name for name in value if name not in allowed]
        if unknown:
            raise InputError(f"{self.where}: {key} names {unknown[0]!r}, which is not among {', '.join(allowed)}")
        return {name: float(number) for name, number in value.items()}

    def tables(self, key: str) -> list["Table"]:
        """Return an array of tables, none if absent."""
        value = self.get(key, lambda value: isinstance(value, list), "an array of tables", [])
        made = [Table(entry, f"{key} {number}") for number, entry in enumerate(value, start=1)]
        self.within += made
        return made

    def table(self, key: str) -> "Table":
        """Return a table, an empty one if absent."""
        self.within.append(made := Table(self.get(key, lambda value: isinstance(value, dict), "a table", {}), key))
        return made

    def done(self) -> None:
        """Raise InputError if a key, here or in a table within, was not asked for."""
        for table in self.within:
            table.done()
        if self.unread:
            raise InputError(f"{self.where}: unknown key {min(self.unread)!r}")


def _is_number(value: object) -> bool:
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    return value == 0 or LEAST <= abs(value) <= 1 / LEAST


def _is_point(value: object) -> bool:
    return _is_pair(value) and all(map(_is_number, value))


def _is_pair(value: object) -> TypeGuard[Sequence[object]]:
    return isinstance(value, list | tuple) and len(value) == 2


def _are_texts(value: object) -> bool:
    return isinstance(value, list) and all(isinstance(entry, str) for entry in value)


def _are_numbers(value: object) -> bool:
    return isinstance(value, dict) and all(map(_is_number, value.values()))


def shipped_scenes() -> dict[str, Path]:
    """Return the scene files that come with the package, by name; in a source tree they are those of configs/scenes."""
    package = Path(__file__).parent.parent
    folder = package / "scenes" if (package / "scenes").is_dir() else package.parent / "configs" / "scenes"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def load_scene(name: str) -> Scene:
    """Return the shipped scene of that name, or the one in a .toml file; InputError, with the nearest name, if none."""
    if name.endswith(".toml"):
        return read_scene(Path(name))
    shipped = shipped_scenes()
    if name not in shipped:
        raise unknown_name("scene", name, shipped)
    return read_scene(shipped[name])


def read_scene(path: Path) -> Scene:
    """Return the scene in a TOML file; InputError, naming the file and the key, for anything malformed."""
    return read_toml("scene", path, parse_scene)


def parse_scene(data: dict[str, Any]) -> Scene:
    """Return the scene described by TOML data."""
    top = Table(data, "scene")
    bodies, joints, guess = _four_bar_chain(top.table("four_bar_chain")) if "four_bar_chain" in data else ((), (), {})
    bodies = (*map(_body, top.tables("body")), *bodies)
    names = [body.name for body in bodies]
    duplicate = next((name for number, name in enumerate(names) if name in [GROUND, *names[:number]]), None)
    if duplicate is not None:
        raise InputError(f"body: the name {duplicate!r} is taken")
    coordinates = tuple(f"{body.name}.{axis}" for body in bodies for axis in body.free)
    if not coordinates:
        raise InputError("scene: no body has a free coordinate")
    joints = (*(_joint(table, names, coordinates) for table in top.tables("joint")), *joints)
    if not joints:
        raise InputError("scene: no joint, hence no constraint to stabilise")
    forces = tuple(_force(table, names) for table in top.tables("force"))
    initial = top.table("initial")
    position, velocity, guessed = (initial.numbers(key, coordinates) for key in ("position", "velocity", "guess"))
    name, gravity = top.text("name"), top.point("gravity", NOWHERE)
    top.done()
    return Scene(name, gravity, bodies, joints, forces, position, velocity, guess | guessed)


def _body(table: Table) -> Body:
    name, free = table.text("name"), table.get("free", _are_texts, "a list of names")
    table.where = f"body {name!r}"
    if not free or any(axis not in COORDINATES for axis in free) or len(set(free)) != len(free):
        raise InputError(f"{table.where}: free = {free}: expected some of {', '.join(COORDINATES)}")
    at_pivot = not {"x", "y"} & set(free)
    mass = table.number("mass", 0.0 if at_pivot else None, positive="mass" in table.data)
    inertia = table.number("inertia", None if "theta" in free else 0.0, positive="theta" in free)
    locked = table.numbers("locked", [axis for axis in COORDINATES if axis not in free])
    center = table.point("center", NOWHERE)
    if center != NOWHERE and not at_pivot:
        raise InputError(f"{table.where}: center: only for a body with x and y locked; else its frame's origin is it")
    return Body(name, tuple(axis for axis in COORDINATES if axis in free), mass, inertia, locked, center)


def _known(name: str, names: Sequence[str], table: Table) -> str:
    if name not in names and name != GROUND:
        raise InputError(f"{table.where}: there is no body {name!r}")
    return name


def _joint(table: Table, names: Sequence[str], coordinates: Sequence[str]) -> Joint:
    kind = table.text("type")
    table.where += f" ({kind})"
    if kind == "driver":
        coordinate = table.text("coordinate")
        if coordinate not in coordinates:
            raise InputError(f"{table.where}: coordinate {coordinate!r} is not among {', '.join(coordinates)}")
        terms = ("offset", "rate", "acceleration", "amplitude", "frequency", "phase")
        return Driver(coordinate, *(table.number(term, 0.0) for term in terms))
    if kind not in ("revolute", "point-on-line", "distance"):
        raise InputError(f"{table.where}: type: expected revolute, point-on-line, distance or driver")
    one, other = table.get("bodies", lambda x: _are_texts(x) and len(set(x)) == len(x) == 2, "two different names")
    bodies = _known(one, names, table), _known(other, names, table)
    (a, b), (c, d) = table.get("points", lambda x: _is_pair(x) and all(map(_is_point, x)), "two points [x, y]")
    points = (float(a), float(b)), (float(c), float(d))
    if kind == "revolute":
        return Revolute(bodies, points)
    if kind == "distance":
        return Distance(bodies, points, table.number("length", positive=True))
    direction = table.point("direction")
    if direction == NOWHERE:
        raise InputError(f"{table.where}: direction = [0, 0]: expected a direction")
    return PointOnLine(bodies, points, direction)


def _force(table: Table, names: Sequence[str]) -> Force:
    body, point = _known(table.text("body"), names, table), table.point("point", NOWHERE)
    return Force(body, point, table.point("force", NOWHERE), table.number("torque", 0.0))


def _four_bar_chain(table: Table) -> tuple[tuple[Body, ...], tuple[Joint, ...], dict[str, float]]:
    """Return N parallel four-bars in a row: N + 1 rods pivoted on the ground, N couplers between their tips.

    The benchmark of Gonzalez et al. (N-four-bar): equal rods of `length` (m) and `mass` (kg), a length apart.
    """
    count, length, mass = (table.number(key, positive=True) for key in ("count", "length", "mass"))
    if count > 100 or count != int(count):
        raise InputError(f"{table.where}: count = {count:g}: expected a whole number from 1 to 100")
    inertia = mass * length**2
    n, half = int(count), length / 2
    rods = [Body(f"rod{i}", ("theta",), mass, inertia / 3, {"x": i * length}, (half, 0.0)) for i in range(n + 1)]
    couplers = [Body(f"coupler{i}", COORDINATES, mass, inertia / 12, {}, (0.0, 0.0)) for i in range(n)]
    joints: list[Joint] = []
    for i in range(n):
        joints.append(Revolute((f"rod{i}", f"coupler{i}"), ((length, 0.0), (-half, 0.0))))
        joints.append(Revolute((f"coupler{i}", f"rod{i + 1}"), ((half, 0.0), (length, 0.0))))
    upright = {f"rod{i}.theta": math.pi / 2 for i in range(n + 1)}
    middle = {f"coupler{i}.x": (i + 0.5) * length for i in range(n)} | {f"coupler{i}.y": length for i in range(n)}
    return (*rods, *couplers), tuple(joints), upright | middle
