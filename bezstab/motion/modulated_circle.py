"""The third map: what a method and its feedback do to the energy of a motion, on the modulated circle.

A unit mass is held to the unit circle, c = (q.q - 1) / 2, and goes round at the rate omega, theta = omega h. A weak
conservative force along the circle, the slope of (epsilon / n) sin(n phi), speeds it up and slows it down n times a
revolution. The exact motion keeps its energy: what a run gains or loses is the method's and its feedback's doing.

Seen from a frame that turns with the mass each step is the same. The quantity y of a method's equations at step s is

    y(s) = e^(i theta s) [ u + epsilon Re(w e^(i n theta s)) + epsilon^2 (m + ...) ]

and a constant moment T = T_0 + epsilon^2 T_2 about the centre is added, so that the mean rate of rotation stays: what
energy the run would gain, -T takes away. Inserted into the equations of a step (assignments are linear, evaluations are
the acceleration g of the constrained mass) the powers of epsilon give

    u = L u + g(u, T_0)                      Newton's method, with the angle of x as zero and T_0 as the unknown instead
    (I - L - Dg) w = e^(i n phi) force       one linear solve, each coefficient with a factor z^steps, z = e^(i n theta)
    (I - L - Dg) m = D_T g T_2 + Q           the matrix of Newton's method: Q is the mean of the terms of second order

-T_0 is the torque that stages put on a uniform rotation, -T_2 what else a motion gains: the work that the multiplier
does on the steady error, -lambda dc/dt, and the method's own truncation, which does not depend on the feedback.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bezstab.errors import InputError
from bezstab.methods.scheme_motions import AT_REST, STEADY, exact_motions
from bezstab.methods.schemes import Method
from bezstab.methods.step_equations import Assignment, Combination, Evaluation
from bezstab.read_only import ReadOnlyArrays

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

MODULATION = 0.3
"""Of a motion's rate: by so much a crank's varies that drives rods, to either side of its mean."""

NODES, FASTEST = 8, 0.99
"""Of the integral over a breakdown, and the largest omega h that it asks for."""

IMAGINARY_STEP = 1e-30
"""Of complex steps: its square is far below rounding, so that slopes lose no digits."""

MOST_ITERATIONS = 30
"""Of Newton's method for a rotation that begins within theta^2 of it: four are usual."""

POSITION, VELOCITY = "x", "v"

SETTLED = 1e-15
"""Of the last correction: rounding of numbers of the size of one."""

UNSETTLED = 1e-9
"""Of the last correction, likewise: rounding that bad matrices enlarge stays below, what does not converge is above."""


@dataclass(frozen=True, eq=False, repr=False)
class MotionEnergy(ReadOnlyArrays):
    """What becomes of the energy of a motion, at points of the plane (shape of alpha_hat and beta_hat broadcast).

    rotation: growth of the energy of a uniform rotation, per radian, as a share of it: torque of stages and truncation.
    modulation: what a motion gains beside it, per radian and square of the relative modulation of its rate.
    multiplier: the part of `modulation` that the multiplier's work on the steady error is.
    ripple: complex amplitude of c, per relative modulation of the rate.
    nan where a rotation has no solution.
    """

    rotation: FloatArray
    modulation: FloatArray
    multiplier: FloatArray
    ripple: ComplexArray

    def growth(self, modulation: float = MODULATION) -> FloatArray:
        """Return the growth of energy per radian, as a share of it, of a motion whose rate varies by that share."""
        return self.rotation + self.modulation * modulation**2


