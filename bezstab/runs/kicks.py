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

This is the rule for whatever is kicked and run twice. Where there is one run, as of a scene, in MuJoCo or in most logs,
an error and what is forced are one c: there it is asked how large that becomes.
"""

from collections.abc import Iterator, Sequence
from itertools import chain

import numpy as np

from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.programs import even_steps
from bezstab.mechanism.runner import march, resume
from bezstab.mechanism.start import constraint_errors, initial_state, perturbed_state
from bezstab.methods.schemes import Method, steps
from bezstab.runs.linear_prediction import NEGLIGIBLE
from bezstab.stability.arrays import BoolArray, FloatArray
from bezstab.units import feedback_gains

KICK = 1e-8
"""SI units: a hundred thousandth of the linear range, so that even growth of thirtyfold a step is seen within it, and a
thousandth of the kick is well above the rounding of a metre."""

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

TOO_CLOSE = 10.0
"""Over the number of steps: with | |z_p| - 1 | below this growth or decay may not show in a run."""

WINDOW = 10
"""Steps: an oscillation so slow that it is below NEGLIGIBLE in all of them passes no zero within thousands of steps."""

PARTS = 8
"""Of a run: where nothing has come of the error by its end, the last is compared with the one before the middle."""

OF_ALL = 0.1
"""What an error that grows accounts for, at least, of all that two runs differ by; two motions differ by a hundredth of
that in their c."""


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
    alpha_hat and beta_hat of shape (points,). What a method remembers of before the kick is left alone, and what a
    second-order scheme remembers of the acceleration is that of the kicked state: its recursion is linear, and its
    poles are the same from any first values. InputError for a scene that cannot start, and where runs are to be
    `compiled` without numba.
    """
    step, gains = h * float(method.step_multiple), feedback_gains(alpha_hat, beta_hat, h)
    q, v = initial_state(mechanism)
    start = np.repeat(np.concatenate([q, v])[:, np.newaxis], alpha_hat.size, axis=1)
    first_steps = even_steps(step, steps(method), gains, start.shape[1:])
    before = march(mechanism, method, first_steps, start)
    history = [start, *(state for block in before for state in block.states)]
    by_a_unit = np.concatenate([perturbed_state(mechanism, 1.0)[0] - q, 0 * v])  # linear in the constraint error
    displaced = np.multiply.outer(by_a_unit, kicks)[:, :, np.newaxis]
    *past, last = history
    kicked = last[:, np.newaxis, np.newaxis] + np.stack([displaced, -displaced], axis=1)
    following = even_steps(step, count, gains, kicked.shape[1:], first=len(past))
    blocks = resume(mechanism, method, following, [*past, kicked], compiled)
    k = len(past)
    for states in chain([kicked[np.newaxis]], (block.states for block in blocks)):
        times = step * np.arange(k, k + len(states), dtype=np.float64)
        q = states[:, : mechanism.size]
        c = constraint_errors(mechanism, times.reshape(-1, 1, 1, 1), np.moveaxis(q, 1, 0))
        yield np.moveaxis(c, 0, 1), q
        k += len(states)


def kicked_fates(
    mechanism: Mechanism,
    method: Method,
    h: float,
    alpha_hat: FloatArray,
    beta_hat: FloatArray,
    count: int,
    compiled: bool = False,
) -> tuple[BoolArray, BoolArray]:
    """Return where a kick's error grows over so many steps, and where there is no verdict; shape (points,) each.

    h in s, alpha_hat and beta_hat of shape (points,); errors as `kicked_motions`.
    """
    sizes, errors, distances = [], [], []
    with np.errstate(all="ignore"):  # what diverges runs into infinity, and is cut off there
        for c, q in kicked_motions(mechanism, method, h, alpha_hat, beta_hat, [KICK], count, compiled):
            sizes.append(np.abs(c).max(axis=(1, 2, 3)))
            errors.append(np.abs(c[:, :, 0, 0] - c[:, :, 1, 0]).max(axis=1) / (2 * KICK))
            distances.append(np.sqrt(np.einsum("i,kip->kp", mechanism.mass, (q[:, :, 0, 0] - q[:, :, 1, 0]) ** 2)))
        size, error, distance = (np.concatenate(each) for each in (sizes, errors, distances))
        return fates(size, error, distance / distance[0], thrown_apart(mechanism, method, h, size))


def thrown_apart(mechanism: Mechanism, method: Method, h: float, size: FloatArray) -> BoolArray:
    """Return where it is the feedback that throws a mechanism apart at once, by the largest |c|, (steps, points).

    That is so if without feedback c stays well within the linear range for these first few steps; h in s.
    """
    apart = np.logical_not((size[: AT_ONCE + 1] < APART).all(axis=0))  # what is not a number is not less
    if apart.any():
        none = np.zeros(1)
        without = kicked_motions(mechanism, method, h, none, none, [0.0], AT_ONCE)
        apart &= all(bool((np.abs(c) < CALM).all()) for c, _ in without)
    return apart


def fates(size: FloatArray, error: FloatArray, moved: FloatArray, apart: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Return where a kick's error grows, and where there is no verdict; shape (points,) each.

    Of each step, (steps, points), the first that of the kick: the `size` of c, the largest |c|; the `error`, half of
    what two runs differ by in c, in units of the kick; how far they have `moved` apart, in units of what the kick
    displaced. `apart`: as `thrown_apart`, shape (points,). Theory: the docstring of this file.
    """
    linear = np.logical_and.accumulate(size < LINEAR[0], axis=0)  # not so where it is not a number
    of_windows = linear[1:].reshape(-1, WINDOW, len(apart))
    linear_windows = np.logical_and.reduce(of_windows, axis=1)
    error, moved = (np.where(of_windows, each[1:].reshape(of_windows.shape), 0).max(axis=1) for each in (error, moved))
    with np.errstate(all="ignore"):  # of windows that are no longer linear
        share = np.where(moved > 0, error / moved, 0.0)
    largest_so_far = np.maximum.accumulate(np.maximum(error, 1.0), axis=0)  # the kick itself is one
    dead = np.logical_or.accumulate(linear_windows & (error < NEGLIGIBLE * largest_so_far), axis=0)
    grown = (error > GROWN) & (share > OF_ALL)
    died, came_back, to_the_end = dead[-1], (grown[1:] & dead[:-1]).any(axis=0), linear_windows[-1]
    middle, part = len(error) // 2, len(error) // PARTS
    last, before_middle = error[-part:].max(axis=0), error[middle - part : middle].max(axis=0)
    more = (last > before_middle) & (share[-part:].max(axis=0) > OF_ALL)
    # less is decay, whatever accounts for it: the motions' drift only adds to it
    converges = np.where(died, ~came_back, to_the_end & (last <= before_middle))
    diverges = ~died & np.where(to_the_end, more, grown.any(axis=0)) | apart
    return diverges, ~(diverges | converges)
