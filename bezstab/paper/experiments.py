"""One run of the paper's slider-crank (section 5.2), as its tables and figures need it."""

from dataclasses import dataclass

import numpy as np

from bezstab.mechanism import (
    Observation,
    Start,
    Trajectory,
    compiled_mechanism,
    load_scene,
    observe,
    perturbed_state,
    simulate,
)
from bezstab.methods import Method, lookup
from bezstab.stability import FloatArray, dominant_pole
from bezstab.units import feedback_gains

STEP = 1e-3  # s, of every method of sections 5.2.2 and 5.2.3 (RK4@5 makes one step of 5 ms in five of these)
DURATION = 10.0  # s, of Tables 5 and 6
START_NAMES: dict[Start, str] = {"euler": "explicit Euler", "rk4": "RK4"}
"""How a multistep method gets its first steps: the paper does not say, and without feedback it decides who wins."""


@dataclass(frozen=True)
class Experiment:
    """One run of the slider-crank at a point of the plane, with steps of h (s), and what its constraints did."""

    trajectory: Trajectory
    observation: Observation
    h: float
    alpha_hat: float
    beta_hat: float
    start: Start

    @property
    def method(self) -> Method:
        """The integration method."""
        return self.trajectory.method

    @property
    def t(self) -> FloatArray:
        """The times of the run (s), of shape (steps + 1,)."""
        return self.trajectory.t

    @property
    def c(self) -> FloatArray:
        """The first constraint (m) at these times; the paper lets it stand for all (section 5.2.1)."""
        first: FloatArray = self.observation.c[:, 0]
        return first

    @property
    def cdot(self) -> FloatArray:
        """The first constraint's derivative (m/s) at these times."""
        first: FloatArray = self.observation.cdot[:, 0]
        return first

    @property
    def failure(self) -> str | None:
        """When and why the run ended early; None if it did not."""
        return self.trajectory.failure

    @property
    def pole(self) -> complex:
        """The predicted dominant pole."""
        return complex(dominant_pole(self.method, self.alpha_hat, self.beta_hat))

    def largest(self, begin: float, end: float, rate: bool = False) -> float:
        """Return the largest |c_1| (m), or with `rate` the largest |d c_1 / dt| (m/s), between two times (s)."""
        between = (self.t >= begin) & (self.t <= end)
        return float(np.abs((self.cdot if rate else self.c)[between]).max())


def experiment(
    method: str,
    alpha_hat: float = 0.0,
    beta_hat: float = 0.0,
    *,
    h: float = STEP,
    duration: float = DURATION,
    start: Start = "rk4",
    kick: float = 0.0,
) -> Experiment:
    """Return a run of `duration` (s) with steps of h (s) from the scene's initial state, c_1 moved by `kick` (m)."""
    mechanism = compiled_mechanism(load_scene("slider_crank"))
    gains = feedback_gains(alpha_hat, beta_hat, h)
    trajectory = simulate(mechanism, lookup(method), h, duration, gains, perturbed_state(mechanism, kick), start)
    observation = observe(mechanism, trajectory.t, trajectory.q, trajectory.v, *gains)
    return Experiment(trajectory, observation, h=h, alpha_hat=alpha_hat, beta_hat=beta_hat, start=start)
