"""Runs whose steps vary: a sequence of step lengths, taken again and again.

Only explicit one-step methods, Runge-Kutta and symplectic Euler, run so: their next state depends on the last alone.
"""

import math
from collections.abc import Iterator, Sequence
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.mechanism.compiled import Mechanism, State, Step, compiled_stepper, run_as_second_order
from bezstab.mechanism.energies import EnergyBalance
from bezstab.mechanism.observation import observe
from bezstab.mechanism.runner import Trajectory, breakdown, recorded_history
from bezstab.mechanism.simulation import Simulation
from bezstab.mechanism.start import perturbed_state
from bezstab.methods import Method, check_one_step, evaluations
from bezstab.units import feedback_gains

FloatArray = NDArray[np.float64]

LAST_STEP = 1e-9  # of the shortest step: a rest of the duration that is rounding


def simulated_with_steps(
    mechanism: Mechanism,
    method: Method,
    *,
    sequence: Sequence[float],
    h: float,
    duration: float,
    alpha_hat: float,
    beta_hat: float,
    hold: bool = False,
    perturb: float = 0.0,
) -> Simulation:
    """Return a run over `duration` (s) or a little more, by steps of the lengths in `sequence` (s), over and over.

    alpha_hat and beta_hat belong to a step of h (s), and the alpha and beta that they are stay as they are; with `hold`
    alpha_hat and beta_hat stay, and alpha and beta follow the steps. The first constraint is off by `perturb` (m) at
    the start. Work and drift of energy are integrated by the trapezoidal rule. InputError for a method that cannot
    change its step, and as `simulated`.
    """
    check_steps_may_vary(method)
    q, v = perturbed_state(mechanism, perturb)
    first: State = (*q.tolist(), *v.tolist())
    blown_up = breakdown(first, pivot=1.0)
    if blown_up:
        raise InputError(f"the start: {blown_up}")
    lengths = _lengths([step * float(method.step_multiple) for step in sequence], duration)
    own_steps = [length / float(method.step_multiple) if hold else h for length in lengths.tolist()]
    gains = [feedback_gains(alpha_hat, beta_hat, step) for step in own_steps]
    t = np.concatenate([[0.0], np.cumsum(lengths)])
    history = recorded_history(first, _march(mechanism, method, t.tolist(), lengths.tolist(), gains, first))
    rows = np.array(history.states, dtype=np.float64)
    steps_taken = len(rows) - 1
    failure = None
    if history.cause:
        steps_taken += 1  # the step that failed is not in the history, but was computed
        failure = f"at t = {t[steps_taken]:.6g} s: {history.cause}"
    times = t[: len(rows)]
    trajectory = Trajectory(
        mechanism=mechanism,
        method=method,
        t=times,
        q=rows[:, : mechanism.size],
        v=rows[:, mechanism.size :],
        evaluations=steps_taken * evaluations(method),
        failure=failure,
        least_pivot=history.least_pivot,
        pivot_time=float(t[history.pivot_step]),
    )
    # at each time the gains of the step that begins there; at the last, those of the step that led to it
    at_times = np.minimum(np.arange(len(rows)), len(lengths) - 1)
    two_alpha, beta_squared = np.array(gains)[at_times].T
    observation = observe(mechanism, times, trajectory.q, trajectory.v, two_alpha, beta_squared)
    balance = EnergyBalance(
        energy=observation.energy,
        driver_work=_integral(observation.driver_power, times),
        force_work=_integral(observation.applied_power, times),
    )
    return Simulation(
        trajectory=trajectory, observation=observation, balance=balance, h=h, alpha_hat=alpha_hat, beta_hat=beta_hat
    )


def check_steps_may_vary(method: Method) -> None:
    """Raise InputError unless a run of the method may change the length of its steps."""
    check_one_step(method)
    if run_as_second_order(method):
        raise InputError(f"{method.name}: steps vary in runs of explicit Runge-Kutta methods and SYM only")


def _lengths(sequence: Sequence[float], duration: float) -> FloatArray:
    """Return the steps (s) of a run: those of the sequence, over and over, until the duration (s) is reached."""
    taken = []
    left = duration
    for step in cycle(sequence):
        if left <= LAST_STEP * min(sequence):
            break
        taken.append(step)
        left -= step
    return np.array(taken)


def _march(
    mechanism: Mechanism,
    method: Method,
    times: Sequence[float],
    lengths: Sequence[float],
    gains: Sequence[tuple[float, float]],
    state: State,
) -> Iterator[Step]:
    """Yield step after step, each from a time by a length with its gains, as `runner.march` does."""
    run = compiled_stepper(mechanism, method, math)
    for time, length, (two_alpha, beta_squared) in zip(times, lengths, gains, strict=False):
        step = next(run(time, length, two_alpha, beta_squared, state, []))
        state = step[0]
        yield step


def _integral(rates: FloatArray, times: FloatArray) -> FloatArray:
    """Return the integral from the first time to each, by the trapezoidal rule."""
    with np.errstate(all="ignore"):  # of a broken-down run's last multipliers
        parts = (rates[1:] + rates[:-1]) / 2 * np.diff(times)
    return np.concatenate([[0.0], np.cumsum(parts)])
