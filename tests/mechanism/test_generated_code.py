"""Generated accelerations and steps against the formulas, and the texts that are made of a stepper."""

import math
import re
from collections.abc import Iterator, Sequence
from functools import cache
from itertools import islice
from typing import Any

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bezstab.mechanism import (
    compiled_mechanism,
    initial_state,
    load_scene,
    march,
    parse_scene,
    perturbed_state,
    simulate,
    stepper_code,
)
from bezstab.mechanism.generated_code import (
    PART,
    AccelerationCode,
    MachineCode,
    Moved,
    Pivot,
    Sought,
    Stepper,
    Unpacked,
    Yielded,
    batch_code,
    block_source,
    compiled_source,
    generator_source,
    machine_code,
    single_step_source,
    slope_lines,
    varying_block_source,
)
from bezstab.methods import Method, accuracy, lookup, recipe, steps
from tests.mechanism.test_scenes import pendulum
from tests.methods.kinds import EXPLICIT, FEW, IMPLICIT, sampled
from tests.reference.literal_equation_9 import literal_slope
from tests.reference.one_coordinate_motion import DIGITS, distance, shared_times, shown_order, slider_crank_states
from tests.reference.plain_steps import plain_step
from tests.reference.precise_runs import precise_run

H = 1e-3  # s
CALL = re.compile(r"(\w+)\(")


@pytest.mark.parametrize("scene", ["slider_crank", "four_bar"])
@pytest.mark.parametrize("name", sampled(EXPLICIT))
def test_each_step_is_the_formula_applied_to_equation_9(scene: str, name: str) -> None:
    mechanism, method, gains = compiled_mechanism(load_scene(scene)), lookup(name), (300.0, 4e4)
    run = simulate(mechanism, method, H, (steps(method) + 5) * H, gains, perturbed_state(mechanism, 1e-4))
    states = list(np.concatenate([run.q, run.v], axis=1))
    slope = literal_slope(mechanism.equations, *gains)
    for last in range(steps(method) - 1, len(states) - 1):
        past = states[last::-1][: steps(method)]
        expected = plain_step(method, slope, run.t[last], H, past)
        # the rounding of accelerations near 100 SI units, times h and what the condition of Eq. 9 makes of it
        assert states[last + 1] == pytest.approx(expected, abs=1e-12)


def test_a_stepper_knows_the_time_within_its_step() -> None:
    """Of a driven coordinate, whose acceleration depends on the time of each stage alone."""
    driver = {"type": "driver", "coordinate": "bob.x", "rate": 2.0, "amplitude": 0.5, "frequency": 3.0}
    initial = {"position": {"bob.y": 0.0}, "velocity": {"bob.y": 0.0}}
    mechanism = compiled_mechanism(parse_scene({**pendulum(), "joint": [driver], "initial": initial}))
    for name in ("RK2", "RK4", "ABM3", "AB3"):
        method = lookup(name)
        run = simulate(mechanism, method, 0.1, 1.0, (0.0, 0.0))
        states = list(np.concatenate([run.q, run.v], axis=1))
        slope = literal_slope(mechanism.equations, 0.0, 0.0)
        for last in range(steps(method) - 1, len(states) - 1):
            past = states[last::-1][: steps(method)]
            assert states[last + 1] == pytest.approx(plain_step(method, slope, run.t[last], 0.1, past), abs=1e-14)


@cache
def exact_states(rate: float, duration: float, count: int) -> list[Any]:
    """Return the slider-crank's states at the first twelve of so many steps."""
    with mp.workdps(DIGITS):
        times = [duration * mp.mpf(k) / count for k in range(12)]
    return slider_crank_states(rate, times)


@cache
def exact_angles(rate: float, duration: float) -> list[Any]:
    return [state[0] for state in slider_crank_states(rate, shared_times(duration))]


HIGH_ORDERS = [name for name in IMPLICIT if accuracy(lookup(name))[0] > 4]
"""Implicit methods whose order float64 and a start of order four do not show; Newton's method takes long here."""


@pytest.mark.parametrize("name", sampled([*EXPLICIT, *HIGH_ORDERS], quick=[*FEW, "AB8"]))
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
    ((_, _, least_pivot),) = islice(march(mechanism, lookup("RK1"), H, (0.0, 0.0), (*q, *v), "rk4", np), 1)
    assert least_pivot == pytest.approx((pivots / np.diag(effective)).min(), rel=1e-13)


