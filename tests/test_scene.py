from pathlib import Path
from typing import Any

import pytest

from bezstab.errors import InputError
from bezstab.scene import load, parse, read, shipped_scenes

SHIPPED = list(shipped_scenes())

LINE = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]]}


def pendulum(**changes: Any) -> dict[str, Any]:
    """Return a pendulum's data with some of its entries replaced, 'body.mass' meaning that of the only body."""
    data: dict[str, Any] = {
        "name": "pendulum",
        "body": {"name": "bob", "mass": 1.0, "free": ["x", "y"]},
        "joint": {"type": "distance", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]], "length": 1.0},
        "initial": {"position": {"bob.x": 1.0, "bob.y": 0.0}},
    }
    for key, value in changes.items():
        table, _, entry = key.partition("__")
        if entry:
            data[table][entry] = value
        else:
            data[table] = value
    return {key: [value] if key in ("body", "joint") else value for key, value in data.items()}


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_scene_is_read(name: str) -> None:
    assert load(name).coordinates


def test_the_slider_crank_has_the_papers_five_coordinates() -> None:
    assert load("slider_crank").coordinates == ("crank.theta", "rod.x", "rod.y", "rod.theta", "slider.x")


def test_the_chain_grows_with_its_count() -> None:
    data = {"name": "chain", "four_bar_chain": {"count": 7, "length": 1.0, "mass": 1.0}}
    assert len(parse(data).coordinates) == 8 + 3 * 7


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"surprise": 1}, "surprise"),
        ({"body__surprise": 1}, "surprise"),
        ({"joint__surprise": 1}, "surprise"),
        ({"initial__surprise": 1}, "surprise"),
        ({"body__mass": 0.0}, "mass"),
        ({"body__mass": -1.0}, "mass"),
        ({"body__mass": float("nan")}, "mass"),
        ({"body__mass": float("inf")}, "mass"),
        ({"body__mass": True}, "mass"),
        ({"body__mass": "__import__('os').system('true')"}, "mass"),
        ({"body__free": ["x", "y", "theta"]}, "inertia"),
        ({"body__free": ["z"]}, "free"),
        ({"body__free": []}, "free"),
        ({"body__free": ["x", "x"]}, "free"),
        ({"body__name": "ground"}, "ground"),
        ({"body__center": [1.0, 0.0]}, "center"),
        ({"joint__bodies": ["ground", "ghost"]}, "ghost"),
        ({"joint__bodies": ["bob", "bob"]}, "bodies"),
        ({"joint__points": [[0, 0]]}, "points"),
        ({"joint__length": 0}, "length"),
        ({"joint__type": "weld"}, "type"),
        ({"joint": {"type": "driver", "coordinate": "bob.theta"}}, "bob.theta"),
        ({"joint": {**LINE, "direction": [0, 0]}}, "direction"),
        ({"gravity": [0.0]}, "gravity"),
        ({"initial__position": {"ghost.x": 1.0}}, "ghost.x"),
        ({"initial": 3}, "initial"),
        ({"force": [{"body": "ghost", "force": [0, 1]}]}, "ghost"),
    ],
)  # fmt: skip
def test_a_bad_scene_takes_one_line_that_names_the_key(changes: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError) as caught:
        parse(pendulum(**changes))
    assert named in str(caught.value)
    assert "\n" not in str(caught.value)


def test_an_unknown_scene_suggests_a_near_one(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="did you mean pendulum"):
        load("pendulm")
    for bad in (tmp_path / "missing.toml", tmp_path):
        with pytest.raises(InputError):
            read(bad)
