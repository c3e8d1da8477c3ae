import re
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.mechanism.scene_files import parse_scene, read_scene, shipped_scenes
from bezstab.mechanism.scenes import Joint
from tests.mechanism.test_scenes import pendulum

SPRING = {"bodies": ["ground", "bob"], "points": [[0, 2], [0, 0]], "stiffness": 3.0, "free_length": 1.0}
LINE = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]]}


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"surprise": 1}, "surprise"),
        ({"body__mass": 0.0}, "mass"),
        ({"body__mass": "__import__('os').system('true')"}, "mass"),
        ({"body__free": ["x", "y", "theta"]}, "inertia"),
        ({"gravity": [0.0, 1e-300]}, "gravity"),
        ({"body__name": "ground"}, "ground"),
        ({"joint__bodies": ["ground", "ghost"]}, "ghost"),
        ({"joint__type": "weld"}, "type"),
        ({"joint": {"type": "driver", "coordinate": "bob.theta"}}, "bob.theta"),
        ({"joint": {"type": "driver", "coordinate": "bob.x", "offset": 1.0}}, "never moves bob.x"),
        (
            {"joint": {"type": "driver", "coordinate": "bob.x", "rpm": 60}},
            "unknown key 'rpm': write rate, in rad/s (2π/60 times the rpm); known are type, coordinate, offset, rate",
        ),
        ({"joint": {**LINE, "direction": [0, 0]}}, "direction"),
        ({"initial__position": {"ghost.x": 1.0}}, "ghost.x"),
        ({"force": [{"body": "ghost", "force": [0, 1]}]}, "ghost"),
        ({"spring": [{**SPRING, "stiffness": -3.0}]}, "stiffness"),
        ({"spring": [{**SPRING, "stiffness": 0.0}]}, "stiffness and damping"),
        ({"spring": [{key: SPRING[key] for key in ("bodies", "points", "stiffness")}]}, "free_length"),
    ],
)  # fmt: skip
def test_a_bad_scene_takes_one_line_that_names_the_key(changes: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=rf"\A.*{re.escape(named)}.*\Z"):
        parse_scene(pendulum(**changes))


def test_every_kind_of_joint_is_one_that_a_file_may_have() -> None:
    kinds = [getattr(joint, "kind", "driver") for joint in get_args(Joint)]
    with pytest.raises(InputError) as refused:
        parse_scene(pendulum(joint__type="weld"))
    assert set(re.split(r", | or ", str(refused.value).partition("expected ")[2])) == set(kinds)


PENDULUM = (shipped_scenes()["pendulum"]).read_bytes()
HOSTILE = (
    b"name = " + b"1" * 5000,
    b"gravity = 0x" + b"f" * 5000,
    PENDULUM.replace(b"mass = 1.0", b"mass = 1" + b"0" * 400),
    b"body = " + b"[" * 20000 + b"]" * 20000,
    b"[" + b".".join([b"a"] * 20000) + b"]",
    PENDULUM + bytes(range(128, 256)),
    PENDULUM + PENDULUM,
    b'"a\\nb" = 1\n' + PENDULUM,
    PENDULUM.replace(b'"bob"', b'"b\\u2028ob"'),
)


def assert_refused(path: Path) -> None:
    with pytest.raises(InputError, match=rf"\A.*{re.escape(str(path))}.*\Z"):
        read_scene(path)


@settings(deadline=None)  # the file system has no bounded time
@given(
    st.binary(max_size=200)
    | st.builds(
        lambda cut, new, rest: PENDULUM[:cut] + new + PENDULUM[cut + rest :],
        st.integers(0, len(PENDULUM)),
        st.binary(max_size=6) | st.text(alphabet='[]{}"=,.-0123456789einfa \n\\u', max_size=12).map(str.encode),
        st.integers(0, 30),
    )
)
@example(PENDULUM)
def test_any_bytes_are_a_scene_or_one_line_of_refusal(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    (path := tmp_path_factory.getbasetemp() / "scene.toml").write_bytes(content)
    try:
        scene = read_scene(path)
    except InputError:
        assert_refused(path)
    else:
        assert scene.coordinates


@pytest.mark.slow
def test_a_hostile_file_is_refused(tmp_path: Path) -> None:
    for content in HOSTILE:
        (path := tmp_path / "scene.toml").write_bytes(content)
        assert_refused(path)