@pytest.mark.parametrize("name", ["B4", "ABM3", "RK4", "SYM"])
def test_a_batch_is_as_many_single_runs(name: str) -> None:
    mechanism, method = compiled_mechanism(load_scene("slider_crank")), lookup(name)
    q, v = perturbed_state(mechanism, 1e-3)
    two_alpha, beta_squared = np.array([100.0, 200.0, 300.0]), np.array([1e4, 2e4, 4e4])
    state = tuple(np.full(3, x) for x in (*q, *v))
    *_, (together, _, _) = islice(march(mechanism, method, H, (two_alpha, beta_squared), state, "rk4", np), 50)
    for k in range(3):
        alone = simulate(mechanism, method, H, 50 * H, (float(two_alpha[k]), float(beta_squared[k])), (q, v))
        assert [entry[k] for entry in together] == pytest.approx([*alone.q[-1], *alone.v[-1]], abs=1e-12)


def test_entries_that_are_zero_are_not_computed() -> None:
    """A chain's matrices are banded: twice the bodies take twice the arithmetic, not eight times."""

    def assignments(count: int) -> int:
        chain = {"name": "chain", "four_bar_chain": {"count": count, "length": 1.0, "mass": 1.0}}
        mechanism = compiled_mechanism(parse_scene(chain))
        return len(mechanism.acceleration_code.lines)

    assert assignments(8) < 2.2 * assignments(4)


def test_generated_source_is_plain_assignments() -> None:
    """Arithmetic on named variables only: no calls but sin, cos and least, no containers but those handed out."""
    source = stepper_code(compiled_mechanism(load_scene("slider_crank")), lookup("ABM3"))
    called = set(CALL.findall(source)) - {"run"}
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
    assert not any("import" in line for line in mechanism.acceleration_code.lines)
    assert initial_state(mechanism)[0] == pytest.approx([0.6, 0.8])


def test_steps_of_a_recipe_are_plain_assignments_without_its_names() -> None:
    hostile = "__import__"
    scheme = recipe(
        {
            "x1": "x0 + v0 + 1/2 a0",
            hostile: "v0 + 1/2 a0",
            "a1": f"acceleration(x1, 1/2 {hostile} + 1/2 v1)",
            "v1": f"{hostile} + 1/2 a1",
        }
    )
    source = stepper_code(compiled_mechanism(load_scene("slider_crank")), Method("hostile", scheme, "constructed"))
    assert hostile not in source
    assert set(CALL.findall(source)) - {"run", "residual_2", "in"} <= {
        "sin",
        "cos",
        "least",
        "solve",
    }


OPENING = ("k = 0", Unpacked(("q0", "v0"), "(q0, v0,) = state"))
OSCILLATION = Stepper(
    arguments="state, past",
    opening=OPENING,
    turn=(
        Pivot("worst_pivot", ("1.0",)),
        "f0 = v0",
        "v0 = v0 + h * -q0",
        "q0 = q0 + h * f0",
        Yielded(("q0", "v0"), ("f0",)),
    ),
)


def test_a_generator_is_the_pieces_in_their_order() -> None:
    assert generator_source(OSCILLATION).splitlines() == [
        "def run(start, h, two_alpha, beta_squared, state, past):",
        " k = 0",
        " (q0, v0,) = state",
        " while True:",
        "  worst_pivot = 1.0",
        "  f0 = v0",
        "  v0 = v0 + h * -q0",
        "  q0 = q0 + h * f0",
        "  k = k + 1",
        "  yield (q0, v0,), (f0,), worst_pivot",
    ]
    run = compiled_source(generator_source(OSCILLATION), math)["run"](0.0, 0.5, 0.0, 0.0, (1.0, 0.0), ())
    assert [next(run)[0] for _ in range(3)] == [(1.0, -0.5), (0.75, -1.0), (0.25, -1.375)]


def test_a_single_step_returns_what_the_next_begins_with() -> None:
    moved_on = Stepper("carried, solve", OPENING, (*OSCILLATION.turn, Moved("v0", "f0")))
    single_step = compiled_source(single_step_source(moved_on), math)["single_step"]
    taken, remembered = single_step(0.0, 0.5, 0.0, 0.0, (1.0, 2.0), None)
    assert taken == ((2.0, 1.5), (2.0,), 1.0)
    assert remembered == (2.0, 2.0)  # what is yielded is from before the moves


def test_a_block_is_the_stepper_with_its_states_stored() -> None:
    memory, states, pivots, reached = [1.0, 0.0], [0.0] * 6, [0.0] * 3, [0]
    block = compiled_source(block_source(OSCILLATION, 0.0, 1e9), math)["block"]
    assert block(0.0, 0.5, 0.0, 0.0, 4, 7, memory, states, pivots, reached) == 7
    assert states == [1.0, -0.5, 0.75, -1.0, 0.25, -1.375]
    assert (memory, pivots, reached) == ([0.25, -1.375], [1.0] * 3, [7])


