from typing import Any

import pytest

from bezstab.mechanism import Body, Revolute, Scene, load_scene, shipped_scenes
from bezstab.mechanism.scenes import Distance, Driver

SHIPPED = list(shipped_scenes())

CRANK = Body("crank", ("theta",), mass=1.0, inertia=1.0, locked={}, center=(0.0, 0.0))
SLIDER = Body("slider", ("x", "theta"), mass=1.0, inertia=1.0, locked={}, center=(0.0, 0.0))


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


def scene(*joints: Revolute | Distance | Driver) -> Scene:
    return Scene("two bodies", (0.0, 0.0), (CRANK, SLIDER), joints, (), (), position={}, velocity={}, guess={})


def test_coordinates_are_those_left_free_in_the_order_of_the_bodies() -> None:
    assert scene().coordinates == ("crank.theta", "slider.x", "slider.theta")


def test_attachments_are_where_joints_hold_and_a_driver_holds_nowhere() -> None:
    rod = Distance(("crank", "slider"), ((1.0, 0.0), (0.0, 2.0)), length=3.0)
    drive = Driver("crank.theta", 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)
    assert scene(rod, drive).attachments == (("crank", (1.0, 0.0)), ("slider", (0.0, 2.0)))


@pytest.mark.parametrize("name", SHIPPED)
def test_equal_scenes_have_equal_hashes(name: str) -> None:
    assert load_scene(name) == load_scene(name)
    assert hash(load_scene(name)) == hash(load_scene(name))


def test_the_slider_crank_has_the_papers_five_coordinates() -> None:
    assert load_scene("slider_crank").coordinates == ("crank.theta", "rod.x", "rod.y", "rod.theta", "slider.x")
