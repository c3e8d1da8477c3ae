"""The runs of the paper's slider-crank (section 5.2) that its tables and figures show; each is made once."""

from functools import cache
from itertools import product

import numpy as np

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.runner import Start
from bezstab.mechanism.scene_files import load_scene
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.methods.registry import lookup
from bezstab.paper.printed import COMPARED, TABLE_5
from bezstab.stability.closed_loop import dominant_pole

STEP = 1e-3  # s, of every method of sections 5.2.2 and 5.2.3 (RK4@5 makes one step of 5 ms in five of these)
DURATION = 10.0  # s, of Tables 5 and 6

START_NAMES: dict[Start, str] = {"euler": "explicit Euler", "rk4": "RK4"}
"""How a multistep method gets its first steps: the paper does not say, and without feedback it decides who wins."""

UNSTABILIZED = ("B4", "AB4")
"""The methods of Figs. 5 and 6."""

TABLE_4 = (
    ("diverges: α̂ is negative", -0.02, 0.1),
    ("slow, without significant oscillation", 0.04, 0.0004),
    ("slow, oscillates", 0.12, 0.52),
    ("fast, hardly oscillates", 0.8, 0.16),
    ("fast, oscillates", 0.6, 0.35),
    ("diverges: both positive, outside the region", 1.5, 0.7),
)
"""The paper's six cases: what it says of each, and a point that fits. Its own numbers are lost; these are ours."""

KICK = 1e-3
"""m, of Table 4's c_1: it is about decay and growth, so there must be something that decays or grows."""

KICKS = (0.0, 1e-5, 1e-9)
"""m, of Table 5's c_1, case by case.

From a consistent start AB4 leaves nothing but rounding to decay or grow, which differs between machines. With these it
stays above that for ten seconds, and below a millimetre, where the mechanism answers linearly.
"""


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


def unstabilized_runs(steps: tuple[float, ...], duration: float) -> dict[tuple[Start, str, float], Simulation]:
    """Return the runs without feedback by start, method and step (s): until `duration` (s), or until they collapse."""
    return {
        (start, name, h): experiment(name, h=h, duration=duration, start=start)
        for start, name, h in product(START_NAMES, UNSTABILIZED, steps)
    }


@cache
def kicked_runs() -> list[Simulation]:
    """Return the six cases of Table 4, with B4."""
    return [experiment("B4", *point, duration=0.4, kick=KICK) for _, *point in TABLE_4]


@cache
def compared_runs() -> dict[tuple[tuple[str, str], str], Simulation]:
    """Return the runs of Table 5, by α̂, β̂ and method."""
    return {
        (point, name): experiment(name, *map(float, point), kick=kick)
        for (point, kick), name in product(zip(TABLE_5, KICKS, strict=True), COMPARED)
    }


def pole(run: Simulation) -> complex:
    """Return the predicted dominant pole of a run."""
    return complex(dominant_pole(run.method, run.alpha_hat, run.beta_hat))


def largest(run: Simulation, begin: float, end: float) -> float:
    """Return the largest |c_1| (m) between two times (s).

    The paper lets the first constraint stand for all (section 5.2.1).
    """
    between = (run.t >= begin) & (run.t <= end)
    return float(np.abs(run.c[between, 0]).max())