def test_a_block_ends_at_a_state_that_python_has_to_judge() -> None:
    growth = Stepper(
        arguments="state, past",
        opening=("k = 0", Unpacked(("q0",), "(q0,) = state")),
        turn=("worst_pivot = 1.0", "q0 = 10 * q0", Yielded(("q0",), ("q0",))),
    )
    memory, states, pivots, reached = [1.0], [0.0] * 9, [0.0] * 9, [0]
    block = compiled_source(block_source(growth, 0.0, 500.0), math)["block"]
    assert block(0.0, 0.0, 0.0, 0.0, 0, 9, memory, states, pivots, reached) == 3
    assert memory == [1000.0]
    assert reached == [3]


def test_a_group_is_solved_by_what_a_stepper_is_given_for_its_number() -> None:
    """Of v = -h q at the end of the step, which a generator takes from its argument and a block by a name."""
    halving = Stepper(
        arguments="state, solve",
        opening=OPENING,
        turn=(
            Pivot("worst_pivot", ("1.0",)),
            Sought(3, known=("q0",), guesses=("v0",), found=("v0",)),
            Pivot("worst_pivot", ("worst_pivot", "worst")),
            "q0 = q0 + h * v0",
            Yielded(("q0", "v0"), ("v0",)),
        ),
    )

    def solve(situation: tuple[float, ...], known: list[float], sought: list[float]) -> float:
        start, k, h, two_alpha, beta_squared = situation
        assert (start, h, two_alpha, beta_squared) == (0.0, 0.5, 1.0, 2.0)
        sought[0] = -h * known[0]
        return 0.5 - k / 8

    run = compiled_source(generator_source(halving), math)["run"](0.0, 0.5, 1.0, 2.0, (1.0, 0.0), {3: solve})
    assert [next(run)[::2] for _ in range(2)] == [((0.75, -0.5), 0.5), ((0.5625, -0.375), 0.375)]

    def solve_in_block(
        situation: tuple[float, ...], known: list[float], sought: list[float], inverse: list[float], counts: list[int]
    ) -> float:
        inverse[0], counts[0] = known[0], counts[0] + 1
        return solve(situation, known, sought)

    block = compiled_source(block_source(halving, 0.0, 1e9), math, {"solve_3": solve_in_block})["block"]
    states, pivots, inverses, counts = [0.0] * 4, [0.0] * 2, ([0.0],), [0, 0]
    assert block(0.0, 0.5, 1.0, 2.0, 0, 2, [1.0, 0.0], states, pivots, [0], inverses, counts) == 2
    assert (states, pivots) == ([0.75, -0.5, 0.5625, -0.375], [0.5, 0.375])
    assert (inverses, counts) == (([0.75],), [2, 0])


def test_a_block_of_varying_steps_is_a_stepper_begun_anew_at_each() -> None:
    drift = Stepper(
        arguments="carried, solve",
        opening=("k = 0", Unpacked(("X_0_0", "V_0_0", "A_0_0"), ""), "h_squared = h * h"),
        turn=(
            Pivot("worst_pivot", ("1.0",)),
            "t = start + (k + 0.5) * h",
            "X_1_0 = X_0_0 + V_0_0 + A_0_0 + two_alpha + beta_squared",
            Yielded(("X_1_0", "t"), ("V_0_0 / h", "A_0_0 / h_squared")),
            Moved("X_0_0", "X_1_0"),
        ),
    )
    block = compiled_source(varying_block_source(drift, (0, 1, 2), 0.0, 1e9), math)["varying_block"]
    memory, states, pivots, reached = [1.0, 1.0, 1.0], [0.0] * 6, [0.0] * 3, [0]
    times, lengths, ratios = [0.0, 1.0, 3.0], [1.0, 2.0, 0.5], [1.0, 2.0, 0.25]
    gains = [0.0, 0.0, 100.0, 1000.0, 0.0, 0.0]
    taken = block(times, lengths, ratios, gains, [0, 2, 1], 0, 3, memory, states, pivots, reached)
    assert (taken, reached) == (3, [3])
    assert states == [3.0, 0.5, 3.0 + 2.0 + 4.0 + 1100.0, 2.0, 1109.0 + 0.5 + 0.25, 3.25]
    assert memory == [1109.75, 0.5, 0.25]


