"""Sweeps of a few runs of the light slider-crank, made once for all tests that look at them."""

from fractions import Fraction
from functools import cache

import numpy as np

from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.accuracy_costs import Cost, ReferenceRun, Run, Sweep, measured_runs, reference_run, swept_runs

SCENE = "slider_crank_light"
DURATION = 2.0  # s: in the first one AB4 shows the error of its RK4 start, of order 2
SOFT = (50.0, 50.0)
"""alpha and beta in 1/s."""

OMEGA = Fraction(143, 10)
"""1/s: the rate of its motion, for which points are chosen otherwise."""


@cache
def reference() -> ReferenceRun:
    """Return the motion that every sweep is compared with; it takes longer than most runs do."""
    return reference_run(load_scene(SCENE), 4e-3, DURATION)


def small_sweep(name: str, steps: tuple[float, ...], point: tuple[float, float] | None = None) -> Sweep:
    """Return the sweep of one method over steps in s, with alpha = beta = 50/s or its own choice at each step."""
    return Sweep(
        method=lookup(name),
        scene=load_scene(SCENE),
        steps=steps,
        duration=DURATION,
        point=point,
        physical=point == SOFT,
        repeats=1,
        reference=reference(),
        omega=None if point else OMEGA,
    )


@cache
def swept(name: str, steps: tuple[float, ...], point: tuple[float, float] | None = None) -> list[Run]:
    """Return the runs of that sweep, the largest step first."""
    sweep = small_sweep(name, steps, point)
    return swept_runs(sweep, measured_runs(sweep))


def cost_for(error: float | None, runs: list[Run], against: Cost) -> float:
    """Return the cost at which the trajectory error falls to `error`, by a power law between neighbours; else nan."""
    assert error
    errors = [np.log(run.trajectory_error or np.nan) for run in runs[::-1]]  # ascending, as the costs fall
    costs = [np.log(run.cost(against)) for run in runs[::-1]]
    return float(np.exp(np.interp(np.log(error), errors, costs, left=np.nan, right=np.nan)))
