"""Orders of steps before rounding ends their descent, and the text of generated accelerations."""

import math
import re
from functools import cache
from typing import Any

import mpmath as mp
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
from bezstab.mechanism.compiled_stepping import _by_operations, take_operations
from bezstab.mechanism.generated_code import CODES, acceleration_code, operations, state_source
from bezstab.methods import REGISTRY, accuracy, lookup, steps
from tests.evidence.samples import of_campaign
from tests.mechanism.test_scenes import pendulum
from tests.reference.one_coordinate_motion import DIGITS, distance, shared_times, shown_order, slider_crank_states
from tests.reference.precise_runs import precise_run

CALL = re.compile(r"(\w+)\(")


@cache
def exact_states(rate: float, duration: float, count: int) -> list[Any]:
    """Return the slider-crank's states at the first twelve of so many steps."""
    with mp.workdps(DIGITS):
        times = [duration * mp.mpf(k) / count for k in range(12)]
    return slider_crank_states(rate, times)


@cache
def exact_angles(rate: float, duration: float) -> list[Any]:
    return [state[0] for state in slider_crank_states(rate, shared_times(duration))]


HIGH_ORDERS = [name for name in REGISTRY if accuracy(lookup(name))[0] > 4]
"""Methods whose order float64 and a start of order four do not show; tests/mechanism/test_runner.py has the others."""


@pytest.mark.promise("Orders of runs with α and β fixed", measured="0.1")
@pytest.mark.parametrize("name", ["AB4", "B12", *of_campaign(HIGH_ORDERS, ["AB8", "dopri5", "am5"])])
@pytest.mark.slow_except("AB4")
def test_with_alpha_and_beta_fixed_a_method_keeps_its_order(name: str) -> None:
    """All from exact first values and in 30 digits: float64 ends the descent of AB7 and AB8 before 0.1 is reached."""
    method, mechanism = lookup(name), compiled_mechanism(load_scene("slider_crank_300rpm"))
    rate, duration, gains = mechanism.scene.velocity["crank.theta"], 0.04, (20, 100)  # a fifth of a turn
    errors = []
    for count in (100, 200):  # twelve steps of 100 are already short
        first = exact_states(rate, duration, count)[: steps(method)]
        with mp.workdps(DIGITS):
            h = mp.mpf(duration) / count
        later = precise_run(mechanism, method, h, gains, first, count + 1 - len(first))
        angles = [state[0] for state in [*first, *later]]
        errors.append(distance(angles, exact_angles(rate, duration)))
    # 0.1 is the promise; the next term of the error moves the measured order by 0.07 at most (B12, AB7)
    assert shown_order(errors) == pytest.approx(accuracy(method)[0], abs=0.1)


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


def test_generated_source_is_plain_assignments() -> None:
    """Arithmetic on named variables only: no calls but sin, cos and least, no containers but those handed out."""
    code = acceleration_code(compiled_mechanism(load_scene("slider_crank")).equations)
    called = set(CALL.findall(state_source(code, [*code.results, code.least_pivot]))) - {"found"}
    assert called <= {"sin", "cos", "least"}


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
            function = _by_operations(operations(code, places), n, 2, take_operations)
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
