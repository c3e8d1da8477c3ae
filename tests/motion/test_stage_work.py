"""The torque of stages on mechanisms: what it adds to the energy is h^2 sum_j d_j kappa . lambda_j a step."""

import numpy as np
import pytest
from numpy.typing import NDArray

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.generated_code import accelerations
from bezstab.mechanism.observation import observe
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.mechanism.start import constraint_jacobian
from bezstab.methods.registry import lookup

H, IMAGINARY = 1e-3, 1e-30
GAINS = [(10.0, 10.0), (30.0, 30.0), (30.0, 60.0), (100.0, 100.0)]
"""alpha and beta, 1/s."""


def stage_work(run: Simulation, alpha: float, beta: float) -> float:
    """Return the sum over a run of midpoint steps, whose d = (-1/2, 1/2), from its own stages."""
    mechanism, q, v, t = run.mechanism, run.q[:-1], run.v[:-1], run.t[:-1]
    gains = (2 * alpha, beta**2)
    a = np.array([accelerations(mechanism, *state) for state in zip(t, *gains_of(gains, len(t)), q, v, strict=True)])
    first = observe(mechanism, t, q, v, *gains).multipliers
    second = observe(mechanism, t + H / 2, q + H / 2 * v, v + H / 2 * a, *gains).multipliers
    kappa = np.array(
        [
            constraint_jacobian(mechanism, at, place + 1j * IMAGINARY * rate).imag @ rate / IMAGINARY
            for at, place, rate in zip(t, q, v, strict=True)
        ]
    )
    return float(H**2 / 2 * (kappa * (second - first)).sum())


def gains_of(gains: tuple[float, float], count: int) -> NDArray[np.float64]:
    return np.repeat(np.array(gains)[:, np.newaxis], count, axis=1)


@pytest.mark.parametrize("name", ["RK2", "SYM", "B4"])
@pytest.mark.parametrize(
    ("scene", "duration"),
    [
        ("four_bar", 2.0),
        pytest.param("slider_crank_light", 2.0, marks=pytest.mark.slow),
        pytest.param("slider_crank_300rpm", 0.5, marks=pytest.mark.slow),
    ],
)
def test_truncation_multipliers_and_stages_are_all_there_is(scene: str, duration: float, name: str) -> None:
    """What is left of the drift is the same at all gains, to 3 % of what the feedback adds to it."""
    mechanism = compiled_mechanism(load_scene(scene))
    by_feedback, left = [], []
    for alpha, beta in GAINS:
        run = simulated(
            mechanism, lookup(name), h=H, duration=duration, alpha_hat=2 * alpha * H, beta_hat=(beta * H) ** 2
        )
        of_stages = stage_work(run, alpha, beta) if name == "RK2" else 0.0
        by_feedback.append(run.multiplier_work[-1] + of_stages)
        left.append(run.energy_drift[-1] - by_feedback[-1])
    assert np.ptp(left) < 0.03 * np.ptp(by_feedback)
