"""A run together with what its constraints did: what `simulate` on the command line and in Python shows."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import get_args

import numpy as np

from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.observation import (
    FloatArray,
    Observation,
    energy_balance,
    multiplier_work,
    observe,
    singular_passages,
)
from bezstab.mechanism.programs import Steps, even_steps
from bezstab.mechanism.runner import Start, Trajectory, simulate_steps
from bezstab.mechanism.start import perturbed_state, steady_velocity
from bezstab.methods.schemes import Method, check_one_step
from bezstab.stabilising import NOTHING, AfterStep, Stabilise, held_by
from bezstab.units import check_step, feedback_gains
from bezstab.words import point_words

LAST_STEP = 1e-9  # of the shortest step: a rest of the duration that is rounding
MOST_STEPS = 10**8
"""Of one run, which keeps its whole history: 10 GB and an hour for the slider-crank."""


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Trajectory, Observation):
    """A run at one point of the plane, with steps of h (s), and what its constraints did along it; SI units.

    t has shape (times,), q and v (times, coordinates), c, cdot and multipliers (times, constraints). Of energy and
    work, (times,): `driver_work` is what the drivers have put in since the start, `force_work` what constant forces and
    torques have put in and dampers taken out, and `energy_drift` what no work explains, an error: `multiplier_work` is
    the part that the constraint forces do on it. `failure` says when and why the run ended early; None if it did not.
    """

    driver_work: FloatArray
    force_work: FloatArray
    energy_drift: FloatArray
    multiplier_work: FloatArray
    h: float
    alpha_hat: float
    beta_hat: float

    @property
    def singular_times(self) -> FloatArray:
        """The times (s) nearest to singular configurations that the run went through, where a motion can branch."""
        return self.t[singular_passages(self.pivots)]

    @property
    def stabilise(self) -> Stabilise:
        """What holds the constraints."""
        return held_by(self.after, feedback=bool(self.alpha_hat or self.beta_hat))

    def __repr__(self) -> str:
        run = f"{self.mechanism.scene.name}, {self.method.name}"
        ended = ", failed" if self.failure else ""
        point = point_words(self.alpha_hat, self.beta_hat, self.h)
        return f"Simulation({point}: {run}, {len(self.t)} times, to t = {self.t[-1]:.6g} s{ended})"


def check_duration(duration: float, whole_step: float) -> None:
    """Raise InputError unless a duration (s) is a number of a method's own steps (s) that a run can take."""
    if not whole_step / 2 < duration < math.inf:
        raise InputError(f"--time {duration:g} s: expected at least one step of {whole_step:g} s")
    if duration > MOST_STEPS * whole_step:
        raise InputError(f"--time {duration:g} s: expected at most {MOST_STEPS:g} steps of {whole_step:g} s")


def simulated(
    mechanism: Mechanism,
    method: Method,
    *,
    h: float,
    duration: float,
    alpha_hat: float,
    beta_hat: float,
    perturb: float = 0.0,
    start: Start = "rk4",
    after: AfterStep = NOTHING,
    sequence: Sequence[float] = (),
    hold: bool = False,
) -> Simulation:
    """Return a run over `duration` (s) from the scene's initial state, its first constraint off by `perturb` (m).

    h (s) is the user's step, a method's own is its step multiple of that. What is done `after` each step goes with
    alpha_hat = beta_hat = 0. A `sequence` has the lengths (s) of steps that are taken over and over, until the duration
    is reached: alpha_hat and beta_hat belong to a step of h, and the alpha and beta that they are stay as they are;
    with `hold` alpha_hat and beta_hat stay, and alpha and beta follow the steps. Work and drift of energy are then
    integrated by the trapezoidal rule.
    InputError for a scene that cannot start, an h outside 1e-100 to 1e100 s, a duration below a step or above 1e8 of
    them, another `start`, a sequence with a method of several steps, and as `memory`; NumericalError where the scene
    cannot be perturbed; what goes wrong on the way is the run's `failure`. Paper Eqs 6 to 9.
    """
    check_step(h)
    if start not in get_args(Start):
        raise InputError(f"start {start!r}: expected {', '.join(get_args(Start))}")
    multiple = float(method.step_multiple)
    check_duration(duration, min(sequence, default=h) * multiple)
    constant = feedback_gains(alpha_hat, beta_hat, h)
    if sequence:
        check_one_step(method)
        lengths = _lengths([step * multiple for step in sequence], duration)
        of_steps = [feedback_gains(alpha_hat, beta_hat, step / multiple) if hold else constant for step in lengths]
        gains = np.array([*of_steps, of_steps[-1]])  # at the end, those of the step that led to it
        steps = Steps(np.append(0.0, np.cumsum(lengths)), lengths, gains[:, :, np.newaxis])
    else:
        steps = even_steps(h * multiple, round(duration / (h * multiple)), constant)
    q, v = perturbed_state(mechanism, perturb)
    if start == "steady":
        v = steady_velocity(mechanism, method, float(steps.lengths[0]) / multiple, q, v)
    run = simulate_steps(mechanism, method, steps, (q, v), start, after=after)
    times = len(run.t)
    observation = observe(mechanism, run.t, run.q, run.v, *steps.gains[:times, :, 0].T)
    apart = steps.lengths[: times - 1] if sequence else h * multiple
    driver_work, force_work, energy_drift = energy_balance(observation, apart)
    return Simulation(
        **vars(run),
        **vars(observation),
        driver_work=driver_work,
        force_work=force_work,
        energy_drift=energy_drift,
        multiplier_work=multiplier_work(observation),
        h=h,
        alpha_hat=alpha_hat,
        beta_hat=beta_hat,
    )


def _lengths(sequence: Sequence[float], duration: float) -> FloatArray:
    """Return the steps (s) of a run: those of the sequence, over and over, until the duration (s) is reached."""
    taken = []
    for step in cycle(sequence):
        if duration <= LAST_STEP * min(sequence):
            break
        taken.append(step)
        duration -= step
    return np.array(taken)
