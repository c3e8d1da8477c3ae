"""Steps of second-order and implicit schemes, against equations iterated plainly and against P(z) itself."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.mechanism import (
    Mechanism,
    compiled_mechanism,
    load_scene,
    march,
    parse_scene,
    perturbed_state,
    simulate,
    states_needed,
)
from bezstab.methods import Method, SecondOrder, closed_loop_at, lookup
from bezstab.units import feedback_gains
from tests.mechanism.test_scenes import pendulum
from tests.mechanism.test_second_order_memory import LEAPFROG, STOERMER
from tests.methods.kinds import IMPLICIT, SECOND_ORDER
from tests.reference.plain_second_order import FloatArray

H = 1e-3  # s
RUN_HERE = [*SECOND_ORDER, *IMPLICIT]


def straight_line() -> Mechanism:
    """Return a body on a line: its distance c from it obeys c'' = -2 alpha c' - beta^2 c exactly."""
    rail = {"type": "point-on-line", "bodies": ["ground", "bob"], "direction": [1.0, 0.0]}
    rail |= {"points": [[0.0, 0.0], [0.0, 0.0]]}
    initial = {"position": {"bob.x": 0.3}, "velocity": {"bob.x": 0.1}}
    return compiled_mechanism(parse_scene({**pendulum(), "joint": [rail], "initial": initial}))


@pytest.mark.parametrize(("alpha_hat", "beta_hat"), [("1/2", "3/10"), ("1/5", "1/10")])
@pytest.mark.parametrize("name", RUN_HERE)
@pytest.mark.slow_except("rkn4-1/5-1/10")
def test_a_linear_constraint_follows_the_recursion_of_the_characteristic_polynomial(
    name: str, alpha_hat: str, beta_hat: str
) -> None:
    follows_its_recursion(lookup(name), alpha_hat, beta_hat)


@pytest.mark.parametrize(
    "name", ["implicit-euler", "trapezoid", "bdf2", "sdirk2", "radau3", "gauss4", "hht", "newmark(1/4,1/2)"]
)
def test_so_does_it_with_feedback_that_no_explicit_method_bears(name: str) -> None:
    follows_its_recursion(lookup(name), "40", "900")


@pytest.mark.parametrize(("name", "scheme"), [("leapfrog", LEAPFROG), ("Stoermer", STOERMER)])
def test_so_do_recipes_with_helpers_and_with_a_position_ahead(name: str, scheme: SecondOrder) -> None:
    follows_its_recursion(Method(name, scheme, "constructed"), "1/2", "3/10")


@pytest.mark.parametrize("name", ["bdf3", "verlet-half", "hht", "sdirk2"])
def test_a_step_of_several_h_has_poles_of_its_own(name: str) -> None:
    follows_its_recursion(lookup(f"{name}@3/2"), "1/5", "1/10")


def follows_its_recursion(method: Method, alpha_hat: str, beta_hat: str) -> None:
    """Hold c along a run against P: sum p_k c_(n + k) = 0 with its exact coefficients."""
    mechanism, point = straight_line(), (Fraction(alpha_hat), Fraction(beta_hat))
    gains = feedback_gains(float(point[0]), float(point[1]), H)
    multiple = float(method.step_multiple)
    run = simulate(mechanism, method, H, 40 * H * multiple, gains, perturbed_state(mechanism, 1.0))
    assert run.failure is None
    coefficients = np.array([float(c) for c in closed_loop_at(method, *point)])
    while not coefficients[0]:  # roots at zero need no memory
        coefficients = coefficients[1:]
    c = run.q[states_needed(method) + 1 :, 1]  # behind the start, whose steps are another method's
    windows = np.lib.stride_tricks.sliding_window_view(c, len(coefficients))
    left_over = np.abs(windows @ coefficients)
    # rounding of c itself, of the accelerations h^2 (2 alpha cdot + beta^2 c), and of the velocities among them
    size = np.abs(coefficients).sum() * np.abs(windows).max(axis=1)
    assert (left_over <= 1e-11 * size + 1e-13 * np.abs(coefficients).sum()).all()


def test_a_step_knows_the_times_of_its_evaluations() -> None:
    """Of a driven coordinate, whose acceleration depends on time alone: f at the times that the textbooks say."""
    driver = {"type": "driver", "coordinate": "bob.x", "rate": 2.0, "amplitude": 0.5, "frequency": 3.0}
    initial = {"position": {"bob.y": 0.0}, "velocity": {"bob.y": 0.0}}
    mechanism = compiled_mechanism(parse_scene({**pendulum(), "joint": [driver], "initial": initial}))
    h = 0.1

    def f(t: float) -> float:
        return -0.5 * 9 * float(np.sin(3 * t))

    def velocity_steps(name: str) -> FloatArray:
        run = simulate(mechanism, lookup(name), h, 1.0, (0.0, 0.0))
        return np.asarray(np.diff(run.v[:, 0]) / h)

    starts = h * np.arange(10)
    verlet = [(f(t) + f(t + h)) / 2 for t in starts]
    for name in ("verlet-half", "verlet-old", "average-acceleration", "trapezoid"):
        assert velocity_steps(name) == pytest.approx(np.array(verlet), abs=1e-12)
    assert velocity_steps("implicit-midpoint") == pytest.approx(np.array([f(t + h / 2) for t in starts]), abs=1e-12)
    assert velocity_steps("stable-pd") == pytest.approx(np.array([f(t + h) for t in starts]), abs=1e-12)
    simpson = [(f(t) + 4 * f(t + h / 2) + f(t + h)) / 6 for t in starts]
    assert velocity_steps("RK4") == pytest.approx(np.array(simpson), abs=1e-12)
    assert velocity_steps("radau3") == pytest.approx(
        np.array([0.75 * f(t + h / 3) + 0.25 * f(t + h) for t in starts]), abs=1e-12
    )


@pytest.mark.parametrize("name", ["verlet-predicted", "trapezoid", "bdf3", "radau3", "hht"])
def test_a_batch_is_as_many_single_runs(name: str) -> None:
    mechanism, method = compiled_mechanism(load_scene("slider_crank")), lookup(name)
    q, v = perturbed_state(mechanism, 1e-3)
    two_alpha, beta_squared = np.array([100.0, 200.0, 300.0]), np.array([1e4, 2e4, 4e4])
    state = np.concatenate([q, v])[:, np.newaxis]
    *_, block = march(mechanism, method, H, (two_alpha, beta_squared), state, "rk4", 30)
    together = block.states[-1]
    for k in range(3):
        alone = simulate(mechanism, method, H, 30 * H, (float(two_alpha[k]), float(beta_squared[k])), (q, v))
        # each iteration ends within 1e-13 of the sizes, and a velocity is that over h
        assert together[:, k] == pytest.approx([*alone.q[-1], *alone.v[-1]], abs=1e-10)
