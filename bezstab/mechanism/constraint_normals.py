r"""How fast the directions of the constraints turn along a motion: K = Cdot_q G, in the metric of the masses.

A constraint's direction in coordinate space is its row of C_q. Along a motion it turns, and what the feedback has put
right in the old directions is off in the new ones:

        rows of C_q at t        rows of C_q at t + h
              |                      /
              |                     /       G = M^-1 C_q^T S^-1 leads from constraint errors w to the displacement
              |                    /        dq = G w that the constraint forces make; C_q(t + h) G(t) = 1 + h K
        ------+------         ----/-----

K is m x m, in 1/s. The roots mu and poles z of the feedback move by it to first order (`stability.turning`).
"""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bezstab.mechanism.compiled import IMAGINARY_STEP, Mechanism
from bezstab.mechanism.motions import STEPS, Motion, motion
from bezstab.mechanism.start import geometry

FloatArray = NDArray[np.float64]

SAMPLES = 400  # over a run, or a turn of the fastest driver, an even number: K turns a few times in one, so its
# integrals are good to 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class TurningNormals:
    """K at equal steps along a motion that lasts `duration` (s): `rates` has shape (samples + 1, m, m), in 1/s.

    `closed`: the motion is a revolution that begins anew. `metric` has S = C_q M^-1 C_q^T at both ends, shape
    (2, m, m): a constraint error w has the size w^T S^-1 w, that of the displacement it stands for.
    """

    duration: float
    rates: FloatArray
    metric: FloatArray
    closed: bool

    @property
    def kappa(self) -> float:
        """The largest modulus of an eigenvalue of K along the motion (1/s)."""
        return float(np.abs(np.linalg.eigvals(self.rates)).max())

    @cached_property
    def largest_norm(self) -> float:
        """A bound on every rate that Y' = chi K(t) Y can grow at, for |chi| = 1 (1/s).

        The largest spectral norm of K, each constraint's error in units of its own size at the start.
        """
        size = np.sqrt(np.diag(self.metric[0]))
        scaled = self.rates / size[:, np.newaxis] * size
        return float(np.linalg.norm(scaled, ord=2, axis=(1, 2)).max())

    def __repr__(self) -> str:
        motion = "revolution" if self.closed else "run"
        return f"TurningNormals(kappa = {self.kappa:.6g} 1/s over a {motion} of {self.duration:.6g} s)"


@cache
def turning_normals(mechanism: Mechanism, duration: float) -> TurningNormals:
    """Return how the constraints turn: over one revolution where the drivers begin anew, else over `duration`.

    duration in s. InputError and NumericalError as for the `motion` they turn along.
    """
    along = motion(mechanism, duration)
    every = STEPS // SAMPLES
    rates, metrics = [], []
    for t, q, v in zip(along.t[::every], along.q[::every], along.v[::every], strict=True):
        rate, metric = _rate(mechanism, float(t), q, v)
        rates.append(rate)
        metrics.append(metric)
    return TurningNormals(
        duration=along.duration,
        rates=np.stack(rates),
        metric=np.stack([metrics[0], metrics[-1]]),
        closed=along.closed,
    )


def _rate(mechanism: Mechanism, t: float, q: FloatArray, v: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return K and S at one moment."""
    jacobian, turning = _jacobian_and_turning(mechanism, t, q, v)
    by_forces = jacobian.T / np.array(mechanism.equations.mass, float)[:, np.newaxis]  # M^-1 C_q^T
    metric = jacobian @ by_forces
    return np.linalg.solve(metric, (turning @ by_forces).T).T, metric  # S is symmetric


def _jacobian_and_turning(
    mechanism: Mechanism, t: float, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return C_q and Cdot_q at one moment, the latter by a complex step along the motion."""
    at = geometry(mechanism)
    ahead: Any = at.jacobian(q + 1j * IMAGINARY_STEP * v, t + 1j * IMAGINARY_STEP)  # type: ignore[arg-type]
    return np.asarray(at.jacobian(q, t), float), np.asarray(ahead.imag / IMAGINARY_STEP, float)


def turned_across(mechanism: Mechanism, along: Motion, vectors: FloatArray) -> FloatArray:
    """Return Cdot_q times the part of a vector that lies along the constraints, at each of the first times of a motion.

    That part is what C_q does not see, in the metric of the masses; shapes (times, n) and (times, m).
    """
    across = []
    for t, q, v, vector in zip(along.t, along.q, along.v, vectors, strict=False):
        jacobian, turning = _jacobian_and_turning(mechanism, float(t), q, v)
        by_forces = jacobian.T / np.array(mechanism.equations.mass, float)[:, np.newaxis]  # M^-1 C_q^T
        normal = by_forces @ np.linalg.solve(jacobian @ by_forces, jacobian @ vector)
        across.append(turning @ (vector - normal))
    return np.stack(across)
