"""Steps of second-order and implicit schemes, against equations iterated plainly and against P(z) itself."""

from fractions import Fraction

import numpy as np
import pytest

from bezstab.mechanism.equations import Mechanism, compiled_mechanism
from bezstab.mechanism.runner import simulate, states_needed
from bezstab.mechanism.scene_files import parse_scene
from bezstab.mechanism.start import perturbed_state
from bezstab.methods.derivation import closed_loop_at
from bezstab.methods.recipes import recipe
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method
from bezstab.units import feedback_gains
from tests.mechanism.test_scenes import pendulum
from tests.methods.kinds import IMPLICIT, SECOND_ORDER

H = 1e-3  # s
RUN_HERE = [*SECOND_ORDER, *IMPLICIT]
LEAPFROG = recipe({"w": "w[0] + a0", "x1": "x0 + w", "a1": "acceleration(x1, w)", "v1": "w + 1/2 a1"})
"""The velocity half a step back is what it carries."""


def straight_line() -> Mechanism:
    """Return a body on a line: its distance c from it obeys c'' = -2 alpha c' - beta^2 c exactly."""
    rail = {"type": "point-on-line", "bodies": ["ground", "bob"], "direction": [1, 0], "points": [[0, 0], [0, 0]]}
    initial = {"position": {"bob.x": 0.3}, "velocity": {"bob.x": 0.1}}
    return compiled_mechanism(parse_scene({**pendulum(initial=initial), "joint": [rail]}))


FOLLOWED = [
    *((lookup(name), *point) for name in RUN_HERE for point in (("1/2", "3/10"), ("1/5", "1/10"))),
    # feedback that no explicit method bears
    *((lookup(name), "40", "900") for name in ("trapezoid", "bdf2", "sdirk2", "gauss4", "hht")),
    (Method("leapfrog", LEAPFROG, ""), "1/2", "3/10"),  # with a helper
    *((lookup(f"{name}@3/2"), "1/5", "1/10") for name in ("bdf3", "verlet-half", "hht", "sdirk2")),
]


@pytest.mark.parametrize(
    ("method", "alpha_hat", "beta_hat"), [pytest.param(*each, id=f"{each[0].name}-{each[1]}") for each in FOLLOWED]
)
@pytest.mark.slow
def test_a_linear_constraint_follows_the_recursion_of_the_characteristic_polynomial(
    method: Method, alpha_hat: str, beta_hat: str
) -> None:
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
    mechanism = compiled_mechanism(parse_scene({**pendulum(initial=initial), "joint": [driver]}))
    h, t = 0.1, 0.1 * np.arange(10)
    for name, times_and_weights in (
        ("verlet-half", {0: 1 / 2, 1: 1 / 2}),
        ("trapezoid", {0: 1 / 2, 1: 1 / 2}),
        ("stable-pd", {1: 1}),
        ("RK4", {0: 1 / 6, 1 / 2: 2 / 3, 1: 1 / 6}),
        ("radau3", {1 / 3: 3 / 4, 1: 1 / 4}),
    ):
        expected = sum(-4.5 * weight * np.sin(3 * (t + share * h)) for share, weight in times_and_weights.items())
        run = simulate(mechanism, lookup(name), h, 1.0, (0.0, 0.0))
        assert np.diff(run.v[:, 0]) / h == pytest.approx(expected, abs=1e-12)
