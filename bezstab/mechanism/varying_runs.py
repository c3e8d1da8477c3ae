"""Runs whose steps vary: a sequence of step lengths, taken again and again.

Only one-step methods run so: the next state follows from the last and, with some, an acceleration stored beside it.
Inside a second-order scheme h = 1, where positions, h v and h^2 a are carried: a step r times as long as the one before
begins with r times that h v and r^2 times that h^2 a. The acceleration itself is what it was, whatever the gains do.
"""

import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.mechanism.compiled import (
    Mechanism,
    Solver,
    State,
    Step,
    compiled_single_step,
    implicit_solver,
    run_as_second_order,
)
from bezstab.mechanism.compiled_steps import Block, VaryingSteps, blocks_of_varying_steps, flat, runs_compiled
from bezstab.mechanism.energies import EnergyBalance
from bezstab.mechanism.newton_iterations import Work
from bezstab.mechanism.observation import observe
from bezstab.mechanism.runner import (
    Trajectory,
    breakdown,
    evaluation_count,
    first_turn,
    recorded_history,
    recorded_in_blocks,
)
from bezstab.mechanism.second_order_memory import POSITION, VELOCITY, memory
from bezstab.mechanism.simulation import Simulation, check_duration
from bezstab.mechanism.start import perturbed_state
from bezstab.methods import Method, check_one_step, evaluations, implicit
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
    the start. Work and drift of energy are integrated by the trapezoidal rule. InputError for a method of several
    steps, and as `simulated`.
    """
    check_one_step(method)
    check_duration(duration, min(sequence) * float(method.step_multiple))
    q, v = perturbed_state(mechanism, perturb)
    first: State = (*q.tolist(), *v.tolist())
    blown_up = breakdown(first, pivot=1.0)
    if blown_up:
        raise InputError(f"the start: {blown_up}")
    steps = _steps(method, sequence, duration, lambda step: feedback_gains(alpha_hat, beta_hat, step if hold else h))
    t = steps.times
    work = Work()
    if runs_compiled(mechanism, method, len(steps.lengths) * evaluations(method), varying=True):
        history = recorded_in_blocks(first, _march_in_blocks(mechanism, method, steps, first, work))
    else:
        history = recorded_history(first, _march(mechanism, method, steps, first, work))
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
        evaluations=evaluation_count(method, "rk4", steps_taken) + work.evaluations,
        failure=failure,
        least_pivot=history.least_pivot,
        pivot_time=float(t[history.pivot_step]),
        iterations=work.iterations if implicit(method) else None,
    )
    # at each time the gains of the step that begins there; at the last, those of the step that led to it
    at_times = np.minimum(np.arange(len(rows)), len(steps.lengths) - 1)
    two_alpha, beta_squared = steps.gains[at_times].T
    observation = observe(mechanism, times, trajectory.q, trajectory.v, two_alpha, beta_squared)
    balance = EnergyBalance(
        energy=observation.energy,
        driver_work=_integral(observation.driver_power, times),
        force_work=_integral(observation.applied_power, times),
    )
    return Simulation(
        trajectory=trajectory, observation=observation, balance=balance, h=h, alpha_hat=alpha_hat, beta_hat=beta_hat
    )


def _steps(
    method: Method, sequence: Sequence[float], duration: float, gains: Callable[[float], tuple[float, float]]
) -> VaryingSteps:
    """Return the steps of a run: those of the sequence, over and over, until the duration (s) is reached.

    `gains` has what belongs to a step of the user's, of which the method's own is its multiple.
    """
    taken = []
    left = duration
    multiple = float(method.step_multiple)
    own_sequence = [step * multiple for step in sequence]
    for step in cycle(own_sequence):
        if left <= LAST_STEP * min(own_sequence):
            break
        taken.append(step)
        left -= step
    gains_of = {length: gains(length / multiple) for length in set(taken)}
    return VaryingSteps(lengths=np.array(taken), gains=np.array([gains_of[length] for length in taken]))


def _march(mechanism: Mechanism, method: Method, steps: VaryingSteps, state: State, work: Work) -> Iterator[Step]:
    """Yield step after step, each from a time by a length with its gains, as `runner.march` does."""
    single_step = compiled_single_step(mechanism, method)
    # each length has a solver of its own: the Jacobian that it keeps is no good for others
    solvers: defaultdict[float, Solver] = defaultdict(lambda: implicit_solver(mechanism, method, math, work))
    powers = _powers_of_step(mechanism, method)
    remembered = _remembered(mechanism, method, steps, state, work)
    in_lists = (array.tolist() for array in (steps.times[:-1], steps.lengths, steps.ratios, steps.gains))
    for time, length, ratio, gains in zip(*in_lists, strict=True):
        factors = (1.0, ratio, ratio * ratio)
        remembered = tuple(factors[power] * number for power, number in zip(powers, remembered, strict=True))
        solve = solvers[length] if implicit(method) else None
        step, remembered = single_step(time, length, *gains, remembered, solve)
        yield step


def _march_in_blocks(
    mechanism: Mechanism, method: Method, steps: VaryingSteps, state: State, work: Work
) -> Iterator[Block]:
    """Yield the same steps compiled, in blocks."""
    remembered = _remembered(mechanism, method, steps, state, work)
    powers = tuple(_powers_of_step(mechanism, method))
    yield from blocks_of_varying_steps(mechanism, method, steps, powers, remembered, work)


def _remembered(
    mechanism: Mechanism, method: Method, steps: VaryingSteps, state: State, work: Work
) -> tuple[float, ...]:
    """Return what the first step begins with."""
    two_alpha, beta_squared = steps.gains[0].tolist()
    gains = (two_alpha, beta_squared)
    _, start, _ = first_turn(mechanism, method, float(steps.lengths[0]), gains, [state], [], None, math, work)
    return tuple(flat(start))


def _powers_of_step(mechanism: Mechanism, method: Method) -> list[int]:
    """Return the power of h that is a factor of each number that a step begins with."""
    scheme = run_as_second_order(method)
    if scheme is None:
        return [0] * (2 * mechanism.size)  # q and v as they are
    # the helpers that a one-step method carries are accelerations, as guesses of those that it has to solve for
    own_powers = {POSITION: 0, VELOCITY: 1}
    return [own_powers.get(quantity.name, 2) for quantity in memory(scheme).carried for _ in range(mechanism.size)]


def _integral(rates: FloatArray, times: FloatArray) -> FloatArray:
    """Return the integral from the first time to each, by the trapezoidal rule."""
    with np.errstate(all="ignore"):  # of a broken-down run's last multipliers
        parts = (rates[1:] + rates[:-1]) / 2 * np.diff(times)
    return np.concatenate([[0.0], np.cumsum(parts)])
