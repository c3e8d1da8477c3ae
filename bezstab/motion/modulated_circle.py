"""The third map: what a method and its feedback do to the energy of a motion, on the modulated circle.

A unit mass is held to the unit circle, c = (q.q - 1) / 2, and goes round at the rate omega, theta = omega h. A weak
conservative force along the circle, the slope of (epsilon / n) sin(n phi), speeds it up and slows it down n times a
revolution. The exact motion keeps its energy: what a run gains or loses is the method's and its feedback's doing.

In the frame of methods/circle_steps.py a quantity of the method's equations is, at step s,

    u + epsilon Re(w e^(i n theta s)) + epsilon^2 (m + ...)

and a constant moment T = T_0 + epsilon^2 T_2 about the centre is added, so that the mean rate of rotation stays: what
energy the run would gain, -T takes away. Such quantities are series in epsilon, in whose products two amplitudes meet
in the mean. In what the equations leave over

    epsilon^0    gives u and T_0 by Newton's method
    epsilon^1    gives w by one linear solve, where what is so many steps later has a factor e^(i n theta steps)
    epsilon^2    in the mean gives m and T_2, by the matrix of Newton's method

-T_0 is the torque that stages put on a uniform rotation, -T_2 what else a motion gains: the work that the multiplier
does on the steady error, -lambda dc/dt, and the method's own truncation, which does not depend on the feedback.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.matrices import inverses
from bezstab.methods.circle_steps import Array, CircleStep, Series, across, constraint, dot
from bezstab.methods.schemes import Method
from bezstab.methods.step_equations import POSITION, VELOCITY

FloatArray = NDArray[np.float64]

MODULATION = 0.3
"""Of a motion's rate: by so much a crank's varies that drives rods, to either side of its mean."""

NODES, FASTEST = 8, 0.9
"""Of the integral over a breakdown, and the largest omega h that it asks for."""

MOST_ITERATIONS = 30
"""Of Newton's method for a rotation, that begins within theta^2 of it: three are usual."""

SETTLED = 1e-9
"""Of a correction, of numbers of the size of one: the next would be rounding."""


class MotionEnergy(NamedTuple):
    """Growth of a motion's energy per radian, as shares of it, at points of the plane, and its three parts.

    rotation: of a uniform rotation, by the torque of stages, where there is none by truncation. multipliers: by their
    work on the steady error. truncation: the rest, as the rate varies. nan where a rotation has no solution.
    """

    gained: FloatArray
    rotation: FloatArray
    multipliers: FloatArray
    truncation: FloatArray


def motion_energy(
    method: Method,
    alpha_hat: ArrayLike,
    beta_hat: ArrayLike,
    omega_h: float | FloatArray,
    modulation: float = MODULATION,
    harmonic: float = 1.0,
) -> MotionEnergy:
    """Return what the method makes of the energy of a motion of omega_h radians a step, whose rate varies.

    It varies by `modulation` of it, `harmonic` times a revolution; with a modulation of 0 it is a uniform rotation.
    Shapes are that of alpha_hat, beta_hat and omega_h, broadcast. 0 < omega_h < 1. Stability is not looked at: where
    errors of constraints grow, no run has such a motion. Source: the docstring above.
    """
    multiple = float(method.step_multiple)
    a, b = (each[..., np.newaxis] for each in np.broadcast_arrays(alpha_hat, beta_hat))
    b = np.where(b > 0, b, np.nan)  # else no radius is held
    theta = multiple * np.asarray(omega_h)[..., np.newaxis]
    still, driven = (_Circle(method, multiple * a, multiple**2 * b, theta, n) for n in (0.0, harmonic))
    with np.errstate(all="ignore"):
        mean, matrix = still.settled()
        disturbed, by_force = driven.first_order(mean)
        amplitude = solved(disturbed[..., :-1, :-1], -by_force.terms[1][:-1])
        swinging = _Wave([mean, np.concatenate([amplitude, 0 * amplitude[:1]]), 0 * mean])
        found, left = driven.quantities(swinging)
        moment, added = mean[-1], -solved(matrix, left.terms[2])[-1]
        position, velocity = found[POSITION], found[VELOCITY]
        c, multiplier = constraint(position), driven.pull(position, velocity) / dot(position, position)
        ahead = np.exp(1j * harmonic * theta)
        # over a step, with the mean of the multiplier at both of its ends
        work = -np.real((ahead - 1) * c.terms[1] * np.conj((ahead + 1) / 2 * multiplier.terms[1])) / 2
    # the energy is theta^2 / 2; a force of that strength changes the rate by the modulation of it
    strength = modulation * harmonic * theta**2
    rotation, multipliers = -2 * moment / theta**2, 2 * strength**2 * work / theta**3
    varied = -2 * strength**2 * added / theta**2
    parts = (rotation + varied, rotation, multipliers, varied - multipliers)
    return MotionEnergy(*(np.asarray(part)[..., 0] for part in parts))


