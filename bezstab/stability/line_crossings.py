"""Where an arc of the boundary crosses lines: of constant beta_hat, or of any other linear coordinate."""

import numpy as np
from numpy.typing import NDArray

from bezstab.stability.arrays import EPS, FloatArray
from bezstab.stability.boundary_locus import Arc

ROUNDINGS = 2  # of the arc's furthest point: nearer than that a crossing is on its line
FALSE_POSITIONS = 10  # from 1/400 of an arc: the sixth is exact to rounding but where the line nearly touches it

IntArray = NDArray[np.int_]


def crossed_levels(levels: FloatArray, values: FloatArray) -> tuple[IntArray, IntArray]:
    """Return every (i, k) such that the step from values[k] to values[k + 1] crosses levels[i]."""
    below = np.searchsorted(levels, values)  # how many levels lie below each value
    number = np.abs(np.diff(below))
    step = np.repeat(np.arange(len(number)), number)
    first = np.repeat(np.minimum(below[:-1], below[1:]) - np.cumsum(number) + number, number)
    return first + np.arange(number.sum()), step


def arc_crossings(arc: Arc, beta_hat: FloatArray, to_user: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the numbers of the ascending levels beta_hat that an arc crosses, and alpha_hat there, by false position.

    `to_user` takes (p, q) to (alpha_hat, beta_hat); the identity for lines of constant q.

    Between two neighbouring turns or samples beta_hat is monotonic, so each crossing is bracketed. Illinois: the value
    of an end that stays twice is halved, lest it stay for ever (M. Dowell & P. Jarratt, BIT 11, 1971).
    """
    turns = arc.turns(to_user[1])
    theta = np.append(arc.theta, turns)
    order = np.argsort(theta)
    theta = theta[order]
    values = np.append(arc.plane() @ to_user[1], arc.coordinate(turns, to_user[1]))[order]
    rows, step = crossed_levels(beta_hat, values)
    low, high, target = theta[step], theta[step + 1], beta_hat[rows]
    below, above = values[step] - target, values[step + 1] - target
    beyond = np.full(len(rows), False)
    middle = low
    rounding = ROUNDINGS * EPS * np.abs(values).max()
    for k in range(FALSE_POSITIONS):
        middle = low - below * (high - low) / (above - below)
        off = arc.coordinate(middle, to_user[1]) - target
        if (np.abs(off) <= rounding).all():
            break
        last = beyond
        beyond = np.sign(off) == np.sign(above)
        stays = np.where(last == beyond, 0.5 if k else 1.0, 1.0)
        high, low = np.where(beyond, middle, high), np.where(beyond, low, middle)
        above, below = np.where(beyond, off, stays * above), np.where(beyond, stays * below, off)
    return rows, arc.coordinate(middle, to_user[0])
