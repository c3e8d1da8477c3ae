"""Runs whose steps vary: a sequence of step lengths, taken again and again.

Only one-step methods run so: the next state follows from the last and, with some, an acceleration stored beside it.
Inside a second-order scheme h = 1, where positions, h v and h^2 a are carried: a step r times as long as the one before
begins with r times that h v and r^2 times that h^2 a. The acceleration itself is what it was, whatever the gains do.
"""

from collections.abc import Callable, Sequence
from itertools import cycle

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.compiled import Mechanism
from bezstab.mechanism.compiled_stepping import runs_compiled
from bezstab.mechanism.registers import Steps
from bezstab.mechanism.runner import How, carried_quantities, checked_start, recorded, steps_in_blocks
from bezstab.mechanism.simulation import Simulation, check_duration, seen_run
from bezstab.mechanism.start import perturbed_state
from bezstab.methods import Method, check_one_step, evaluations
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
    the start. `after` is done to each state. Work and drift of energy are integrated by the trapezoidal rule.
    InputError for a method of several steps, and as `simulated`.
    """
    check_one_step(method)
    check_duration(duration, min(sequence) * float(method.step_multiple))
    first = checked_start(perturbed_state(mechanism, perturb))
    steps = _steps(method, sequence, duration, lambda step: feedback_gains(alpha_hat, beta_hat, step if hold else h))
    count, length, gains = len(steps.lengths), float(steps.lengths[0]), steps.gains[..., 0]
    how = How(runs_compiled(count * evaluations(method)), judged=True, after=after)
    carried, *_ = carried_quantities(mechanism, method, length, (gains[0, 0], gains[0, 1]), [first], first, how.counts)
    blocks = steps_in_blocks(mechanism, method, steps._replace(times=steps.times[:-1]), carried, (), how)
    trajectory = recorded(mechanism, method, first, steps.times, blocks, how)
    taken = len(trajectory.t) - 1
    # at each time the gains of the step that begins there; at the last, those of the step that led to it
    at_times = gains[np.minimum(np.arange(taken + 1), count - 1)].T
    return seen_run(trajectory, at_times, steps.lengths[:taken], h, alpha_hat, beta_hat, nodes=2)


def _steps(
    method: Method, sequence: Sequence[float], duration: float, gains: Callable[[float], tuple[float, float]]
) -> Steps:
    """Return the steps of a run: those of the sequence, over and over, until the duration (s) is reached.

    `gains` has what belongs to a step of the user's, of which the method's own is its multiple. The times have the end
    of the last step, too.
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
    return Steps(
        times=np.concatenate([[0.0], np.cumsum(taken)]),
        lengths=np.array(taken),
        gains=np.array([gains(length / multiple) for length in taken])[:, :, np.newaxis],
    )
