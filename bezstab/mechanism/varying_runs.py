"""Runs whose steps vary: a sequence of step lengths, taken again and again.

Only one-step methods run so: the next state follows from the last and, with some, an acceleration stored beside it.
Inside a second-order scheme h = 1, where positions, h v and h^2 a are carried: a step r times as long as the one before
begins with r times that h v and r^2 times that h^2 a. The acceleration itself is what it was, whatever the gains do.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.compiled import Mechanism
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.energies import energy_balance
from bezstab.mechanism.observation import observe
from bezstab.mechanism.registers import Steps
from bezstab.mechanism.runner import carried_quantities, checked_start, no_counts, recorded, steps_in_blocks
from bezstab.mechanism.simulation import Simulation, check_duration
from bezstab.mechanism.start import perturbed_state
from bezstab.methods import Method, check_one_step, evaluations, second_order_form
from bezstab.stabilising import NOTHING, AfterStep
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
    after: AfterStep = NOTHING,
) -> Simulation:
    """Return a run over `duration` (s) or a little more, by steps of the lengths in `sequence` (s), over and over.

    alpha_hat and beta_hat belong to a step of h (s), and the alpha and beta that they are stay as they are; with `hold`
    alpha_hat and beta_hat stay, and alpha and beta follow the steps. The first constraint is off by `perturb` (m) at
    the start. `after` is done to each state. Work and drift of energy are
    integrated by the trapezoidal rule. InputError for a method of several steps, and as `simulated`.
    """
    check_one_step(method)
    check_duration(duration, min(sequence) * float(method.step_multiple))
    first = checked_start(perturbed_state(mechanism, perturb))
    steps = _steps(method, sequence, duration, lambda step: feedback_gains(alpha_hat, beta_hat, step if hold else h))
    counts = no_counts()
    length, gains = float(steps.lengths[0]), (float(steps.gains[0, 0]), float(steps.gains[0, 1]))
    carried, _, _ = carried_quantities(mechanism, method, length, gains, [first], first, counts)

    lengths, kinds = np.unique(steps.lengths, return_inverse=True)

    def steps_between(begin: int, end: int) -> Steps:
        gains_of_steps = steps.gains[begin:end, :, np.newaxis]
        return Steps(
            steps.times[begin:end], steps.lengths[begin:end], kinds[begin:end].astype(np.int64), gains_of_steps
        )

    blocks = steps_in_blocks(
        mechanism,
        second_order_form(method.scheme),
        steps_between,
        length,
        carried,
        batch=(),
        count=len(steps.lengths),
        compiled=runs_compiled(mechanism, method, len(steps.lengths) * evaluations(method), after),
        judged=True,
        counts=counts,
        kinds=len(lengths),
        after=after,
    )
    trajectory = recorded(mechanism, method, first, steps.times, blocks, "rk4", counts, after)
    times = trajectory.t
    # at each time the gains of the step that begins there; at the last, those of the step that led to it
    at_times = np.minimum(np.arange(len(times)), len(steps.lengths) - 1)
    two_alpha, beta_squared = steps.gains[at_times].T
    observation = observe(mechanism, times, trajectory.q, trajectory.v, two_alpha, beta_squared)
    balance = energy_balance(observation, steps.lengths[: len(times) - 1], nodes=2)
    return Simulation(
        trajectory=trajectory, observation=observation, balance=balance, h=h, alpha_hat=alpha_hat, beta_hat=beta_hat
    )


@dataclass(frozen=True, eq=False)
class VaryingSteps:
    """Steps of different lengths (s), one after the other, shape (steps,).

    `gains` has 2 alpha (1/s) and beta^2 (1/s^2) of each, shape (steps, 2).
    """

    lengths: FloatArray
    gains: FloatArray

    @property
    def times(self) -> FloatArray:
        """The times (s) at which they begin, and that at which the last one ends; shape (steps + 1,)."""
        return np.concatenate([[0.0], np.cumsum(self.lengths)])


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
