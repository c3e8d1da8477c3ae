"""The text of generated accelerations, and what machine code makes of it where it is long."""

import math

import numpy as np
import pytest

from bezstab.mechanism import (
    Mechanism,
    compiled_mechanism,
    initial_state,
    load_scene,
    parse_scene,
    state_function,
)
from bezstab.mechanism.generated_code import (
    CODES,
    acceleration_code,
    by_operations,
    operations,
    take_operations,
)
from tests.mechanism.test_scenes import pendulum


def test_the_least_pivot_is_that_of_the_factored_matrix() -> None:
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    q, v = initial_state(mechanism)
    symbols = dict(zip(mechanism.equations.q, q, strict=True))
    jacobian = np.array(mechanism.equations.jacobian.subs(symbols), float)
    effective = jacobian @ np.diag(1 / np.array(mechanism.equations.mass, float)) @ jacobian.T
    pivots = np.diag(np.linalg.cholesky(effective)) ** 2
    *_, least_pivot = state_function(mechanism, "accelerations", math, judged=True)(
        0.0, 0.0, 0.0, q.tolist(), v.tolist()
    )
    assert least_pivot == pytest.approx((pivots / np.diag(effective)).min(), rel=1e-13)


def test_names_never_reach_the_generated_code() -> None:
    hostile = "(__import__('os').abort())"
    initial = {
        "position": {f"{hostile}.x": 0.6},
        "velocity": {f"{hostile}.x": 0.0},
        "guess": {f"{hostile}.y": 0.5},
    }
    changes = {"body__name": hostile, "joint__bodies": ["ground", hostile], "initial": initial}
    mechanism = compiled_mechanism(parse_scene(pendulum(**changes)))
    assert not any("import" in line for line in acceleration_code(mechanism.equations).lines)
    assert initial_state(mechanism)[0] == pytest.approx([0.6, 0.8])


def chain(count: int) -> Mechanism:
    """Return a chain of so many four-bars."""
    upright = {"position": {"rod0.theta": math.pi / 2}, "velocity": {"rod0.theta": -1.0}}
    links = {"count": count, "length": 1.0, "mass": 1.0}
    return compiled_mechanism(parse_scene({"name": "chain", "four_bar_chain": links, "initial": upright}))


@pytest.mark.slow
def test_single_operations_are_the_text_to_the_last_bit() -> None:
    """Of floats and, for slopes, of complex numbers; here as Python, in the second of two lanes."""
    mechanism, gains = chain(12), (3.0, 4.0)
    n = mechanism.size
    state = 0.1 * np.sin(7.0 * np.arange(4 * n)).reshape(2, -1)
    for moved in (state, state + 1e-30j * np.cos(state)):
        places: dict[str | float, int] = {}
        for name in ("accelerations", "corrections"):
            code = CODES[name](mechanism.equations)
            function = by_operations(operations(code, places), n, 2, take_operations)
            variables = np.array([key if isinstance(key, float) else 0.0 for key in places]).astype(moved.dtype)
            found = np.zeros(2 * len(code.results), moved.dtype)
            function(0.0, np.array([gains, gains]).T, moved, found, variables, 1)
            assert tuple(found[1::2]) == state_function(mechanism, name, np)(0.0, *gains, *moved[:, 1::2])
            assert not found[::2].any()


@pytest.mark.slow
def test_a_chain_twice_as_long_takes_twice_the_arithmetic() -> None:
    """Its matrices are banded: entries that are zero are not computed."""
    short, long = (acceleration_code(chain(count).equations) for count in (12, 24))
    assert len(long.lines) < 2.2 * len(short.lines)
    of_short, of_long = (operations(code, {}) for code in (short, long))
    assert len(of_long.rows) < 2.2 * len(of_short.rows)
