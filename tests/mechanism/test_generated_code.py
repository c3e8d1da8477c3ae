"""Generated accelerations: their text, and functions of it for runs alone and side by side."""

import pytest
import sympy as sp

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import code_of, machine_source
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.start import initial_state
from tests.mechanism.four_bar_chains import four_bars
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


@pytest.mark.slow
def test_a_chain_twice_as_long_takes_twice_the_arithmetic() -> None:
    """Its matrices are banded: entries that are zero are not computed."""
    short, long = (code_of(compiled_mechanism(four_bars(count)), "accelerations") for count in (12, 24))
    assert len(long.assignments) < 2.2 * len(short.assignments)
    of_short, of_long = (sum(sp.count_ops(value) for _, value in code.assignments) for code in (short, long))
    assert of_long < 2.2 * of_short
