"""A planar mechanism as checked data: bodies with their free coordinates, joints, forces, initial state; from TOML.

Nothing in a scene is ever executed: every entry is a number, a name or a list of them.
"""

import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from bezstab.errors import InputError, unknown
from bezstab.files import read_toml

Point = tuple[float, float]

GROUND = "ground"
COORDINATES = ("x", "y", "theta")


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

    def _take(self, key: str, default: object) -> Any:
        self.unread.discard(key)
        if key not in self.data and default is None:
            raise InputError(f"{self.where}: {key} is missing")
        return self.data.get(key, default)

    def _refuse(self, key: str, expected: str) -> InputError:
        return InputError(f"{self.where}: {key} = {self.data[key]!r}: expected {expected}")

    def text(self, key: str, default: str | None = None) -> str:
        """Return one line of text."""
        value = self._take(key, default)
        if not isinstance(value, str) or not value or not value.isprintable():
            raise self._refuse(key, "a name")
        return value

    def number(self, key: str, default: float | None = None, positive: bool = False) -> float:
        """Return a finite number."""
        value = self._take(key, default)
        if not _is_number(value) or (positive and value <= 0):
            raise self._refuse(key, "a positive number" if positive else "a finite number")
        return float(value)

    def point(self, key: str, default: Point | None = None) -> Point:
        """Return a pair of finite numbers."""
        value = self._take(key, default)
        if not _is_point(value):
            raise self._refuse(key, "two finite numbers")
        return float(value[0]), float(value[1])

    def points(self, key: str) -> tuple[Point, Point]:
        """Return two pairs of finite numbers."""
        value = self._take(key, None)
        if not isinstance(value, list) or len(value) != 2 or not all(map(_is_point, value)):
            raise self._refuse(key, "two points [x, y]")
        (a, b), (c, d) = value
        return (float(a), float(b)), (float(c), float(d))

    def names(self, key: str) -> tuple[str, ...]:
        """Return a list of names."""
        value = self._take(key, None)
        if not isinstance(value, list) or not all(isinstance(entry, str) for entry in value):
            raise self._refuse(key, "a list of names")
        return tuple(value)

    def numbers(self, key: str, allowed: Sequence[str]) -> dict[str, float]:
        """Return a table of finite numbers, none if absent, with keys among the allowed ones."""
        value = self._take(key, {})
        if not isinstance(value, dict) or not all(map(_is_number, value.values())):
            raise self._refuse(key, "a table of finite numbers")
        unknown = [name for name in value if name not in allowed]
        if unknown:
            raise InputError(f"{self.where}: {key} names {unknown[0]!r}, which is not among {', '.join(allowed)}")
        return {name: float(number) for name, number in value.items()}

    def tables(self, key: str) -> list["Table"]:
        """Return an array of tables, none if absent."""
        value = self._take(key, [])
        if not isinstance(value, list):
            raise self._refuse(key, "an array of tables")
        return [Table(entry, f"{key} {number}") for number, entry in enumerate(value, start=1)]

    def table(self, key: str) -> "Table | None":
        """Return a table, None if absent."""
        value = self._take(key, {})
        return Table(value, key) if key in self.data else None

    def done(self) -> None:
        """Raise InputError if a key was not asked for."""
        if self.unread:
            raise InputError(f"{self.where}: unknown key {min(self.unread)!r}")


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= sys.float_info.max


def _is_point(value: object) -> bool:
    return isinstance(value, list | tuple) and len(value) == 2 and all(map(_is_number, value))


def shipped_scenes() -> dict[str, Path]:
    """Return the scene files that come with the package, by name; in a source tree they are those of configs/scenes."""
    package = Path(__file__).parent
    folder = package / "scenes" if (package / "scenes").is_dir() else package.parent / "configs" / "scenes"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def load(name: str) -> Scene:
    """Return the shipped scene of that name, or the one in a .toml file; InputError, with the nearest name, if none."""
    if name.endswith(".toml"):
        return read(Path(name))
    shipped = shipped_scenes()
    if name not in shipped:
        raise unknown("scene", name, shipped)
    return read(shipped[name])


def read(path: Path) -> Scene:
    """Return the scene in a TOML file; InputError, naming the file and the key, for anything malformed."""
    return read_toml("scene", path, parse)


