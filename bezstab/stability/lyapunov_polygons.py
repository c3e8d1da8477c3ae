"""Polygons that every step of a range maps into their inside: proof that any sequence of such steps decays.

A convex polygon that is symmetric about zero is the unit circle of a norm. If the matrix of every step takes each
corner into the inside, all steps shrink the norm, by a common factor as the range is closed, whatever their order.

Found in float64, as the largest growth still to come: with the norm |.| of a frame in which the motion is round,

    V(theta) = sup over all sequences of steps of log |M_n ... M_1 u(theta)|,   u(theta) a unit vector,

is a fixed point of V <- max(0, max over steps of log |M u| + V(direction of M u)), and its unit ball |x| exp V <= 1 is
convex and invariant, as a supremum of norms. Its corners are rounded to rationals. Each step is taken a little too
large, by a share of its own decay, so that what is found has room for the corners and the rounding, and for steps too
short to be sampled.

Proven in exact arithmetic: corner p, edge from e to f, M = N(s) / d(s). The image lies on the inner side of the edge
if and only if (e x f) d(s) + (f - e) x N(s) p > 0, a polynomial in the length s of the step, where d(s) > 0. That is
so where it holds for -p, too: the two add up to 2 (e x f) d(s).
"""

from fractions import Fraction

import numpy as np

from bezstab.methods import ExactArray, StepMatrix
from bezstab.rationals import whole_multiples
from bezstab.stability.arrays import SAME, FloatArray
from bezstab.stability.lyapunov_quadratics import rounded
from bezstab.stability.positive_polynomials import positivity

RAYS = 720  # directions in the half plane: linear interpolation of V errs by 1e-6 there
RESERVES = (0.5, 0.2, 0.1, 0.05, 0.025)  # shares of each step's decay; the first that leaves V finite is taken
SWEEPS = 3000  # V grows by a fixed amount each turn if it grows for ever: some hundred turns
AT_ONCE = (2, 4, 8, 16, 32, 64)  # steps of the shortest length at once, so that V settles in fewer sweeps
MOST_GROWTH = 3.0  # of V: in the frame of the best ellipse the polygons that were found stay below one
CORNERS = (9, 18, 36, 72, 144, 360, 720)  # in the half plane, on rays: the fewest that do are the certificate

DIRECTIONS = np.arange(RAYS) * np.pi / RAYS
"""Of the rays."""
CIRCLE = np.stack([np.cos(DIRECTIONS), np.sin(DIRECTIONS)])
"""Where they meet the unit circle."""


def invariant_polygon(
    matrix: StepMatrix,
    steps: FloatArray,
    matrices: FloatArray,
    form: FloatArray,
    shortest: Fraction,
) -> ExactArray | None:
    """Return corners of half a polygon that every step from `shortest` to 1 maps inside; None if none was found.

    Shape (corners, 2). The other half is their negatives. `matrices` (steps, 2, 2) belong to the lengths `steps`, a
    sample of the range; the root of a quadratic `form` (2, 2) maps the state to where its motion is round. Proven for
    all of the range.
    """
    frame = np.linalg.cholesky(form).T
    back = np.linalg.inv(frame)
    decays = _decays(steps, matrices)
    for reserve in RESERVES:
        factors = np.exp(reserve * decays)[:, np.newaxis, np.newaxis]
        growth = _growth_to_come(frame @ matrices @ back * factors)
        if growth is None:
            continue
        ball = back @ (CIRCLE * np.exp(-growth))
        for count in CORNERS:
            some = ball[:, np.arange(count) * RAYS // count]
            corners = rounded(some / np.abs(some[0]).max()).T
            if proves_decay(corners, matrix, shortest):
                return corners
    return None


def proves_decay(corners: ExactArray, matrix: StepMatrix, shortest: Fraction) -> bool:
    """Return whether the corners and their negatives are a convex polygon that all steps to 1 map inside: exact."""
    half = np.array(whole_multiples(corners.ravel().tolist())[0], object).reshape(corners.shape)
    ring = np.concatenate([half, -half[:1]])
    edges = np.diff(ring, axis=0)
    spans = _cross(ring[:-1], ring[1:])
    convex = _cross(edges, np.concatenate([edges[1:], -edges[:1]]))
    once_around = _cross(half[:1], half[1:])
    if not (np.concatenate([spans, convex, once_around]) > 0).all():
        return False
    images = np.moveaxis(half @ np.swapaxes(matrix.numerators, 1, 2), 0, -1)  # (corners, 2, powers of s)
    for (x, v), span in zip(edges, spans, strict=True):
        beside, room = x * images[:, 1] - v * images[:, 0], span * matrix.denominator
        if positivity([*(room + beside), *(room - beside)], shortest, Fraction(1)) is not True:
            return False
    return True


def _cross(a: ExactArray, b: ExactArray) -> ExactArray:
    """Return the cross products of rows."""
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _decays(steps: FloatArray, matrices: FloatArray) -> FloatArray:
    """Return by what -log |z| each step decays, at most at the rate of the shortest: so that none counts as sudden."""
    radii = np.abs(np.linalg.eigvals(matrices)).max(axis=1)
    decays: FloatArray = -np.log(np.maximum(radii, np.finfo(np.float64).tiny))
    slowest: FloatArray = np.minimum(decays, decays[0] * steps / steps[0])
    return slowest


def _growth_to_come(matrices: FloatArray) -> FloatArray | None:
    """Return V on the rays, by sweeps; None where it does not settle."""
    several = [np.linalg.matrix_power(matrices[0], count) for count in AT_ONCE]
    x, v = np.moveaxis(np.concatenate([matrices, several]) @ CIRCLE, 1, 0)
    gain = np.log(np.maximum(np.hypot(x, v), np.finfo(np.float64).tiny))
    goes_to = np.arctan2(v, x)
    growth: FloatArray = np.zeros(RAYS)
    for _ in range(SWEEPS):
        to_come = gain + np.interp(goes_to, DIRECTIONS, growth, period=np.pi)
        larger: FloatArray = np.maximum(growth, to_come.max(axis=0))
        change = (larger - growth).max()
        growth = larger
        if change < SAME:
            return growth
        if growth.max() > MOST_GROWTH:
            return None
    return None
