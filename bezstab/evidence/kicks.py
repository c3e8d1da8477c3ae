r"""Runs that are kicked, one up and one down, and what becomes of the constraint error that a kick has made.

It grows, or it dies. Half the difference of their c is the kick's error for as
long as that lives, and no longer:

    log |dc|  *
              | *
              |   *                           . . . . '       what is left: the two motions drift apart
              |     *             . . . . '
              |       *   . . '
              |        '* died: a thousandth of its largest
              +---------------------------------------- steps

The kick moves the motion itself a little, too. If nothing drives the mechanism, the two motions drift apart for good;
truncation errors force c in each, along each motion, and so differently. What is left of dc, and grows, is that.

So the error has died, and the run converges, where all of a window is below a thousandth of what the error was at most,
whatever comes later; unless that is growth of a constraint error again, and then the run has no verdict. Where it has
not died by the end of the run, the last eighth is compared with the eighth before the middle, and where c leaves the
range in which the mechanism answers linearly, the error with the kick: tenfold is growth. (A stable error, too, may
rise tenfold before it falls, where two poles are nearly one: that it dies decides.)

Growth counts only if the error still accounts for a tenth, at least, of what the two runs differ by. The kick is all of
it at first; of two motions that keep to their constraints but for what is forced (below LINEAR on a mechanism of about
a metre) c differs by about a thousandth of what q does. Else there is no verdict, as where the mechanism itself breaks
down.

One thing is faster than any window: feedback that throws the parts of the mechanism metres apart at once. That is
growth, too, if without feedback nothing happens to the mechanism in these steps. (Leaving the linear range at once is
not enough: where steps are coarse, feedback may turn truncation errors into millimetres though errors decay.)
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bezstab.evidence.linear_prediction import NEGLIGIBLE
from bezstab.mechanism import (
    How,
    Mechanism,
    constraint_errors,
    initial_state,
    march,
    perturbed_state,
    resume,
    states_needed,
)
from bezstab.methods import Method, steps
from bezstab.stability import BoolArray, FloatArray
from bezstab.units import feedback_gains

LINEAR = (1e-3, 1e-4, 1e-5)
"""Largest |c| of a window, SI units: up to here a mechanism of about a metre answers linearly."""

GROWN = 10.0
"""Times the kick, well before c leaves the linear range; else the mechanism itself broke down."""

AT_ONCE = 10
"""Steps: growth of tenfold a step, which the linear range may be too small to show, takes fewer to APART."""

APART = 1.0
"""|c|, SI units, of a mechanism of about a metre that is in pieces."""

CALM = NEGLIGIBLE * LINEAR[0]
"""Largest |c|, SI units, of a mechanism to which nothing happens in the steps in which feedback has thrown it apart."""

WINDOW = 10
"""Steps: an oscillation so slow that it is below NEGLIGIBLE in all of them passes no zero within thousands of steps."""

PARTS = 8
"""Of a run: where nothing has come of the error by its end, the last is compared with the one before the middle."""

OF_ALL = 0.1
"""What an error that grows accounts for, at least, of all that two runs differ by; two motions differ by a hundredth of
that in their c."""


def steps_before_a_kick(method: Method) -> int:
    """Return how many steps of its own a run has to have taken until a method has all that it remembers."""
    return max(steps(method), states_needed(method) - 1)


def kicked_states(
    mechanism: Mechanism,
    method: Method,
    step: float,
    gains: tuple[FloatArray, FloatArray],
    history: Sequence[FloatArray],
    directions: FloatArray,
    kicks: FloatArray,
    count: int,
    compiled: bool = False,
) -> Iterator[FloatArray]:
    """Yield the states of kicked runs, (2 n, 2 for up and down, kicks, points) each, in blocks; the first is the kick.

    `history` holds the states up to the kick, `step` (s) apart, (2 n, points) each. Each of the `kicks`, that may
    depend on the points, is along one of the `directions`, (2 n, kicks). What a multistep method remembers of before is
    left alone, and so is what a second-order scheme remembers of accelerations: its recursion is linear, and its poles
    are the same from any first values. InputError where runs are to be `compiled` without numba.
    """
    undisturbed = history[-1]
    displaced = directions[:, :, np.newaxis] * kicks
    kicked = undisturbed[:, np.newaxis, np.newaxis] + np.stack([displaced, -displaced], axis=1)
    yield kicked[np.newaxis]
    so_far = [*history[:-1], kicked]
    for block in resume(mechanism, method, step, gains, so_far, count, How(compiled), undisturbed):
        yield block.states


def kicked_motions(
    mechanism: Mechanism,
    method: Method,
    h: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    kicks: Sequence[float],
    count: int,
    compiled: bool = False,
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield c and q (SI units) of kicked runs, from the kick on over `count` steps, in blocks.

    They have the shape (steps, constraints or coordinates, 2 for up and down, kicks, points). The kick of the first
    constraint (SI units) comes after as many steps as the method has; the first block is the kick itself. h in s,
    alpha_hat and beta_hat of shape (points,). InputError for a scene that cannot start, else as `kicked_states`.
    """
    step, gains = h * float(method.step_multiple), feedback_gains(alpha_hat, beta_hat, h)
    q, v = initial_state(mechanism)
    start = np.repeat(np.concatenate([q, v])[:, np.newaxis], alpha_hat.size, axis=1)
    before = march(mechanism, method, step, gains, start, "rk4", steps_before_a_kick(method))
    history = [start, *(state for block in before for state in block.states)]
    displaced = perturbed_state(mechanism, 1.0)[0] - q  # linear in the constraint error
    directions = np.outer(np.concatenate([displaced, np.zeros_like(v)]), np.ones(len(kicks)))
    amounts = np.array(kicks)[:, np.newaxis]
    k = len(history) - 1
    for states in kicked_states(mechanism, method, step, gains, history, directions, amounts, count, compiled):
        times = step * np.arange(k, k + len(states), dtype=np.float64)
        q = states[:, : mechanism.size]
        c = constraint_errors(mechanism, times.reshape(-1, 1, 1, 1), np.moveaxis(q, 1, 0))
        yield np.moveaxis(c, 0, 1), q
        k += len(states)


