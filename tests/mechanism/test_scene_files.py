import re
from typing import Any

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from bezstab.errors import InputError
from bezstab.mechanism.scene_files import parse_scene, read_scene, shipped_scenes
from tests.mechanism.test_scenes import pendulum

SPRING = {"bodies": ["ground", "bob"], "points": [[0, 2], [0, 0]], "stiffness": 3.0, "free_length": 1.0}
LINE = {"type": "point-on-line", "bodies": ["ground", "bob"], "points": [[0, 0], [0, 0]]}


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"surprise": 1}, "surprise"),
        ({"body__mass": 0.0}, "mass"),
        ({"body__mass": "__import__('os').system('true')"}, "mass"),
        ({"body__name": "ground"}, "ground"),
        ({"joint__bodies": ["ground", "ghost"]}, "ghost"),
        ({"joint__type": "weld"}, "type: expected revolute, point-on-line, distance or driver"),
        ({"joint": {"type": "driver", "coordinate": "bob.x", "offset": 1.0}}, "never moves bob.x"),
        (
            {"joint": {"type": "driver", "coordinate": "bob.x", "rpm": 60}},
            "unknown key 'rpm': write rate, in rad/s (2π/60 times the rpm); known are type, coordinate, offset, rate",
        ),
        ({"joint": {**LINE, "direction": [0, 0]}}, "direction"),
        ({"initial__position": {"ghost.x": 1.0}}, "ghost.x"),
        ({"spring": [{**SPRING, "stiffness": 0.0}]}, "stiffness and damping"),
    ],
)  # fmt: skip
def test_a_bad_scene_takes_one_line_that_names_the_key(changes: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError, match=rf"\A.*{re.escape(named)}.*\Z"):
        parse_scene(pendulum(**changes))


PENDULUM = (shipped_scenes()["pendulum"]).read_bytes()


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
@example(PENDULUM.replace(b"mass = 1.0", b"mass = 1" + b"0" * 400))
def test_any_bytes_are_a_scene_or_one_line_of_refusal(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    (path := tmp_path_factory.getbasetemp() / "scene.toml").write_bytes(content)
    try:
        said = str(path) if read_scene(path).coordinates else "nothing"
    except InputError as refused:
        said = str(refused)
    assert re.fullmatch(f".*{re.escape(str(path))}.*", said)
