r"""Branches of the boundary locus pi(r e^(i theta), mu) = 0, followed from theta = 0 to pi by steps that are safe.

To one theta belong as many mu as pi has degree in mu. Which of those at the next theta continues which of those here?
The nearest one, if the step is short against what could part them. Two branches meet at branch points z* alone; where
one lies near the circle, the branches pass close by each other within an angle of about ||z*| - r| / r:

    Im mu                                    z plane
      |    \        /                           . - |- .
      |     \  a  /       a turns up, b down   /    |    \ circle |z| = r
      |      \__/         within that angle,  |     |     x z*, a branch point of mu just outside
      |       __          however short:       \    |    /
      |      /  \         a fixed grid steps     ' - |- '
      |     /  b \        across from a to b
      +-------------- Re mu

So the grid's step is a share of the distance to the nearest branch point. For z = R(mu) that proves the match: mu(z)
is one-to-one on the disc of radius d around z, so by Koebe's theorems mu(z + s d) is within s / (1 - s)^2 d |mu'| of
mu(z), and every other branch further away than d |mu'| / 4 less the same. s < 3 - 2 sqrt 2 = 0.17 is enough.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import NumericalError
from bezstab.stability.arrays import BoolArray, ComplexArray, FloatArray
from bezstab.stability.mu_pencils import MuPencil, roots_in_mu

SAMPLES = 1024  # of theta over half the circle: what is shorter is looked for by itself
STEP_SHARE = 0.12  # of the distance to the nearest branch point; the proof above allows 0.17
SHORTEST = 1e-11  # rad; a branch point this close to the circle lies on it, as far as float64 can tell


@dataclass(frozen=True, eq=False, repr=False)
class Track:
    """One branch mu(theta) of the locus of |z| = level, sampled at ascending theta; both of shape (samples,)."""

    pencil: MuPencil
    level: float
    theta: FloatArray
    mu: ComplexArray

    def at(self, theta: FloatArray) -> ComplexArray:
        """Return mu(theta) for a row of theta (rad) between the samples: of all mu that nearest to the next sample."""
        right = np.clip(np.searchsorted(self.theta, theta), 1, len(self.theta) - 1)
        left_is_nearer = theta - self.theta[right - 1] < self.theta[right] - theta
        samples = self.mu[np.where(left_is_nearer, right - 1, right)]
        return nearest(roots_in_mu(self.pencil, self.level * np.exp(1j * theta)), samples)


def nearest(candidates: ComplexArray, targets: ComplexArray) -> ComplexArray:
    """Return from each column of candidates the one closest to that column's target."""
    distance = np.abs(candidates - targets)
    closest = np.argmin(np.where(np.isnan(distance), np.inf, distance), axis=0)
    found: ComplexArray = candidates[closest, np.arange(len(targets))]
    return found


def tracks(pencil: MuPencil, level: float, finer: int) -> Iterator[Track]:
    """Yield every branch of the locus for theta in [0, pi], broken off where it is infinite or meets another.

    That is at branch points on the circle. `finer` divides the steps. NumericalError if two branches claim one
    continuation.
    """
    every_theta = sampled_angles(pencil, level, finer)
    every_mu = roots_in_mu(pencil, level * np.exp(1j * every_theta))
    finite = np.flatnonzero(np.isfinite(every_mu).all(axis=0))
    theta = every_theta[finite]
    mu = every_mu[:, finite]
    continuation = np.argmin(np.abs(mu[:, np.newaxis, :-1] - mu[np.newaxis, :, 1:]), axis=1)  # (branch, step)
    breaks = np.flatnonzero(_too_long(pencil, level, theta, finer) | (np.diff(finite) > 1))
    starts = [0, *(breaks + 1).tolist()]
    ends = [*(breaks + 1).tolist(), len(theta)]
    for start, end in zip(starts, ends, strict=True):
        if end - start > 1:
            order = _followed(pencil, level, continuation[:, start : end - 1])
            piece = np.take_along_axis(mu[:, start:end], order, axis=0)
            for branch in piece:
                yield Track(pencil, level, theta[start:end], branch)


def sampled_angles(pencil: MuPencil, level: float, finer: int) -> FloatArray:
    """Return the angles of the samples, ascending from 0 to pi, finer towards branch points and either end."""
    towards_ends = np.geomspace(1e-5, 1e-2, 30 * finer)  # near a kink S_r is a lens whose arcs lie close to 0 and pi
    even = np.linspace(1e-2, np.pi - 1e-2, SAMPLES * finer)
    points = pencil.branch_points_in_z
    at_branch_points = np.abs(np.angle(points[points.imag >= 0]))  # -0j counts as on the axis from below
    theta = np.unique(np.concatenate([[0], towards_ends, even, np.pi - towards_ends, [np.pi], at_branch_points]))
    theta = theta[np.append(True, np.diff(theta) > SHORTEST)]
    while True:
        split = _too_long(pencil, level, theta, finer) & (np.diff(theta) > SHORTEST)
        if not split.any():
            break
        middle = (theta[1:] + theta[:-1]) / 2
        theta = np.sort(np.append(theta, middle[split]))
    return np.asarray(theta, float)


def _too_long(pencil: MuPencil, level: float, theta: FloatArray, finer: int) -> BoolArray:
    """Return which steps are longer than their share of the distance to the nearest branch point; shape (steps,)."""
    points = pencil.branch_points_in_z
    z = level * np.exp(1j * theta)
    distance = np.abs(z[:, np.newaxis] - points).min(axis=1, initial=np.inf)
    allowed = STEP_SHARE / finer * np.minimum(distance[1:], distance[:-1])
    too_long: BoolArray = level * np.diff(theta) > allowed
    return too_long


def _followed(pencil: MuPencil, level: float, continuation: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return at each sample the number of each branch's root; shape (branches, samples).

    `continuation` has the number of the next root for each root and step. NumericalError unless no two share one.
    """
    branches, steps = continuation.shape
    if not (np.sort(continuation, axis=0) == np.arange(branches)[:, np.newaxis]).all():
        raise NumericalError(f"{pencil.method.name}: two branches of |z_p| = {level:g} could not be told apart")
    order = np.empty((branches, steps + 1), np.intp)
    order[:, 0] = np.arange(branches)
    for step in range(steps):
        order[:, step + 1] = continuation[order[:, step], step]
    return order
