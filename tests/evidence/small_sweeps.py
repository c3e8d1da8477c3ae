"""Sweeps of a few runs of the light slider-crank, made once for all tests that look at them."""

from fractions import Fraction
from functools import cache

from bezstab.evidence import ReferenceRun, Run, Sweep, measured_runs, reference_run, swept_runs
from bezstab.mechanism import load_scene
from bezstab.methods import lookup

SCENE = "slider_crank_light"
DURATION = 2.0  # s: in the first one AB4 shows the error of its RK4 start, of order 2
SOFT = (50.0, 50.0)
"""alpha and beta in 1/s."""

OMEGA = Fraction(143, 10)
"""1/s: the rate of its motion, for which points are chosen otherwise."""


@cache
def reference() -> ReferenceRun:
    """Return the motion that every sweep is compared with, known to 1e-13; it takes longer than most runs do."""
    return reference_run(load_scene(SCENE), 2e-3, DURATION)


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
