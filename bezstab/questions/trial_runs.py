"""Feedback for one mechanism: where short runs of it come far nearer to its motion than the point that a rule chose.

A rule knows a method and a rate. What the method does wrong and what the feedback does cancel along a line in the plane
of alpha and beta (1/s), which hardly moves with h, but lies elsewhere on each mechanism.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import partial

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, simulate
from bezstab.mechanism.start import constraint_errors, initial_state
from bezstab.methods.registry import lookup
from bezstab.methods.schemes import Method, evaluations, implicit
from bezstab.questions.motions import turning_rate
from bezstab.rationals import exact
from bezstab.stability.accurate_points import decaying
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.stability.choices import THOUSANDFOLD, Choice, search_box
from bezstab.stability.closed_loop import all_within
from bezstab.stability.regions import region
from bezstab.stability.turning import turn_limits

TURNED = 40.0
"""rad of the motion in a run: what 20 rad choose is worse later on, what 80 choose no better."""

EVALUATIONS = 4000
"""In a run at most, half a second for all side by side: its steps are longer than those asked for, if need be."""

ITERATIONS = 4
"""What Newton's method takes for an evaluation of an implicit step, about."""

SHARES = (1.1, 0.9)
"""Of the step: what is better with one of them alone is so by chance."""

POINTS = 28
"""Per axis, from the weakest feedback that settles within a run to the strongest stable one: each a fourth stronger.

Half as many where steps are to be solved.
"""

NEARER, LOOSER = 1 / 3, 2.0
"""Times the errors of trajectory and constraints: what a point has at most that takes the place of another."""


@dataclass(frozen=True)
class Trials:
    """What so many runs of a mechanism found: a point, and how many times nearer its trajectory is.

    Each run takes so many seconds, by steps of h_max (s) at most, in which the factor holds.
    """

    point: tuple[Fraction, Fraction]
    runs: int
    seconds: float
    h_max: float
    times_nearer: float


def trial_runs(
    mechanism: Mechanism,
    choice: Choice,
    h: Fraction,
    omega_h: Fraction,
    *,
    spread: float,
    settle: Fraction | None,
    time: Fraction | None,
) -> Trials | None:
    """Return a point that is clearly nearer to the motion than a choice; None where there is none.

    It settles within a run and in `settle` (s), with alpha and beta off by the spread, and as constraints turn. A run
    turns by TURNED rad, omega_h in a step of h (s), but is no longer than `time` (s) or the scene's file says. None,
    too, where the runs of the choice break down: their longer steps do not bear strong feedback.
    """
    method, multiple, step = choice.method, float(choice.method.step_multiple), float(h)
    seconds = min(TURNED * step / float(omega_h), float(time or mechanism.scene.duration or np.inf))
    rate = THOUSANDFOLD ** (step * multiple / min(seconds, float(settle or seconds)))
    (_, largest_alpha), (_, largest_beta) = search_box(region(method))[0]
    count = POINTS // 2 if implicit(method) else POINTS
    axes = np.geomspace(-np.log(rate) / multiple, [largest_alpha / 2, largest_beta**0.5], count)
    alpha_h, beta_h = (each.ravel() for each in np.meshgrid(*axes.T))
    points = np.array([2 * alpha_h, beta_h**2])
    points = points[:, decaying(partial(all_within, method), rate, *points, spread=spread)]
    points = points[:, turn_limits(method, *points) > turning_rate(mechanism) * step]
    points = np.column_stack([points, [choice.alpha_hat, choice.beta_hat]])
    cost = evaluations(method) * (ITERATIONS if implicit(method) else 1)
    own = max(step * multiple, seconds * cost / EVALUATIONS)
    longer = max(SHARES) * own / (step * multiple)
    stable = all_within(method, points[0] * longer, points[1] * longer**2, 1.0)
    if not stable[-1]:
        return None
    points = points[:, stable]
    rule = best = len(points.T) - 1
    gains = points[0] / step, points[1] / step**2
    errors: list[FloatArray] = []
    with np.errstate(all="ignore"):  # of runs that break down
        for share in SHARES:
            errors.append(_errors(mechanism, method, share * own, seconds, gains))
            nearer, times = _nearer(errors, best)
            if not nearer.any():
                return None
        while nearer.any():
            best = int(np.where(nearer, times, np.inf).argmin())
            nearer, times = _nearer(errors, best)
    _, times = _nearer(errors, rule)
    point = exact(points[0, best]), exact(points[1, best])
    runs, h_max = len(SHARES) * len(points.T), longer * step
    return Trials(point, runs, seconds, h_max, float(1 / times[best]))


def _nearer(errors: list[FloatArray], point: int) -> tuple[BoolArray, FloatArray]:
    """Return which points are clearly nearer to the motion than one, and how many times as far in the later half."""
    times = np.max([each / each[:, :, [point]] for each in errors], axis=0)
    of_c, of_q, of_v = times[1]
    return (of_c <= LOOSER) & (of_q < NEARER) & (of_v <= 1) & (times[0, 1] <= 1), of_q


def _errors(
    mechanism: Mechanism, method: Method, step: float, seconds: float, gains: tuple[FloatArray, FloatArray]
) -> FloatArray:
    """Return the largest errors of constraints, coordinates and velocities in both halves of runs side by side."""
    steps = int(seconds / step)
    exactly = simulate(mechanism, lookup("tsit5"), step / 2, steps * step, (0.0, 0.0))
    if exactly.failure:
        return np.full((2, 3, len(gains[0])), np.nan)
    start = np.repeat(np.concatenate(initial_state(mechanism))[:, np.newaxis], len(gains[0]), axis=1)
    largest, taken = np.zeros((2, 3, len(gains[0]))), 0
    for block in march(mechanism, method, even_steps(step, steps, gains, (len(gains[0]),)), start):
        for state in block.states:
            taken += 1
            q, v = np.split(state, 2)
            off = [constraint_errors(mechanism, taken * step, list(q))]
            off += [q - exactly.q[2 * taken][:, np.newaxis], v - exactly.v[2 * taken][:, np.newaxis]]
            half = largest[int(2 * taken > steps)]
            half[:] = np.maximum(half, [np.abs(each).max(axis=0) for each in off])
    return largest
