"""One run of the paper's slider-crank (section 5.2), and what tables and figures read off it."""

import numpy as np

from bezstab.mechanism import Simulation, Start, compiled_mechanism, load_scene, simulated
from bezstab.methods import lookup
from bezstab.stability import dominant_pole

STEP = 1e-3  # s, of every method of sections 5.2.2 and 5.2.3 (RK4@5 makes one step of 5 ms in five of these)
DURATION = 10.0  # s, of Tables 5 and 6
START_NAMES: dict[Start, str] = {"euler": "explicit Euler", "rk4": "RK4"}
"""How a multistep method gets its first steps: the paper does not say, and without feedback it decides who wins."""


def experiment(
    method: str,
    alpha_hat: float = 0.0,
    beta_hat: float = 0.0,
    *,
    h: float = STEP,
    duration: float = DURATION,
    start: Start = "rk4",
    kick: float = 0.0,
) -> Simulation:
    """Return a run of `duration` (s) with steps of h (s) from the scene's initial state, c_1 moved by `kick` (m)."""
    return simulated(
        compiled_mechanism(load_scene("slider_crank")),
        lookup(method),
        h=h,
        duration=duration,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
        perturb=kick,
        start=start,
    )


def pole(run: Simulation) -> complex:
    """Return the predicted dominant pole of a run."""
    return complex(dominant_pole(run.method, run.alpha_hat, run.beta_hat))


def largest(run: Simulation, begin: float, end: float, rate: bool = False) -> float:
    """Return the largest |c_1| (m), or with `rate` the largest |d c_1 / dt| (m/s), between two times (s).

    The paper lets the first constraint stand for all (section 5.2.1).
    """
    between = (run.t >= begin) & (run.t <= end)
    return float(np.abs((run.cdot if rate else run.c)[between, 0]).max())
