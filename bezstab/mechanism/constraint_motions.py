"""How a mechanism's own motion drives its constraints: accelerations along their normals, their rate and amplitude.

Along the motion q(t) a method forces errors in proportion to derivatives of q, of which the constraints see what lies
along their normals: C_q q^(k). The first that is not zero is C_q qddot = gamma, since C_q qdot only balances drivers.

    amplitude    max |C_q qddot| / omega^2          as if every constraint moved as cos(omega t)
    omega        rms of C_q q''' / rms of C_q qddot
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from bezstab.errors import InputError
from bezstab.mechanism.compiled import Mechanism
from bezstab.mechanism.motions import Motion, motion
from bezstab.mechanism.start import geometry

FloatArray = NDArray[np.float64]

AT_REST = 1e-9
"""Of an acceleration (SI): below, it is what rounding leaves of a mechanism that does not move."""


@dataclass(frozen=True)
class ConstraintMotion:
    """omega: the motion's own rate as the constraints see it (1/s); amplitude: of their motion (m or rad)."""

    omega: float
    amplitude: float


@cache
def constraint_motion(mechanism: Mechanism, duration: float) -> ConstraintMotion:
    """Return rate and amplitude of the motion: over a revolution of steady drivers, else over `duration` (s).

    InputError for a mechanism whose constraints do not accelerate: it has no rate. Else errors as `motion`.
    """
    along = motion(mechanism, duration)
    accelerations = along_normals(mechanism, along, along.a)
    largest = float(np.abs(accelerations).max())
    if largest < AT_REST:
        raise InputError(f"{mechanism.scene.name} is at rest: its constraints do not move, so there is no omega")
    changing = along_normals(mechanism, along, np.gradient(along.a, along.t, axis=0, edge_order=2))
    omega = float(np.sqrt((changing**2).mean() / (accelerations**2).mean()))
    return ConstraintMotion(omega=omega, amplitude=largest / omega**2)


def along_normals(mechanism: Mechanism, along: Motion, vectors: FloatArray) -> FloatArray:
    """Return C_q times a vector at each of the first times of a motion; shapes (times, n) and (times, m)."""
    jacobian = geometry(mechanism).jacobian
    states = zip(along.q, along.t, vectors, strict=False)
    return np.stack([np.asarray(jacobian(q, t), float) @ vector for q, t, vector in states])
