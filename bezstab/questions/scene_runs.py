"""A run of a scene that decides beside the prediction: do its constraints hold, and does it gain energy?

A constraint whose errors decay may still be part of a motion that the feedback pumps: so before a scene is called safe
it is run, for ten seconds or ten thousand steps, or as long as its file says.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.engines.conversions import Point
from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.observation import FloatArray, running_integral
from bezstab.mechanism.simulation import Simulation, simulated
from bezstab.methods.rotation_torque import stage_torque
from bezstab.methods.schemes import Method

USUAL_TIME = 10.0
"""s, of a scene that says nothing."""

MOST_STEPS = 10**4
"""Of a run that nobody gave a time: a second or two in Python."""

FURTHER = 4
"""Times as long a run is looked for its end that a torque of stages drives."""

MOST_GAINED = 0.1
"""Of the largest kinetic energy: a run that gains more is another motion."""

GROWN = 100.0
"""Times |c| of the first half of a run: what it is in the last tenth of one whose constraints do not hold."""

SEEN = 1e-9
"""m or rad: |c| below is rounding of a run, whatever it was before."""


@dataclass(frozen=True)
class SceneRun:
    """What a run of a scene showed, over `duration` (s).

    c_max: the largest |c| (m or rad). gained: what the energy gained beside the work of drivers and forces, as a share
    of the largest kinetic energy; negative where it lost. At the end of the run, but at its height where that is more
    than MOST_GAINED: a run may explode, and lose all of it again. by_feedback: whether most of it is the multipliers'
    work, else the method's own. breakdown: when (s) the energy becomes infinite if it goes on so, None where it does
    not. grown: whether constraints do not hold. failure: why the run ended early. decides:
    whether it says anything: past a singular configuration a motion branches by rounding. sound: whether it went
    through, with constraints that hold, and gained next to no energy.
    """

    duration: float
    c_max: float
    gained: float
    by_feedback: bool
    breakdown: float | None
    grown: bool
    failure: str | None
    decides: bool
    sound: bool


def scene_run(
    mechanism: Mechanism, method: Method, h: Fraction, point: Point, time: Fraction | float | None = None
) -> SceneRun:
    """Return what a run of `time` (s) shows, with steps of h (s) at a point (alpha_hat, beta_hat).

    Where nobody gives a time it is the scene's own, else USUAL_TIME, or MOST_STEPS if that is less. InputError for a
    time that is no number of steps, and for a scene in which nothing moves.
    """
    run_for = partial(simulated, mechanism, method, h=float(h), alpha_hat=float(point[0]), beta_hat=float(point[1]))
    usual = min(USUAL_TIME, MOST_STEPS * float(h * method.step_multiple))
    duration = float(time or mechanism.scene.duration or usual)
    run = run_for(duration=duration)
    with np.errstate(all="ignore"):  # of a run that broke down
        kinetic = run.v**2 @ mechanism.mass / 2
        own = float(np.nanmax(kinetic - np.maximum(run.energy_drift, 0.0)))  # without what it gained
    if not own > 0:
        raise InputError(f"--scene {mechanism.scene.name}: nothing moves within {duration:g} s")
    sizes, half, tenth = run.largest_c, len(run.t) // 2, max(len(run.t) // 10, 1)
    height = int(np.nanargmax(run.energy_drift))
    at = height if run.energy_drift[height] > MOST_GAINED * own else -1
    drift, by_multipliers = float(run.energy_drift[at]), float(run.multiplier_work[at])
    by_feedback = abs(by_multipliers) >= abs(drift - by_multipliers)
    breakdown = None
    grows = run.energy_drift[-1] > MOST_GAINED * own
    if grows and not by_feedback and stage_torque(method).power == 2 and not run.failure:
        longer = run_for(duration=FURTHER * duration)
        end = float(longer.t[-1])
        breakdown = end if longer.failure else _breakdown(run, kinetic)
        if breakdown < end:  # it went on: a driver keeps its rate
            breakdown = None
    gained = drift / own
    grown = bool(sizes[-tenth:].max() > max(GROWN * sizes[: half + 1].max(), SEEN))
    return SceneRun(
        duration=float(run.t[-1]),
        c_max=run.c_max,
        gained=gained,
        by_feedback=by_feedback,
        breakdown=breakdown,
        grown=grown,
        failure=run.failure,
        decides=not len(run.singular_times),
        sound=not (run.failure or grown or gained > MOST_GAINED),
    )


def _breakdown(run: Simulation, kinetic: FloatArray) -> float:
    """Return about when (s) a torque ~ omega^3, of which E' = C E^2 in the mean, makes the kinetic energy infinite."""
    rate = float(run.energy_drift[-1] / running_integral(kinetic**2, np.diff(run.t))[-1])
    last = slice(-(len(run.t) // 3), None)
    return float(run.t[last].mean() + 1 / (rate * kinetic[last].mean()))
