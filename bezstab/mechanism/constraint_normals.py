r"""What a mechanism's own motion does to its constraints: how it accelerates them, and turns their directions.

Along the motion q(t) a method forces errors in proportion to derivatives of q, of which the constraints see what lies
along their normals: C_q q^(k). The first that is not zero is C_q qddot = gamma, since C_q qdot only balances drivers.

    amplitude    max |C_q qddot| / omega^2          as if every constraint moved as cos(omega t)
    omega        rms of C_q q''' / rms of C_q qddot

A constraint's direction in coordinate space is its row of C_q. Along a motion it turns, and what the feedback has put
right in the old directions is off in the new ones:

        rows of C_q at t        rows of C_q at t + h
              |                      /
              |                     /       G = M^-1 C_q^T S^-1 leads from constraint errors w to the displacement
              |                    /        dq = G w that the constraint forces make; C_q(t + h) G(t) = 1 + h K
        ------+------         ----/-----

K = Cdot_q G is m x m, in 1/s, in the metric of the masses. The roots mu and poles z of the feedback move by it to first
order (`stability.turning`).
"""

from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.mechanism.equations import Mechanism
from bezstab.mechanism.generated_code import IMAGINARY_STEP
from bezstab.mechanism.motions import STEPS, Motion, motion
from bezstab.mechanism.start import constraint_jacobian

FloatArray = NDArray[np.float64]

SAMPLES = 400  # over a run, or a turn of the fastest driver: K turns a few times in one, so kappa is good to 1e-4

AT_REST = 1e-9
"""Of an acceleration (SI), or of its relative change in a run: below, it is what rounding leaves of none."""


@dataclass(frozen=True)
class ConstraintMotion:
    """omega: the motion's own rate as the constraints see it (1/s); amplitude: of their motion (m or rad)."""

    omega: float
    amplitude: float


@cache
def constraint_motion(mechanism: Mechanism, duration: float) -> ConstraintMotion:
    """Return rate and amplitude of the motion: over a revolution of steady drivers, else over `duration` (s).

    InputError for a mechanism whose constraints do not accelerate, or evenly, as those of a body that spins about a
    pin: they have no rate. Else errors as `motion`.
    """
    along = motion(mechanism, duration)
    derivatives = np.stack([along.a, np.gradient(along.a, along.t, axis=0, edge_order=2)], axis=-1)
    accelerations, changing = np.moveaxis(along_normals(mechanism, along, derivatives), -1, 0)
    largest = float(np.abs(accelerations).max())
    if largest < AT_REST:
        raise InputError(f"{mechanism.scene.name} is at rest: its constraints do not move, so there is no omega")
    omega = float(np.sqrt((changing**2).mean() / (accelerations**2).mean()))
    if omega * duration < AT_REST:
        raise InputError(f"{mechanism.scene.name} turns evenly: the accelerations of its constraints show no omega")
    return ConstraintMotion(omega=omega, amplitude=largest / omega**2)


def along_normals(mechanism: Mechanism, along: Motion, vectors: FloatArray) -> FloatArray:
    """Return C_q times vectors at each of the first times of a motion; shapes (times, n, ...) and (times, m, ...)."""
    states = zip(along.t, along.q, vectors, strict=False)
    return np.stack([constraint_jacobian(mechanism, t, q) @ vector for t, q, vector in states])


@dataclass(frozen=True, eq=False, repr=False)
class TurningNormals:
    """K at equal steps along a motion: `rates` has shape (samples + 1, m, m), in 1/s.

    `closed`: the motion is a revolution that begins anew.
    """

    rates: FloatArray
    closed: bool

    @cached_property
    def kappa(self) -> float:
        """The largest modulus of an eigenvalue of K along the motion (1/s)."""
        return float(np.abs(np.linalg.eigvals(self.rates)).max())


@cache
def turning_normals(mechanism: Mechanism, duration: float) -> TurningNormals:
    """Return how the constraints turn: over one revolution where the drivers begin anew, else over `duration`.

    duration in s. InputError and NumericalError as for the `motion` they turn along.
    """
    along = motion(mechanism, duration)
    every = STEPS // SAMPLES
    rates = []
    for t, q, v in zip(along.t[::every], along.q[::every], along.v[::every], strict=True):
        jacobian, turning, by_forces = _directions(mechanism, float(t), q, v)
        rates.append(np.linalg.solve(jacobian @ by_forces, (turning @ by_forces).T).T)  # S is symmetric
    return TurningNormals(np.stack(rates), along.closed)


def _directions(
    mechanism: Mechanism, t: float, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return C_q, Cdot_q and M^-1 C_q^T at one moment, the second by a complex step along the motion."""
    jacobian = constraint_jacobian(mechanism, t, q)
    ahead = constraint_jacobian(mechanism, t + 1j * IMAGINARY_STEP, q + 1j * IMAGINARY_STEP * v)
    return jacobian, ahead.imag / IMAGINARY_STEP, jacobian.T / mechanism.mass[:, np.newaxis]


def turned_across(mechanism: Mechanism, along: Motion, vectors: FloatArray) -> FloatArray:
    """Return Cdot_q times the part of a vector that lies along the constraints, at each of the first times of a motion.

    That part is what C_q does not see, in the metric of the masses; shapes (times, n) and (times, m).
    """
    across = []
    for t, q, v, vector in zip(along.t, along.q, along.v, vectors, strict=False):
        jacobian, turning, by_forces = _directions(mechanism, float(t), q, v)
        normal = by_forces @ np.linalg.solve(jacobian @ by_forces, jacobian @ vector)
        across.append(turning @ (vector - normal))
    return np.stack(across)
