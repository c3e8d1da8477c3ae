"""Generated accelerations: their text, and functions of it for runs alone and side by side."""

import math

import numpy as np
import pytest
import sympy as sp

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import code_of, compiled_source, lane_function, machine_source, state_function
from bezstab.mechanism.scene_files import load_scene, parse_scene
from bezstab.mechanism.start import initial_state
from tests.mechanism.four_bar_chains import four_bars
from tests.mechanism.test_scenes import pendulum


def test_pivots_are_those_of_the_factored_matrix() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    q, v = initial_state(mechanism)
    symbols = dict(zip(mechanism.q, q, strict=True))
    jacobian = np.array(mechanism.jacobian.subs(symbols), float)
    effective = jacobian @ np.diag(1 / mechanism.mass) @ jacobian.T
    pivots = np.diag(np.linalg.cholesky(effective)) ** 2
    found = state_function(mechanism, "accelerations", math)([0.0, 0.0, 0.0, *q.tolist(), *v.tolist()])
    assert found[mechanism.size :] == pytest.approx(pivots / np.diag(effective), rel=1e-13)


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


def test_the_text_for_machine_code_is_that_of_the_function() -> None:
    """Here as Python, in the second of two lanes."""
    mechanism, gains = compiled_mechanism(load_scene("slider_crank")), (3.0, 4.0)
    state = 0.1 * np.sin(7.0 * np.arange(4 * mechanism.size)).reshape(2, -1)
    code = code_of(mechanism, "accelerations")
    function, found = compiled_source(machine_source(code, "accelerations", 2), np), np.zeros(2 * mechanism.size)
    pivot = function(0.0, np.array([gains, gains]).T, state, found, 1)
    expected = state_function(mechanism, "accelerations", np)([0.0, *gains, *state[:, 1::2].ravel()])
    assert found[1::2] == pytest.approx(expected[: mechanism.size], rel=1e-14)
    assert pivot == pytest.approx(min(expected[mechanism.size :]), rel=1e-14)
    assert not found[::2].any()


def test_runs_side_by_side_have_the_accelerations_of_each() -> None:
    """Of floats one by one and together; of complex numbers together."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    state = 0.1 * np.sin(7.0 * np.arange(6 * mechanism.size)).reshape(2, mechanism.size, 3)
    gains, function = np.array([[3.0, 4.0, 5.0], [9.0, 1.0, 2.0]]), lane_function(mechanism, "accelerations")
    together, _ = function(0.0, gains, *state)
    as_complex, _ = function(0.0, gains, *state.astype(complex))
    assert as_complex == pytest.approx(together, rel=1e-14)
    for lane in range(3):
        alone, pivot = function(0.0, gains[:, [lane]], *state[:, :, [lane]])
        assert alone[:, 0] == pytest.approx(together[:, lane], rel=1e-14)
        assert 0 < pivot < 1


@pytest.mark.slow
def test_a_chain_twice_as_long_takes_twice_the_arithmetic() -> None:
    """Its matrices are banded: entries that are zero are not computed."""
    short, long = (code_of(compiled_mechanism(four_bars(count)), "accelerations") for count in (12, 24))
    assert len(long.assignments) < 2.2 * len(short.assignments)
    of_short, of_long = (sum(sp.count_ops(value) for _, value in code.assignments) for code in (short, long))
    assert of_long < 2.2 * of_short
