"""Projection: what holds after each step, what it costs, and that the order of accuracy stays."""

import math

import numpy as np
import pytest

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.generated_code import state_function
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.mechanism.start import initial_state
from bezstab.methods.orders import accuracy
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, evaluations, implicit
from bezstab.stabilising import AfterStep, after_step
from tests.mechanism.test_runner import measured_order
from tests.mechanism.test_stepping import KINDS, step_for
from tests.reference.literal_equation_9 import literal_equation_9

H = 1e-3  # s
PROJECTED, ONCE, TWICE = (after_step("projection", iterations) for iterations in (None, 1, 2))
WITHIN = 4e-12  # m, m/s: corrections of up to 1e-12 in sum are left, and constraints weigh a coordinate by some units


def scene(name: str) -> Mechanism:
    return compiled_mechanism(load_scene(name))


def projected(
    mechanism: Mechanism, method: Method, h: float, duration: float, after: AfterStep = PROJECTED
) -> Simulation:
    """Return a run that has no feedback."""
    return simulated(mechanism, method, h=h, duration=duration, alpha_hat=0.0, beta_hat=0.0, after=after)


@pytest.mark.parametrize("name", ["slider_crank", "driven_four_bar", "andrews"])
@pytest.mark.parametrize("method", KINDS)
@pytest.mark.slow
def test_after_each_step_the_constraints_hold(name: str, method: str) -> None:
    h = step_for(name)
    run = projected(scene(name), lookup(method), h, 50 * h)
    assert run.failure is None
    assert abs(run.c).max() <= WITHIN
    assert abs(run.cdot).max() <= WITHIN * max(1, abs(run.v).max())


@pytest.mark.parametrize("name", ["B4", "AB4", "ABM3", "RK4", "SYM", "trapezoid", "bdf2", "hht"])
@pytest.mark.slow
def test_the_order_of_accuracy_stays(name: str) -> None:
    """Against the motion in the crank's angle alone; RK4 loses half of its order by strong feedback."""
    order, count = accuracy(lookup(name))[0], 200 if implicit(lookup(name)) else 400
    for after in (PROJECTED, ONCE):
        assert measured_order(name, count, lambda _: (0.0, 0.0), after) == pytest.approx(order, abs=0.1)


@pytest.mark.parametrize("name", ["driven_four_bar", "andrews"])
def test_corrections_are_the_least_ones_in_the_metric_of_the_masses(name: str) -> None:
    mechanism, t, random = scene(name), 0.3, np.random.default_rng(1)
    q, v = (state + random.normal(0, 1e-3, mechanism.size) for state in initial_state(mechanism))
    found = state_function(mechanism, "corrections", math)([t, 0.0, 0.0, *q.tolist(), *v.tolist()])
    literal = literal_equation_9(mechanism, 0.0, 0.0)(t, q, v)
    of_both = np.reshape(found[: 2 * mechanism.size], (2, -1))
    for correction, error in zip(of_both, (literal.c, literal.cdot), strict=True):
        expected = np.linalg.solve(literal.matrix, np.append(0 * q, -error))[: mechanism.size]
        assert correction == pytest.approx(expected, rel=1e-9, abs=1e-11 * abs(expected).max())


@pytest.mark.parametrize("name", ["RK2", "hht"])
def test_the_cost_is_counted(name: str) -> None:
    """A projection that moves the state computes a correction twice: the second says that it is enough."""
    method, count = lookup(name), 40
    run = projected(scene("driven_four_bar"), method, H, count * H, ONCE)
    assert run.projections == 2 * count
    assert run.factorizations == run.evaluations + 2 * count
    assert implicit(method) or run.evaluations == count * evaluations(method)


def test_a_position_from_which_newtons_method_finds_none_ends_a_run() -> None:
    """The crank is driven half a revolution on in a step; so many iterations as are asked for are no promise."""
    mechanism = scene("driven_four_bar")
    run = projected(mechanism, lookup("RK1"), 0.5, 20.0)
    assert "at t = 1.5 s: projection: Newton's method for the position did not converge in 25 iterations" in str(
        run.failure
    )
    given_up = projected(mechanism, lookup("RK1"), 0.5, 1.5, TWICE)
    assert given_up.failure is None
    assert abs(given_up.c).max() > 1e-3
