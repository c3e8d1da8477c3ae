"""Scenes in TOML files; configs/scenes/README.md documents the format.

Nothing in a scene is ever executed: every entry is a number, a name or a list of them.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from bezstab.arguments import Number, real_number
from bezstab.errors import InputError, shown, unknown_name
from bezstab.files import read_toml
from bezstab.mechanism.scenes import (
    COORDINATES,
    GROUND,
    Body,
    Distance,
    Driver,
    Force,
    Joint,
    Point,
    PointOnLine,
    Revolute,
    Scene,
    Spring,
    at_speed,
)
from bezstab.toml_tables import TomlTable, a_number, pair_of

NOWHERE = (0.0, 0.0)  # no displacement, direction or force

IN_PLACE_OF = {
    **dict.fromkeys(("rpm", "RPM"), "rate, in rad/s (2π/60 times the rpm)"),
    **dict.fromkeys(("speed", "omega", "velocity"), "rate, in rad/s"),
    "frequency_hz": "frequency, in rad/s (2π times the Hz)",
}
"""What to write in a driver for keys that people try there."""


def shipped_scenes() -> dict[str, Path]:
    """Return the scene files that come with the package, by name; in a source tree they are those of configs/scenes."""
    package = Path(__file__).parent.parent
    folder = package / "scenes" if (package / "scenes").is_dir() else package.parent / "configs" / "scenes"
    return {path.stem: path for path in sorted(folder.glob("*.toml"))}


def load_scene(name: str) -> Scene:
    """Return the shipped scene of that name, or the one in a .toml file; InputError, with the nearest name, if none.

    In SI units and rad. InputError, too, as `read_scene`.
    """
    if name.endswith(".toml"):
        return read_scene(Path(name))
    shipped = shipped_scenes()
    if name not in shipped:
        raise unknown_name("scene", name, shipped)
    return read_scene(shipped[name])


def scene(name: str | Scene, speed: Number = 1) -> Scene:
    """Return the planar mechanism of that name, in SI units and rad.

    Parameters
    ----------
    name : str or Scene
        A shipped scene ("pendulum"), the path of a .toml file, or a scene. "slider_crank" is that of the paper.
    speed : number
        Factor on the speed of its drivers and initial velocities.

    Returns
    -------
    Scene

    Raises
    ------
    InputError
        The file cannot be read (it names the file and the key), or nothing moves whose speed could be changed.
    """
    if not isinstance(name, str | Scene):
        raise InputError(
            f"scene {shown(name)}: expected one name such as 'pendulum', or what bezstab.scene makes of one"
        )
    given = name if isinstance(name, Scene) else load_scene(name)
    return at_speed(given, real_number(speed, "speed"))


def read_scene(path: Path) -> Scene:
    """Return the scene in a TOML file; InputError, naming the file and the key, for anything malformed."""
    return read_toml("scene", path, parse_scene)


def parse_scene(data: dict[str, Any]) -> Scene:
    """Return the scene described by TOML data; InputError, naming the place and the key, for anything malformed."""
    top = TomlTable(data, "scene")
    name = top.text("name")
    gravity = top.point("gravity", default=NOWHERE)
    duration = top.positive_number("duration", default=0.0)

    bodies = tuple(_body(table) for table in top.tables("body"))
    body_names = [body.name for body in bodies]
    for number, body_name in enumerate(body_names):
        if body_name in (GROUND, *body_names[:number]):
            raise InputError(f"body: the name {body_name!r} is taken")
    coordinates = tuple(f"{body.name}.{axis}" for body in bodies for axis in body.free)
    if not coordinates:
        raise top.mistake("no body has a free coordinate")

    joints = tuple(_joint(table, body_names, coordinates) for table in top.tables("joint"))
    if not joints:
        raise top.mistake("no joint, hence no constraint to stabilise")
    forces = tuple(_force(table, body_names) for table in top.tables("force"))
    springs = tuple(_spring(table, body_names) for table in top.tables("spring"))

    initial = top.table("initial")
    position = initial.numbers("position", allowed=coordinates)
    velocity = initial.numbers("velocity", allowed=coordinates)
    guess = initial.numbers("guess", allowed=coordinates)
    top.refuse_unknown_keys()
    return Scene(name, gravity, bodies, joints, forces, springs, position, velocity, guess, duration)


def _body(table: TomlTable) -> Body:
    name = table.text("name")
    table.where = f"body {name!r}"
    free = table.texts("free")
    if not free or any(axis not in COORDINATES for axis in free) or len(set(free)) != len(free):
        raise table.mistake(f"free = {free}: expected some of {', '.join(COORDINATES)}")
    locked = table.numbers("locked", allowed=[axis for axis in COORDINATES if axis not in free])
    on_fixed_pivot = "x" not in free and "y" not in free

    # What moves needs a positive mass, what turns a positive inertia. A body on a fixed pivot may go without a mass
    # (0, it then has no weight either), and the inertia of what does not turn does not enter.
    mass = table.positive_number("mass", default=0.0 if on_fixed_pivot else None)
    inertia = table.positive_number("inertia") if "theta" in free else table.number("inertia", default=0.0)

    center = table.point("center", default=NOWHERE)
    if center != NOWHERE and not on_fixed_pivot:
        raise table.mistake("center: only for a body with x and y locked; else its frame's origin is it")
    in_order = tuple(axis for axis in COORDINATES if axis in free)
    return Body(name, in_order, mass, inertia, locked, center)


def _joint(table: TomlTable, body_names: Sequence[str], coordinates: Sequence[str]) -> Joint:
    kind = table.text("type")
    table.where += f" ({kind})"
    match kind:
        case "revolute":
            return Revolute(*_ends(table, body_names))
        case "distance":
            return Distance(*_ends(table, body_names), table.positive_number("length"))
        case "point-on-line":
            direction = table.point("direction")
            if direction == NOWHERE:
                raise table.mistake("direction = [0, 0]: expected a direction")
            return PointOnLine(*_ends(table, body_names), direction)
        case "driver":
            return _driver(table, coordinates)
        case _:
            raise table.mistake("type: expected revolute, point-on-line, distance or driver")


def _driver(table: TomlTable, coordinates: Sequence[str]) -> Driver:
    coordinate = table.text("coordinate")
    if coordinate not in coordinates:
        raise table.mistake(f"coordinate {coordinate!r} is not among {', '.join(coordinates)}")
    numbers = ("offset", "rate", "acceleration", "amplitude", "frequency", "phase")
    driver = Driver(coordinate, **{name: table.number(name, default=0.0) for name in numbers})
    table.refuse_unknown_keys(IN_PLACE_OF)
    if not driver.moves:
        raise table.mistake(f"it never moves {coordinate}: expected a rate, an acceleration or an oscillation")
    return driver


def _ends(table: TomlTable, body_names: Sequence[str]) -> tuple[tuple[str, str], tuple[Point, Point]]:
    """Return two bodies, and a point of each."""
    names = table.texts("bodies")
    if len(names) != 2 or names[0] == names[1]:
        raise table.mistake(f"bodies = {names!r}: expected two different names")
    first, second = (_known_body(name, body_names, table) for name in names)
    return (first, second), table.entry("points", pair_of(pair_of(a_number)), "two points [x, y]")


def _known_body(name: str, body_names: Sequence[str], table: TomlTable) -> str:
    if name not in body_names and name != GROUND:
        raise table.mistake(f"there is no body {name!r}")
    return name


def _force(table: TomlTable, body_names: Sequence[str]) -> Force:
    return Force(
        body=_known_body(table.text("body"), body_names, table),
        point=table.point("point", default=NOWHERE),
        force=table.point("force", default=NOWHERE),
        torque=table.number("torque", default=0.0),
    )


def _spring(table: TomlTable, body_names: Sequence[str]) -> Spring:
    ends = _ends(table, body_names)
    stiffness = table.number("stiffness", default=0.0)
    damping = table.number("damping", default=0.0)
    free_length = table.number("free_length", default=None if stiffness > 0 else 0.0)
    table.refuse_unknown_keys()
    for key, value in (("stiffness", stiffness), ("damping", damping), ("free_length", free_length)):
        if value < 0:
            raise table.mistake(f"{key} = {value:g}: expected 0 or more")
    if stiffness == damping == 0:
        raise table.mistake("stiffness and damping are both 0: expected one of them positive")
    return Spring(*ends, stiffness, free_length, damping)