def motion_energy(
    method: Method, alpha_hat: ArrayLike, beta_hat: ArrayLike, omega_h: float, harmonic: float = 1.0
) -> MotionEnergy:
    """Return what the method makes of the energy of a motion of omega h radians a step whose rate varies.

    `harmonic`: how often its rate rises and falls in a revolution. InputError unless 0 < omega_h < 1 and harmonic > 0.
    Stability is not looked at: where errors of constraints grow, no run has such a motion. Source: the docstring above.
    """
    if not 0 < omega_h < 1:
        raise InputError(f"omega h = {omega_h:g} rad a step: expected more than 0 and less than 1")
    if not harmonic > 0:
        raise InputError(f"harmonic = {harmonic:g}: expected a number above 0")
    multiple = float(method.step_multiple)
    a, b = np.broadcast_arrays(multiple * np.asarray(alpha_hat, float), multiple**2 * np.asarray(beta_hat, float))
    held = b > 0  # else no radius is
    b = np.where(held, b, 1.0)
    circle = _Circle(method, a[..., np.newaxis], b[..., np.newaxis], multiple * omega_h)
    with np.errstate(all="ignore"):
        found = circle.energy(harmonic)
    return replace(found, **{name: np.where(held, value, np.nan) for name, value in vars(found).items()})


def steps_to_breakdown(method: Method, alpha_hat: float, beta_hat: float, omega_h: float) -> float:
    """Return after about how many steps of h a uniform rotation of omega h radians a step is infinitely fast.

    Infinite where it is not. Each step multiplies the rate by 1 + theta rotation(theta) / 2. With theta = omega h / s
    the steps are the integral of 2 / (omega h rotation) over s from 0 to 1, smooth where rotation is of first order.
    To 5 % below omega h = 0.1. Else errors as `motion_energy`.
    """
    steps = 0.0
    for node, weight in zip(*np.polynomial.legendre.leggauss(NODES), strict=True):
        theta = min(2 * omega_h / (1 + node), FASTEST)
        gained = float(motion_energy(method, alpha_hat, beta_hat, theta).rotation)
        if gained <= 0:
            return np.inf
        if np.isfinite(gained):  # else it is over before it turns so fast
            steps += weight / (omega_h * gained)
    return steps


Vectors = Any
"""Arrays, real or complex, (points, evaluations, 2): points of the plane, the evaluations of a step, two components."""


def dot(p: Vectors, q: Vectors) -> Vectors:
    """Return inner products of vectors."""
    return p[..., 0] * q[..., 0] + p[..., 1] * q[..., 1]


def turned(p: Vectors) -> Vectors:
    """Return vectors a quarter of a revolution on."""
    return np.stack([-p[..., 1], p[..., 0]], axis=-1)


def solved(matrices: Vectors, right_sides: Vectors) -> Vectors:
    """Return the solutions of linear systems, nan where a matrix is singular or has no numbers."""
    singular = ~(np.abs(np.linalg.det(matrices)) > 0)
    regular = np.where(singular[..., np.newaxis, np.newaxis], np.eye(matrices.shape[-1]), matrices)
    found = np.linalg.solve(regular, right_sides[..., np.newaxis])[..., 0]
    return np.where(singular[..., np.newaxis], np.nan, found)