@given(st.lists(st.sampled_from([1.0, 0.5, -2.0, 0.0, -0.0, math.inf, -math.inf, math.nan]), min_size=1, max_size=5))
def test_the_least_of_a_block_is_that_of_python(values: list[float]) -> None:
    names = tuple(f"v{i}" for i in range(len(values)))
    stepper = Stepper(
        arguments="state, past",
        opening=(Unpacked(names, ""),),
        turn=(Pivot("worst_pivot", names), Yielded(("worst_pivot",), ())),
    )
    states, pivots = [0.0], [0.0]
    block = compiled_source(block_source(stepper, 0.0, 1.0), math)["block"]
    block(0.0, 0.0, 0.0, 0.0, 0, 1, values, states, pivots, [0])
    assert np.float64(pivots[0]).tobytes() == np.float64(min(values)).tobytes()


BATCH_OF = Stepper(
    arguments="state, past",
    opening=(*OPENING, Unpacked(("y_1_0", "y_1_1", "f_1_0", "f_1_1"), "(y_1_0, y_1_1,), (f_1_0, f_1_1,) = past[0]")),
    turn=(
        Pivot("worst_pivot", ("1.0",)),
        "f0 = v0",
        "f1 = -beta_squared * q0",
        "v0 = v0 + h * f1",
        "q0 = q0 + h * (1.5 * f0 + -0.5 * f_1_0)",
        Moved("f_1_0", "f0"),
        Moved("f_1_1", "f1"),
        Yielded(("q0", "v0"), ("f0", "f1")),
    ),
)
LANES = 5


def test_a_batch_is_the_stepper_for_each_run() -> None:
    code = batch_code(BATCH_OF, ["q0 + t"], LANES)
    assert code.entries == 8  # q0, v0, what is unpacked of the past, and the new slopes
    starts = [0.25 * lane for lane in range(LANES)]
    memory = starts + [1.0] * LANES + [0.0] * (6 * LANES)
    gains = np.array([[0.0] * LANES, [float(lane % 3) for lane in range(LANES)]])
    errors = [0.0] * (3 * LANES)
    batch = compiled_source(code.source, math)["batch"]
    assert batch(0.0, 0.5, gains, 1, 0, 3, memory, errors) == 3

    def one(q: float, beta_squared: float) -> Iterator[float]:
        v, before = 1.0, 0.0
        for k in range(3):
            slope = v
            v, q = v - 0.5 * beta_squared * q, q + 0.5 * (1.5 * slope - 0.5 * before)
            before = slope
            yield q + (1 + k) * 0.5

    for lane in range(LANES):
        assert errors[lane::LANES] == list(one(starts[lane], float(lane % 3)))


def test_pivots_and_what_no_run_needs_are_left_out_of_a_batch() -> None:
    source = batch_code(BATCH_OF, ["q0"], LANES).source
    assert "worst" not in source
    assert "yield" not in source


def test_a_long_acceleration_in_parts_is_the_same_to_the_last_bit() -> None:
    """And so are its slopes; here as Python, the room a list."""
    upright = {"position": {"rod0.theta": math.pi / 2}, "velocity": {"rod0.theta": -1.0}}
    links = {"count": 12, "length": 1.0, "mass": 1.0}
    mechanism = compiled_mechanism(parse_scene({"name": "chain", "four_bar_chain": links, "initial": upright}))
    whole, slopes = mechanism.acceleration_code, slope_lines(mechanism.equations)
    cut = machine_code(whole, slopes)
    assert len(cut.parts) == math.ceil(len(whole.lines) / PART) + math.ceil(len(slopes) / PART)
    others: dict[str, Any] = {"empty": lambda size: [math.nan] * size}
    for number, part in enumerate(cut.parts):
        others[f"part_{number}"] = compiled_source(part, math)[f"part_{number}"]
    size = mechanism.size
    state = [[0.1 * math.sin(7.0 * i + j) for i in range(size)] for j in range(4)]  # q, v, dq, dv

    def evaluated(acceleration: AccelerationCode, of_slopes: Sequence[str]) -> tuple[float, ...]:
        results = [f"{name}{i}" for name in ("a", "da") for i in range(size)]
        lines = [f"{name}{i} = {name}[{i}]" for name in ("q", "v", "dq", "dv") for i in range(size)]
        lines += [*acceleration.lines, *of_slopes, f"return ({', '.join([*results, *acceleration.pivots])})"]
        source = "\n ".join(["def evaluated(t, two_alpha, beta_squared, q, v, dq, dv):", *lines])
        found: tuple[float, ...] = compiled_source(source, math, others)["evaluated"](0.0, 3.0, 4.0, *state)
        return found

    assert evaluated(cut.acceleration, cut.slopes) == evaluated(whole, slopes)


def test_a_short_acceleration_is_left_as_it_is() -> None:
    code = compiled_mechanism(load_scene("slider_crank")).acceleration_code
    assert machine_code(code, ["da0 = 0.0"]) == MachineCode(code, ("da0 = 0.0",))
