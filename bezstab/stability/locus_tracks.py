r"""Branches of the boundary locus pi(r e^(i theta), mu) = 0, followed from theta = 0 to pi by steps that are safe.

To one theta belong as many mu as pi has degree in mu. Which of those at the next theta continues which of those here?
The nearest one, if it moves by far less than the branches are apart; else the step is halved. Two branches that pass
close by each other turn there, and are told apart only by steps that see them turn:

    Im mu
      |    \        /
      |     \  a  /       a turns up, b down, within an angle however short:
      |      \__/         a step across leads from a to b, but is about as long
      |       __          as a and b are apart
      |      /  \
      |     /  b \
      +-------------- Re mu

Where two branches meet on the circle itself no step is short enough: there each ends, and another begins.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from bezstab.errors import NumericalError
from bezstab.stability.arrays import ComplexArray, FloatArray
from bezstab.stability.mu_pencils import MuPencil, roots_in_mu
from bezstab.stability.quadratures import integrals
from bezstab.stability.searches import least_between

SAMPLES = 1024  # of theta over half the circle: what is shorter is looked for by itself
APART = 4  # times as far as a branch moves in a step must all others be: if it were twice, two might claim one mu
SHORTEST = 1e-11  # rad: branches that come together within it meet on the circle, as far as float64 can tell
MOST_SAMPLES = 64 * SAMPLES  # towards a few hundred places where branches pass; more, and they lie on one another
PANEL_SAMPLES = 50  # of an arc to each of the first panels, where it may turn so fast that halves miss it alike


@dataclass(frozen=True, eq=False, repr=False)
class Arc:
    """A piece of one branch mu(theta) of the locus of |z| = level, at ascending theta; both of shape (samples,)."""

    pencil: MuPencil
    level: float
    theta: FloatArray
    mu: ComplexArray

    def at(self, theta: FloatArray) -> ComplexArray:
        """Return mu(theta) for a row of theta (rad) between the samples: of all mu that nearest to the next sample."""
        right = np.clip(np.searchsorted(self.theta, theta), 1, len(self.theta) - 1)
        left_is_nearer = theta - self.theta[right - 1] < self.theta[right] - theta
        samples = self.mu[np.where(left_is_nearer, right - 1, right)]
        candidates = roots_in_mu(self.pencil, self.level * np.exp(1j * theta))
        closest = np.argmin(np.abs(candidates - samples), axis=0)
        found: ComplexArray = candidates[closest, np.arange(theta.size)]
        return found

    def plane(self) -> FloatArray:
        """Return alpha_hat and beta_hat at the samples; shape (samples, 2)."""
        return self.pencil.user_points(self.mu, self.mu.conj())

    def coordinate(self, theta: FloatArray, axis: int) -> FloatArray:
        """Return alpha_hat (axis 0) or beta_hat of mu(theta) for a row of theta."""
        mu = self.at(theta)
        return self.pencil.user_points(mu, mu.conj())[:, axis]

    def turns(self, axis: int) -> FloatArray:
        """Return every theta where that coordinate turns, by narrowing in on the samples where it does."""
        values = self.plane()[:, axis]
        turning = np.flatnonzero(np.diff(np.sign(np.diff(values)))) + 1
        upwards = np.where(values[turning] > values[turning - 1], 1.0, -1.0)[:, np.newaxis]

        def below_the_turn(theta: FloatArray) -> FloatArray:
            return -upwards * self.coordinate(theta.ravel(), axis).reshape(theta.shape)

        theta, _ = least_between(below_the_turn, self.theta[turning - 1], self.theta[turning + 1])
        return theta

    def area(self) -> float:
        """Return the arc's contribution to the area of the image of S_r's upper half, for a step of h.

        (alpha_hat, beta_hat) = (-2x, x^2 + y^2) has the Jacobian 4y, and by Green int int 4y dx dy = -closed int
        2 y^2 dx.
        """
        edges = np.unique(np.append(self.theta[::PANEL_SAMPLES], self.theta[-1]))
        (area,), _ = integrals(self._area_density, np.stack([edges[:-1], edges[1:]], axis=1))
        return float(area)

    def _area_density(self, theta: FloatArray) -> FloatArray:
        """Return -2 y^2 dx/dtheta, shape (1, *that of theta), with dmu/dz = -(d pi/dz) / (d pi/dmu)."""
        z = self.level * np.exp(1j * theta.ravel())
        mu = self.at(theta.ravel())
        by_z, by_mu = self.pencil.slopes(z, mu)
        slope = -1j * z * by_z / by_mu
        return np.asarray(-2 * mu.imag**2 * slope.real).reshape(1, *theta.shape)


def tracks(pencil: MuPencil, level: float) -> Iterator[Arc]:
    """Yield every branch of the locus for theta in [0, pi], broken off where it is infinite or meets another.

    NumericalError if branches lie on one another.
    """
    towards_ends = np.geomspace(1e-5, 1e-2, 30)[:-1]  # near a kink S_r is a lens whose arcs lie close to 0 and pi
    even = np.linspace(1e-2, np.pi - 1e-2, SAMPLES)
    theta: FloatArray = np.concatenate([[0], towards_ends, even, np.pi - towards_ends[::-1], [np.pi]])
    mu = roots_in_mu(pencil, level * np.exp(1j * theta))
    while True:
        with np.errstate(invalid="ignore"):  # next to an infinite mu no step is safe
            moves = np.abs(mu[:, np.newaxis, :-1] - mu[np.newaxis, :, 1:])  # (branch, next branch, step)
            unsafe = ~(APART * moves.min(axis=1) < _distance_of_nearest(mu)[:, :-1]).all(axis=0)
        split = unsafe & (np.diff(theta) > SHORTEST)
        if not split.any():
            break
        if theta.size > MOST_SAMPLES:
            raise NumericalError(f"{pencil.method.name}: branches of |z_p| = {level:g} could not be told apart")
        middle = (theta[:-1][split] + theta[1:][split]) / 2
        mu = np.insert(mu, np.flatnonzero(split) + 1, roots_in_mu(pencil, level * np.exp(1j * middle)), axis=1)
        theta = np.insert(theta, np.flatnonzero(split) + 1, middle)
    continuation = np.argmin(moves, axis=1)
    breaks = [0, *(np.flatnonzero(unsafe) + 1).tolist(), theta.size]
    for start, end in pairwise(breaks):
        root = np.arange(len(mu))
        order = [root]
        for step in range(start, end - 1):
            root = continuation[root, step]
            order.append(root)
        if end - start > 1:
            for branch in np.take_along_axis(mu[:, start:end], np.stack(order, axis=1), axis=0):
                yield Arc(pencil, level, theta[start:end], branch)


def _distance_of_nearest(mu: ComplexArray) -> FloatArray:
    """Return how far the nearest other branch is from each; of shape (branches, samples), as mu."""
    distance = np.abs(mu[:, np.newaxis] - mu)
    distance[range(len(mu)), range(len(mu))] = np.inf
    return np.asarray(distance.min(axis=1))