def parse(data: dict[str, Any]) -> Scene:
    """Return the scene described by TOML data."""
    top = Table(data, "scene")
    bodies = tuple(_body(table) for table in top.tables("body"))
    chain = top.table("four_bar_chain")
    chain_parts = _four_bar_chain(chain) if chain else ((), (), {})
    bodies += chain_parts[0]
    names = [body.name for body in bodies]
    duplicate = next((name for number, name in enumerate(names) if name in [GROUND, *names[:number]]), None)
    if duplicate is not None:
        raise InputError(f"body: the name {duplicate!r} is taken")
    coordinates = tuple(f"{body.name}.{axis}" for body in bodies for axis in body.free)
    if not coordinates:
        raise InputError("scene: no body has a free coordinate")
    joints = tuple(_joint(table, names, coordinates) for table in top.tables("joint")) + chain_parts[1]
    if not joints:
        raise InputError("scene: no joint, hence no constraint to stabilise")
    forces = tuple(_force(table, names) for table in top.tables("force"))
    initial = top.table("initial") or Table({}, "initial")
    scene = Scene(
        top.text("name"),
        top.point("gravity", (0.0, 0.0)),
        bodies,
        joints,
        forces,
        initial.numbers("position", coordinates),
        initial.numbers("velocity", coordinates),
        {**chain_parts[2], **initial.numbers("guess", coordinates)},
    )
    initial.done()
    top.done()
    return scene


def _body(table: Table) -> Body:
    name, free = table.text("name"), table.names("free")
    table.where = f"body {name!r}"
    if not free or any(axis not in COORDINATES for axis in free) or len(set(free)) != len(free):
        raise InputError(f"{table.where}: free = {list(free)}: expected some of {', '.join(COORDINATES)}")
    ordered = tuple(axis for axis in COORDINATES if axis in free)
    at_pivot = not {"x", "y"} & set(free)
    body = Body(
        name,
        ordered,
        table.number("mass", 0.0 if at_pivot else None, positive="mass" in table.data),
        table.number("inertia", None if "theta" in free else 0.0, positive="theta" in free),
        table.numbers("locked", [axis for axis in COORDINATES if axis not in free]),
        table.point("center", (0.0, 0.0)),
    )
    if body.center != (0.0, 0.0) and not at_pivot:
        raise InputError(f"{table.where}: center: only for a body with x and y locked; else its frame's origin is it")
    table.done()
    return body


def _pair(table: Table, names: Sequence[str]) -> tuple[str, str]:
    pair = table.names("bodies")
    if len(pair) != 2 or pair[0] == pair[1]:
        raise InputError(f"{table.where}: bodies = {list(pair)}: expected two different names")
    for name in pair:
        _known(name, names, table)
    return pair[0], pair[1]


def _known(name: str, names: Sequence[str], table: Table) -> str:
    if name not in names and name != GROUND:
        raise InputError(f"{table.where}: there is no body {name!r}")
    return name


def _joint(table: Table, names: Sequence[str], coordinates: Sequence[str]) -> Joint:
    kind = table.text("type")
    table.where += f" ({kind})"
    joint: Joint
    if kind == "revolute":
        joint = Revolute(_pair(table, names), table.points("points"))
    elif kind == "point-on-line":
        joint = PointOnLine(_pair(table, names), table.points("points"), table.point("direction"))
        if joint.direction == (0.0, 0.0):
            raise InputError(f"{table.where}: direction = [0, 0]: expected a direction")
    elif kind == "distance":
        joint = Distance(_pair(table, names), table.points("points"), table.number("length", positive=True))
    elif kind == "driver":
        coordinate = table.text("coordinate")
        if coordinate not in coordinates:
            raise InputError(f"{table.where}: coordinate {coordinate!r} is not among {', '.join(coordinates)}")
        terms = ("offset", "rate", "acceleration", "amplitude", "frequency", "phase")
        joint = Driver(coordinate, *(table.number(term, 0.0) for term in terms))
    else:
        raise InputError(f"{table.where}: type: expected revolute, point-on-line, distance or driver")
    table.done()
    return joint


def _force(table: Table, names: Sequence[str]) -> Force:
    body = _known(table.text("body"), names, table)
    zero = (0.0, 0.0)
    force = Force(body, table.point("point", zero), table.point("force", zero), table.number("torque", 0.0))
    table.done()
    return force


def _four_bar_chain(table: Table) -> tuple[tuple[Body, ...], tuple[Joint, ...], dict[str, float]]:
    """Return N parallel four-bars in a row: N + 1 rods pivoted on the ground, N couplers between their tips.

    The benchmark of Gonzalez et al. (N-four-bar): equal rods of `length` (m) and `mass` (kg), a length apart.
    """
    count, length = table.number("count", positive=True), table.number("length", positive=True)
    mass = table.number("mass", positive=True)
    if count != int(count) or count > 100:
        raise InputError(f"{table.where}: count = {count:g}: expected a whole number from 1 to 100")
    inertia = mass * length * length  # length**2 raises where this is infinite
    if not 0 < inertia < math.inf:
        raise InputError(f"{table.where}: mass {mass:g} and length {length:g}: an inertia outside the range of float64")
    table.done()
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
