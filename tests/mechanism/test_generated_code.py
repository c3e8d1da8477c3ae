"""Generated accelerations: their text, and functions of it for runs alone and side by side."""

import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import code_of, machine_source
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.start import initial_state
from tests.mechanism.test_scenes import pendulum


def test_names_never_reach_the_generated_code() -> None:
    hostile = "(__import__('os').abort())"
    initial = {
        "position": {f"{hostile}.x": 0.6},
        "velocity": {f"{hostile}.x": 0.0},
        "guess": {f"{hostile}.y": 0.5},
    }
    changes = {"body__name": hostile, "joint__bodies": ["ground", hostile], "initial": initial}
    mechanism = compiled_mechanism(parse_scene(pendulum(**changes)))
    assert "import" not in machine_source(code_of(mechanism, "accelerations"), "accelerations", 1)
    assert initial_state(mechanism)[0] == pytest.approx([0.6, 0.8])
