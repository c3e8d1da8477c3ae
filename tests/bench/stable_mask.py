"""A map of stable or not from the exact boundary, scan line by scan line: what a map of |z_p| is measured against."""

import numpy as np
from numpy.typing import NDArray

from bezstab.methods import Method
from bezstab.stability import FloatArray, region
from bezstab.stability.arrays import EPS
from bezstab.stability.boundary_locus import Arc, bounds_of
from bezstab.stability.locus_shapes import straight_edges
from bezstab.stability.mu_pencils import MuPencil
from bezstab.stability.region_checks import crossed_levels

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.int_]

ROUNDINGS = 2  # of the arc's furthest point: nearer than that a crossing is on its line
FALSE_POSITIONS = 10  # from 1/400 of an arc: the sixth is exact to rounding but where the line nearly touches it


def stable_mask(method: Method, alpha_hat: FloatArray, beta_hat: FloatArray, level: float = 1.0) -> BoolArray:
    """Return where |z_p| < level over the grid of two ascending axes; shape (beta_hat.size, alpha_hat.size).

    Scan line by scan line between the crossings of the exact boundary: no pole is computed. A point on a slanted or
    curved edge itself, where |z_p| = level, falls to either side by rounding.
    """
    mask = np.zeros((beta_hat.size, alpha_hat.size + 1), np.uint8)  # one more for what lies beyond the last column
    if region(method, level).boundary:
        rows, crossings = scan(method, beta_hat, level)
        columns = np.searchsorted(alpha_hat, crossings)
        np.bitwise_xor.at(mask, (rows, columns), 1)
        np.bitwise_xor.accumulate(mask, axis=1, out=mask)
        touched = np.append(alpha_hat, np.inf)[columns] == crossings  # |z_p| is level on the boundary itself
        mask[rows[touched], columns[touched]] = 0
        for (first_alpha_hat, first_beta_hat), (last_alpha_hat, last_beta_hat) in _edges(method, level):
            if first_beta_hat == last_beta_hat:  # a whole scan line may lie on the edge
                low, high = sorted((first_alpha_hat, last_alpha_hat))
                on_it = np.append((alpha_hat >= low) & (alpha_hat <= high), False)
                mask[np.ix_(beta_hat == first_beta_hat, on_it)] = 0
    return mask[:, :-1].view(bool)


def scan(method: Method, beta_hat: FloatArray, level: float = 1.0) -> tuple[IntArray, FloatArray]:
    """Return where lines of constant beta_hat (ascending) cross the boundary: their numbers, and alpha_hat there.

    Lines outside the open region's extent cross nothing, though the first may touch it all along.
    """
    pencil = MuPencil(method)
    _, (low, high) = region(method, level).extent or ((0, 0), (0, 0))
    start, end = np.searchsorted(beta_hat, low, "right"), np.searchsorted(beta_hat, high)
    lines = beta_hat[start:end]
    found = [arc_crossings(arc, lines) for arc in bounds_of(pencil, level).arcs]
    for (first_alpha_hat, first_beta_hat), (last_alpha_hat, last_beta_hat) in _edges(method, level):
        if first_beta_hat == last_beta_hat:
            continue  # no line crosses it
        rows, _ = crossed_levels(lines, np.array([first_beta_hat, last_beta_hat]))
        rise = (last_alpha_hat - first_alpha_hat) * (lines[rows] - first_beta_hat)
        found.append((rows, first_alpha_hat + rise / (last_beta_hat - first_beta_hat)))
    return start + np.concatenate([rows for rows, _ in found]), np.concatenate([crossings for _, crossings in found])


def _edges(method: Method, level: float) -> list[list[list[float]]]:
    """Return the two ends (alpha_hat, beta_hat) of each straight edge."""
    pencil = MuPencil(method)
    return [edge.tolist() for edge in straight_edges(pencil, bounds_of(pencil, level))]


def arc_crossings(arc: Arc, beta_hat: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return the numbers of the ascending levels beta_hat that an arc crosses, and alpha_hat there, by false position.

    Between two neighbouring turns or samples beta_hat is monotonic, so each crossing is bracketed. Illinois: the value
    of an end that stays twice is halved, lest it stay for ever (M. Dowell & P. Jarratt, BIT 11, 1971).
    """
    turns = arc.turns(1)
    theta = np.append(arc.theta, turns)
    order = np.argsort(theta)
    theta = theta[order]
    values = np.append(arc.plane()[:, 1], arc.coordinate(turns, 1))[order]
    rows, step = crossed_levels(beta_hat, values)
    low, high, target = theta[step], theta[step + 1], beta_hat[rows]
    below, above = values[step] - target, values[step + 1] - target
    beyond = np.full(len(rows), False)
    middle = low
    rounding = ROUNDINGS * EPS * np.abs(values).max()
    for k in range(FALSE_POSITIONS):
        middle = low - below * (high - low) / (above - below)
        off = arc.coordinate(middle, 1) - target
        if (np.abs(off) <= rounding).all():
            break
        last = beyond
        beyond = np.sign(off) == np.sign(above)
        stays = np.where(last == beyond, 0.5 if k else 1.0, 1.0)
        high, low = np.where(beyond, middle, high), np.where(beyond, low, middle)
        above, below = np.where(beyond, off, stays * above), np.where(beyond, stays * below, off)
    return rows, arc.coordinate(middle, 0)
