"""The third map, against runs of a mass that goes round a circle, and against the laws of the multiplier's work."""

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.methods.orders import accuracy
from bezstab.methods.registry import REGISTRY, lookup
from bezstab.methods.rotation_torque import stage_torque
from bezstab.motion.modulated_circle import motion_energy, steps_to_breakdown

FloatArray = NDArray[np.float64]
Field = Callable[[FloatArray, FloatArray], FloatArray]

STEPS = 160
"""In a revolution of the runs: theta = 0.039."""

THETA = 2 * np.pi / STEPS


def symplectic_euler(field: Field, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    v = v + field(q, v)
    return q + v, v


def heun(field: Field, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    a = field(q, v)
    b = field(q + v, v + a)
    return q + v + a / 2, v + (a + b) / 2


def midpoint(field: Field, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    half = v + field(q, v) / 2
    return q + half, v + field(q + v / 2, half)


PLAIN = {"SYM": symplectic_euler, "heun": heun, "RK2": midpoint}


def held(alpha_hat: float, beta_hat: float, strength: float = 0.0) -> Field:
    """Return the acceleration of the mass, with h = 1, which a force of that strength moves along the circle."""

    def field(q: FloatArray, v: FloatArray) -> FloatArray:
        square, angle = q @ q, np.arctan2(q[1], q[0])
        pull = (v @ v + alpha_hat * q @ v + beta_hat * (square - 1) / 2) / square
        force = strength * np.cos(angle) / square
        return np.asarray(force * np.array([-q[1], q[0]]) - pull * q)

    return field


def run(name: str, alpha_hat: float, beta_hat: float, modulation: float) -> tuple[float, float, float]:
    """Return the mean rate of a run (radians a step), the modulation, and the moment of momentum that a step adds.

    This is the slope of what is no function of the place on the circle: the moment that would hold the rate.
    """
    strength = modulation * THETA**2
    field = held(alpha_hat, beta_hat, strength)
    states = np.zeros((14 * STEPS, 4))
    q, v = np.array([1.0, 0.0]), np.array([0.0, THETA])
    for state in states:
        state[:2], state[2:] = q, v
        q, v = PLAIN[name](field, q, v)
    x, y, vx, vy = states[8 * STEPS :].T  # without what the start has made
    angle, momentum = np.unwrap(np.arctan2(y, x)), x * vy - y * vx
    places = [part(k * angle) for k in range(1, 5) for part in (np.cos, np.sin)]
    columns = np.stack([np.arange(len(x)), np.ones_like(x), *places], axis=1)
    moment = np.linalg.lstsq(columns, momentum, rcond=None)[0][0]
    rate = (angle[-1] - angle[0]) / (len(angle) - 1)
    return float(rate), float(strength / rate**2), float(moment)


@pytest.mark.parametrize(("alpha_hat", "beta_hat"), [(0.3, 0.1), (0.8, 0.2)])
@pytest.mark.parametrize("name", PLAIN)
def test_it_predicts_runs(name: str, alpha_hat: float, beta_hat: float) -> None:
    # what varies shows beside the torque of stages; midpoint's next terms are larger
    rate, modulation, moment = run(name, alpha_hat, beta_hat, 0.05 if name == "heun" else 0.02)
    predicted = motion_energy(lookup(name), alpha_hat, beta_hat, rate, modulation).gained
    # the next terms: of fourth order in the modulation, and that the rate itself grows while it is measured
    assert moment == pytest.approx(float(predicted) * rate**2 / 2, rel=0.005)


@pytest.mark.parametrize("name", REGISTRY)
def test_a_uniform_rotation_gains_what_the_stages_torque_says(name: str) -> None:
    method, theta = lookup(name), 0.015
    multiple = float(method.step_multiple)
    for a, b in ((Fraction(1), Fraction(1, 4)), (Fraction(4, 5), Fraction(1, 3))):
        found = stage_torque(method, (a, b))
        point = float(a) / multiple, float(b) / multiple**2
        rotation = float(motion_energy(method, *point, theta / multiple, modulation=0).gained)
        leading = 2 * float(found.coefficient) * theta ** ((found.power or 1) - 1)
        assert rotation == pytest.approx(leading, rel=0.01, abs=5e-13)  # rounding of a step, 1e-16, over theta^2 / 2


@pytest.mark.slow
@pytest.mark.parametrize("theta", [0.03, 0.05, 0.09])
@pytest.mark.parametrize(("alpha_hat", "beta_hat"), [(2.0, 1.0), (1.0, 0.25), (0.5, 0.0625)])
def test_the_torque_of_midpoint_foretells_when_a_rotation_breaks_down(
    alpha_hat: float, beta_hat: float, theta: float
) -> None:
    q, v, count = np.array([1.0, 0.0]), np.array([0.0, theta]), 0
    while v @ v < 1:
        q, v = midpoint(held(alpha_hat, beta_hat), q, v)
        count += 1
    assert count == pytest.approx(steps_to_breakdown(lookup("RK2"), alpha_hat, beta_hat, theta), rel=0.05)


ALPHA, BETA = 1.0, 2.0
"""1/s, of the laws below."""


@pytest.mark.parametrize("omega", [1.0, 3.0])
@pytest.mark.parametrize("name", ["AB2", "bdf2", "trapezoid", "B4"])
def test_the_multipliers_work_of_methods_of_order_two(name: str, omega: float) -> None:
    """(3/2) C h^2 kappa_1^2 Omega^2 alpha (beta^2 + Omega^2) / D of theory, with lambda in phase with kappa.

    The body turns at 1 rad/s.
    """
    h, constant = 0.001, float(accuracy(lookup(name))[1])
    kappa = 2.0  # v^2 changes by twice the modulation
    resonance = (BETA**2 - omega**2) ** 2 + 4 * ALPHA**2 * omega**2
    power = 1.5 * constant * h**2 * kappa**2 * omega**2 * ALPHA * (BETA**2 + omega**2) / resonance
    found = motion_energy(lookup(name), 2 * ALPHA * h, BETA**2 * h**2, h, modulation=1, harmonic=omega)
    assert float(found.multipliers) == pytest.approx(2 * power, rel=0.01)  # of omega^2 / 2, per radian at 1 rad/s


@pytest.mark.parametrize("name", ["AB2", "bdf2", "B4"])
def test_truncation_does_not_depend_on_the_feedback(name: str) -> None:
    weak, strong = (motion_energy(lookup(name), *point, 0.005) for point in ((0.02, 0.01), (0.2, 0.3)))
    assert float(weak.truncation) == pytest.approx(float(strong.truncation), rel=1e-4)
    assert float(weak.rotation) == pytest.approx(float(strong.rotation), rel=1e-4)
    assert abs(float(weak.multipliers / strong.multipliers)) > 2
    assert float(strong.gained) == pytest.approx(float(sum(strong[1:])), rel=1e-12)


def test_without_feedback_of_position_there_is_no_radius() -> None:
    assert np.isnan(motion_energy(lookup("SYM"), 1, 0, 0.01).gained)