class _Circle:
    """The equations of a method's step on the circle; a and b are its own alpha_hat and beta_hat, (..., 1), h = 1."""

    def __init__(self, method: Method, a: FloatArray, b: FloatArray, theta: float) -> None:
        self.motions = exact_motions(method.scheme.second_order)
        self.equations = method.scheme.second_order.equations
        self.names = [equation.result.name for equation in self.equations]
        self.evaluations = [each for each in self.equations if isinstance(each, Evaluation)]
        self.size = 2 * len(self.names)
        self.found = np.array([self.place(each.result.name) + np.arange(2) for each in self.evaluations])
        self.a, self.b, self.theta = a, b, theta
        self.points = a.shape[:-1]

    def place(self, name: str) -> int:
        """Return where the two components of a quantity begin among the unknowns."""
        return 2 * self.names.index(name)

    # The step's linear part, of quantities that turn with the frame and, between steps, by factors z

    def sum_of(self, combination: Combination, step: int, z: complex) -> ComplexArray:
        """Return the rows of a sum as it is seen from the frame of a step, (2, unknowns)."""
        rows = np.zeros((2, self.size), complex)
        for coefficient, quantity in combination:
            later, place = quantity.step - step, self.place(quantity.name)
            c, s = np.cos(self.theta * later), np.sin(self.theta * later)
            rows[:, place : place + 2] += float(coefficient) * z**later * np.array([[c, -s], [s, c]])
        return rows

    def sums(self, z: complex) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Return L of the assignments, (unknowns, unknowns), and what evaluations see, (evaluations, 2, unknowns)."""
        linear = np.zeros((self.size, self.size), complex)
        for each in self.equations:
            if isinstance(each, Assignment):
                place = self.place(each.result.name)
                linear[place : place + 2] = self.sum_of(each.value, each.result.step, z)
        positions = np.array([self.sum_of(each.position, each.result.step, z) for each in self.evaluations])
        velocities = np.array([self.sum_of(each.velocity, each.result.step, z) for each in self.evaluations])
        return linear, positions, velocities

    # The acceleration of the mass: g = T Jx / x.x - lambda x, with the multiplier that the feedback makes

    def multiplier(self, x: Vectors, v: Vectors) -> Vectors:
        """Return lambda = (v.v + alpha_hat x.v + beta_hat (x.x - 1) / 2) / x.x."""
        return (dot(v, v) + self.a * dot(x, v) + self.b * (dot(x, x) - 1) / 2) / dot(x, x)

    def multiplier_change(self, x: Vectors, v: Vectors, dx: Vectors, dv: Vectors) -> Vectors:
        """Return the derivative of lambda along (dx, dv), which may be complex amplitudes."""
        numerator = 2 * dot(v, dv) + self.a * (dot(dx, v) + dot(x, dv)) + self.b * dot(x, dx)
        return (numerator - 2 * self.multiplier(x, v) * dot(x, dx)) / dot(x, x)

    def acceleration(self, x: Vectors, v: Vectors, moment: Vectors) -> Vectors:
        """Return accelerations at positions and velocities of the evaluations, with a moment about the centre."""
        along, across = moment / dot(x, x), self.multiplier(x, v)
        return along[..., np.newaxis] * turned(x) - across[..., np.newaxis] * x

    def second_derivative(self, x: Vectors, v: Vectors, moment: Vectors, dx: Vectors, dv: Vectors) -> Vectors:
        """Return d^2/dt^2 of the acceleration at (x + t dx, v + t dv)."""
        r, r1, r2 = dot(x, x), 2 * dot(x, dx), 2 * dot(dx, dx)
        n2 = 2 * dot(dv, dv) + 2 * self.a * dot(dx, dv) + self.b * r2 / 2
        across, across1, along = self.multiplier(x, v), self.multiplier_change(x, v, dx, dv), moment / r
        along1 = -along * r1 / r
        across2, along2 = (n2 - 2 * across1 * r1 - across * r2) / r, -(2 * along1 * r1 + along * r2) / r
        return (
            along2[..., np.newaxis] * turned(x)
            + 2 * along1[..., np.newaxis] * turned(dx)
            - across2[..., np.newaxis] * x
            - 2 * across1[..., np.newaxis] * dx
        )

    def matrix(self, sums: tuple[Vectors, Vectors, Vectors], x: Vectors, v: Vectors, moment: Vectors) -> Vectors:
        """Return I - L - Dg at the evaluations' positions and velocities, (..., unknowns, unknowns)."""
        linear, positions, velocities = sums
        rows = np.zeros((*self.points, *linear.shape), linear.dtype) + np.eye(self.size) - linear
        for axis in range(2):
            change = 1j * IMAGINARY_STEP * np.eye(2)[axis]
            by_x = self.acceleration(x + change, v, moment).imag / IMAGINARY_STEP
            by_v = self.acceleration(x, v + change, moment).imag / IMAGINARY_STEP
            for number, found in enumerate(self.found):
                rows[..., found, :] -= by_x[..., number, :, np.newaxis] * positions[number, axis]
                rows[..., found, :] -= by_v[..., number, :, np.newaxis] * velocities[number, axis]
        return rows

    # Orders nought, one and two in epsilon

    def energy(self, harmonic: float) -> MotionEnergy:
        """Return what becomes of the energy of a motion whose rate rises and falls so often in a revolution."""
        linear, positions, velocities = (part.real for part in self.sums(1))
        u, moment, bordered = self.rotation((linear, positions, velocities))
        x, v = (np.einsum("eij,...j->...ei", part, u) for part in (positions, velocities))
        across, rr = turned(x), dot(x, x)[..., np.newaxis]

        z = np.exp(1j * harmonic * self.theta)
        phase = np.exp(1j * harmonic * np.arctan2(x[..., 1], x[..., 0]))[..., np.newaxis]
        moving = self.sums(z)
        forced = np.zeros((*self.points, self.size), complex)
        forced[..., self.found] = phase * across / rr
        w = solved(self.matrix(moving, x, v, moment), forced)
        dx, dv = (np.einsum("eij,...j->...ei", part, w) for part in moving[1:])

        # the means of terms of second order: of g itself, and of the force at the place that is moved
        of_g = sum(self.second_derivative(x, v, moment, *parts) for parts in ((dx.real, dv.real), (dx.imag, dv.imag)))
        back = np.conj(dx)
        angle, radius = (dot(side, back)[..., np.newaxis] / rr for side in (across, x))
        of_force = phase * ((1j * harmonic * angle - 2 * radius) * across + turned(back)) / rr
        second = np.zeros((*self.points, self.size + 1))
        second[..., self.found] = of_g / 4 + of_force.real / 2
        added = solved(bordered, second)[..., -1]

        # the force changes the rate by epsilon / (n theta^2) of it; the energy is theta^2 / 2
        of_modulation = harmonic * self.theta**2
        scale = 2 * of_modulation**2 / self.theta**2
        places = [self.place(name) for name in (POSITION, VELOCITY)]
        ux, uv, wx, wv = (part[..., np.newaxis, place : place + 2] for part in (u, w) for place in places)
        ripple = dot(ux, wx)
        on_the_way = (1 + z) / 2 * self.multiplier_change(ux, uv, wx, wv)  # the mean of the step's two ends
        work = -np.real(on_the_way * np.conj((z - 1) * ripple)) / 2
        return MotionEnergy(
            rotation=-2 * moment[..., 0] / self.theta**2,
            modulation=np.asarray(-scale * added, np.float64),
            multiplier=scale * work[..., 0] / self.theta,
            ripple=np.asarray(of_modulation * ripple[..., 0], complex),
        )

    def rotation(self, sums: tuple[Vectors, Vectors, Vectors]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return u (..., unknowns), T_0 (..., 1), and Newton's matrix, bordered by T and by the angle of x: 0."""
        theta, (linear, positions, velocities) = self.theta, sums
        u = np.zeros((*self.points, self.size))
        for name, at_zero in ((name, powers[0]) for name, powers in self.motions.items()):
            u[..., self.place(name) + np.arange(2)] = float(at_zero[AT_REST]), theta * float(at_zero[STEADY])
        moment, angle = np.zeros((*self.points, 1)), self.place(POSITION) + 1
        for _ in range(MOST_ITERATIONS):
            x, v = (np.einsum("eij,...j->...ei", part, u) for part in (positions, velocities))
            missing = np.concatenate([u - u @ linear.T, u[..., [angle]]], axis=-1)
            missing[..., self.found] -= self.acceleration(x, v, moment)
            bordered = np.zeros((*self.points, self.size + 1, self.size + 1))
            bordered[..., :-1, :-1] = self.matrix(sums, x, v, moment)
            bordered[..., self.found, -1] = -turned(x) / dot(x, x)[..., np.newaxis]
            bordered[..., -1, angle] = 1.0
            change = solved(bordered, missing)
            u, moment = u - change[..., :-1], moment - change[..., -1:]
            if not np.any(np.abs(change) > SETTLED):  # nor where there are no numbers
                break
        unsettled = ~(np.abs(change).max(axis=-1) <= UNSETTLED)
        u[unsettled], moment[unsettled] = np.nan, np.nan
        return u, moment, bordered