def nothing_happens_without_feedback(mechanism: Mechanism, method: Method, h: float) -> bool:
    """Return whether without feedback c stays well within the linear range for the first few steps; h in s."""
    none = np.zeros(1)
    with np.errstate(all="ignore"):
        drifting = kicked_motions(mechanism, method, h, none, none, [0.0], AT_ONCE)
        largest = max(float(np.abs(c).max()) for c, _ in drifting)
    return largest < CALM  # not so where it is not a number


@dataclass(frozen=True)
class Followed:
    """Half the difference of two runs after a kick, in windows; `error` and `moved` of shape (windows, points).

    `error`: the largest |dc| of a window, of any constraint, in units of the kick. `moved`: the largest size of dq, in
    the metric of the masses, in units of what the kick itself displaced. Both are zero from where c has left the linear
    range, which holds for so many steps, shape (points,). `thrown_apart`: c is beyond APART AT_ONCE, shape (points,).
    """

    error: FloatArray
    moved: FloatArray
    linear_steps: NDArray[np.int_]
    thrown_apart: BoolArray


def follow(blocks: Iterator[tuple[FloatArray, FloatArray]], masses: FloatArray, kick: float, run: int) -> Followed:
    """Return what is seen after the first step of the blocks, that of the kick (SI units), in `run` steps.

    A block of c has shape (steps, constraints, 2, 1, points), of q (steps, coordinates, ...); masses (coordinates,).
    Where no run is linear any more, the rest is left out.
    """
    c, q = next(blocks)
    points = c.shape[-1]
    error, moved = np.zeros((2, run // WINDOW, points))
    linear_steps = np.zeros(points, int)
    sizes = np.abs(c).max(axis=(1, 2, 3))
    linear, together = sizes[0] < LINEAR[0], sizes[0] < APART  # not so where it is not a number
    displaced = _size(q, masses)[0]
    k = 0
    for c, q in blocks:
        if k == run or (k >= AT_ONCE and not linear.any()):
            break
        sizes = np.abs(c).max(axis=(1, 2, 3))
        together &= (sizes[: max(AT_ONCE - k, 0)] < APART).all(axis=0)
        still = np.logical_and.accumulate(sizes < LINEAR[0], axis=0) & linear
        differences = np.abs(c[:, :, 0, 0] - c[:, :, 1, 0]).max(axis=1) / (2 * kick)
        window_of_step = np.arange(k, k + len(c)) // WINDOW
        for of_all, of_block in ((error, differences), (moved, _size(q, masses) / displaced)):
            np.maximum.at(of_all, window_of_step, np.where(still, of_block, 0.0))
        linear = still[-1]
        linear_steps += still.sum(axis=0)
        k += len(c)
    return Followed(error, moved, linear_steps, ~together)


def _size(q: FloatArray, masses: FloatArray) -> FloatArray:
    """Return half the difference of q of both runs, in the metric of the masses; shape (steps, points)."""
    return np.asarray(np.sqrt(np.einsum("i,kip->kp", masses, (q[:, :, 0, 0] - q[:, :, 1, 0]) ** 2)) / 2)


def fates(followed: Followed, thrown_apart_is_growth: bool) -> tuple[BoolArray, BoolArray]:
    """Return where a kick's error grows, and where there is no verdict; shape (points,) each.

    `thrown_apart_is_growth`: as `nothing_happens_without_feedback`. Theory: the docstring of this file.
    """
    error, windows = followed.error, len(followed.error)
    with np.errstate(all="ignore"):  # of windows that are no longer linear
        share = np.where(followed.moved > 0, error / followed.moved, 0.0)
    window = np.arange(windows)[:, np.newaxis]
    linear_windows = followed.linear_steps // WINDOW
    largest_so_far = np.maximum.accumulate(np.maximum(error, 1.0), axis=0)  # the kick itself is one
    dead = (window < linear_windows) & (error < NEGLIGIBLE * largest_so_far)
    grown = (error > GROWN) & (share > OF_ALL)
    died = dead.any(axis=0)
    died_in = np.where(died, dead.argmax(axis=0), windows)
    came_back = (grown & (window > died_in)).any(axis=0)
    to_the_end = linear_windows == windows
    part = windows // PARTS
    last, before_middle = error[-part:].max(axis=0), error[windows // 2 - part : windows // 2].max(axis=0)
    more = (last > before_middle) & (share[-part:].max(axis=0) > OF_ALL)
    # less is decay, whatever accounts for it: the motions' drift only adds to it
    converges = np.where(died, ~came_back, to_the_end & (last <= before_middle))
    diverges = ~died & np.where(to_the_end, more, grown.any(axis=0))
    diverges |= followed.thrown_apart & thrown_apart_is_growth
    return diverges, ~(diverges | converges)
