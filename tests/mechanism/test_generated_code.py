"""The text of generated accelerations, and what machine code makes of it where it is long."""

import math

import numpy as np
import pytest

from bezstab.mechanism import Mechanism, compiled_mechanism, initial_state, load_scene, state_function
from bezstab.mechanism.generated_code import code_of, function_by_operations, machine_source, operations
from bezstab.mechanism.scene_files import parse_scene
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


def chain(count: int) -> Mechanism:
    """Return a chain of so many four-bars."""
    upright = {"position": {"rod0.theta": math.pi / 2}, "velocity": {"rod0.theta": -1.0}}
    links = {"count": count, "length": 1.0, "mass": 1.0}
    return compiled_mechanism(parse_scene({"name": "chain", "four_bar_chain": links, "initial": upright}))


@pytest.mark.slow
def test_single_operations_are_the_text() -> None:
    """Here as Python, in the second of two lanes."""
    mechanism, gains = chain(12), (3.0, 4.0)
    state = 0.1 * np.sin(7.0 * np.arange(4 * mechanism.size)).reshape(2, -1)
    for name in ("accelerations", "corrections"):
        code = code_of(mechanism, name)
        function, length = function_by_operations(code, 2, lambda each: each)
        found = np.zeros(2 * len(code.results))
        pivot = function(0.0, np.array([gains, gains]).T, state, found, np.zeros(length), 1)
        expected = state_function(mechanism, name, np)([0.0, *gains, *state[:, 1::2].ravel()])
        *results, least = *expected[: len(code.results)], min(expected[len(code.results) :])
        # sums may be taken in another order: what is left of a small pivot has lost about that factor of its digits
        assert found[1::2] == pytest.approx(results, abs=1e-14 / least * max(map(abs, results)))
        assert pivot == pytest.approx(least, rel=1e-14 / least)
        assert not found[::2].any()


@pytest.mark.slow
def test_a_chain_twice_as_long_takes_twice_the_arithmetic() -> None:
    """Its matrices are banded: entries that are zero are not computed."""
    short, long = (code_of(chain(count), "accelerations") for count in (12, 24))
    assert len(long.assignments) < 2.2 * len(short.assignments)
    of_short, of_long = (operations(code)[0] for code in (short, long))
    assert len(of_long) < 2.2 * len(of_short)