def steps_to_breakdown(method: Method, alpha_hat: float, beta_hat: float, omega_h: float) -> float:
    """Return after about how many steps of h a uniform rotation of omega h radians a step is infinitely fast.

    Infinite where it is not. A radian adds half of its growth of energy to the rate. With theta = omega h / s the steps
    are the integral of 2 / (omega h growth) over s from 0 to 1, smooth where growth is of first order. To 5 % below
    omega h = 0.1.
    """
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    growth = motion_energy(method, alpha_hat, beta_hat, np.minimum(2 * omega_h / (1 + nodes), FASTEST)).rotation
    # without a solution it is over before it turns so fast
    return np.inf if np.any(growth <= 0) else float(np.nansum(weights / growth)) / omega_h


def solved(matrices: Array, right_sides: Array) -> Array:
    """Return the solutions of linear systems, (size, ..., 1) as the right sides; nan where a matrix is singular."""
    return np.moveaxis(inverses(matrices) @ np.moveaxis(right_sides, 0, -2), -2, 0)


@dataclass(frozen=True)
class _Wave(Series):
    """A quantity: its mean, the amplitude of epsilon Re(w e^(i n theta s)), and what epsilon^2 adds to the mean."""

    def product(self, i: int, terms: Sequence[Any], j: int) -> Any:
        """Return the product of two terms; of two amplitudes in the mean."""
        if i == j == 1:
            return np.real(self.terms[1] * np.conj(terms[1])) / 2
        return super().product(i, terms, j)


class _Circle(CircleStep):
    """A method's step on the circle, where a force rises and falls n times a revolution; with n = 0 it is constant."""

    kind = _Wave

    def __init__(self, method: Method, alpha_hat: Array, beta_hat: Array, theta: Array, harmonic: float) -> None:
        super().__init__(method, alpha_hat, beta_hat, float)
        self.theta, self.harmonic = theta, harmonic

    def later(self, quantity: Series, steps: int) -> Series:
        """Return what a quantity is so many steps later, as it is seen from the frame of now."""
        angle = steps * self.theta
        mean, amplitude, *second = (quantity * np.cos(angle) + across(quantity) * np.sin(angle)).terms
        return _Wave([mean, amplitude * np.exp(1j * self.harmonic * angle), *second])

    def acceleration(self, position: Series, velocity: Series, moment: Series) -> Series:
        """Return the acceleration with the force, epsilon Re e^(i n (theta s + angle)), at the angle of a position."""
        (x, y), (dx, dy) = position.terms[:2]
        force = np.exp(1j * self.harmonic * np.arctan2(y, x))
        turn = (x * dy - y * dx) / (x**2 + y**2)
        of_place = np.real(1j * self.harmonic * force * np.conj(turn)) / 2
        forced = _Wave([a + b for a, b in zip(moment.terms, (0, force, of_place), strict=False)])
        return super().acceleration(position, velocity, forced)

    def settled(self) -> tuple[FloatArray, FloatArray]:
        """Return the unknowns of a uniform rotation, nan where it has none, and the matrix of Newton's method."""
        ones = np.ones_like(self.alpha_hat + self.theta)
        at_rest, by_theta = np.multiply.outer(self.rotation, ones)
        mean = at_rest + self.theta * by_theta
        for _ in range(MOST_ITERATIONS):
            matrix, left = self.first_order(mean)
            change = solved(matrix.real, left.terms[0])
            mean = mean - change
            if not np.any(np.abs(change) > SETTLED):  # nor where there are no numbers
                break
        mean = np.where(np.abs(change).max(axis=0) <= SETTLED, mean, np.nan)
        return mean, self.first_order(mean)[0].real
