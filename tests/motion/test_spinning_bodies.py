"""A body that spins about a pin, against a loop that steps it as each class of engine does, and first orders."""

import cmath

import numpy as np
import pytest

from bezstab.engines.conversions import EnergyClass
from bezstab.motion.spinning_bodies import spin_change

MASS, INERTIA = 1.0, 0.5
ETA = MASS / (INERTIA + MASS)
"""The pin is 1 m from the centre of mass."""


def impulse(error: complex, arm: complex) -> complex:
    """Return the impulse at the pin that changes its velocity, or place, by so much."""
    along = error / arm
    return (along.real * MASS + 1j * along.imag / (1 / MASS + abs(arm) ** 2 / INERTIA)) * arm


def rates(energy_class: EnergyClass, a: float, b: float, theta: float, steps: int) -> list[float]:
    """Return the rate (radians a step) before each step, h = 1, from a consistent start."""
    arm, place, rate = 1 + 0j, -1 + 0j, theta
    velocity = -1j * rate * arm
    seen = []
    for _ in range(steps):
        seen.append(rate)
        if energy_class == "projected":
            moved, turned = place + velocity, rate
            new_arm = arm * cmath.exp(1j * rate)
            for _ in range(1 if a != 1 else 30):
                push = impulse(-a * (moved + new_arm), new_arm)
                moved, turn = moved + push / MASS, (new_arm.conjugate() * push).imag / INERTIA
                turned, new_arm = turned + turn, new_arm * cmath.exp(1j * turn)
            velocity, rate, place, arm = moved - place, turned, moved, new_arm
            continue
        of_pin, error = velocity + 1j * rate * arm, place + arm
        wanted = 0j if energy_class == "beside" else (1 - a) * of_pin - b * error
        if energy_class == "acceleration":
            wanted += rate**2 * arm
        push = impulse(wanted - of_pin, arm)
        velocity, rate = velocity + push / MASS, rate + (arm.conjugate() * push).imag / INERTIA
        place, arm = place + velocity, arm * cmath.exp(1j * rate)
        if energy_class == "beside":
            for _ in range(30):
                push = impulse(-(place + arm), arm)
                place, arm = place + push / MASS, arm * cmath.exp(1j * (arm.conjugate() * push).imag / INERTIA)
    return seen


@pytest.mark.parametrize(
    ("energy_class", "a", "b"),
    [
        ("acceleration", 1.0, 0.2),
        ("acceleration", 0.3, 0.1),
        ("bias", 1.0, 0.2),
        ("bias", 1.0, 0.8),
        ("bias", 0.9997, 0.4999),
        ("beside", 1.0, 1.0),
        ("projected", 1.0, 1.0),
        ("projected", 0.5, 0.5),
    ],
)
def test_it_is_what_a_loop_does_once_the_start_has_died(energy_class: EnergyClass, a: float, b: float) -> None:
    for theta in (0.02, 0.05):
        seen = np.array(rates(energy_class, a, b, theta, 202))[150:]
        rate = float(seen[0])
        for _ in range(51):
            rate *= 1 + ETA * spin_change(energy_class, a, b, rate)
        assert np.log(rate / seen[0]) == pytest.approx(np.log(seen[-1] / seen[0]), rel=0.03)  # the next order of theta
