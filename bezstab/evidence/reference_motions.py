"""The motion that simulated runs are compared with, and how well it is known."""

from dataclasses import dataclass, field

import numpy as np

from bezstab.errors import NumericalError
from bezstab.mechanism import Scene, compiled_mechanism, simulate
from bezstab.methods import lookup
from bezstab.read_only import ReadOnlyArrays
from bezstab.stability import FloatArray

HALVINGS = 4
"""Of the reference's step at most: each doubles its cost."""

ROUNDED = 4.0
"""RK4's error falls sixteenfold with each halving; where it falls less than this, rounding has taken over."""


@dataclass(frozen=True)
class ReferenceMotion(ReadOnlyArrays):
    """A trajectory without feedback from a consistent start: t (s), q and v (shape (times, n), SI), error of q (SI)."""

    t: FloatArray = field(repr=False)
    q: FloatArray = field(repr=False)
    v: FloatArray = field(repr=False)
    error: float

    def at(self, t: FloatArray) -> FloatArray:
        """Return q at times t (s), shape (t.size, n), by Hermite's cubic between its equal steps.

        Its error is of order four in the step, like RK4's.
        """
        step = self.t[1] - self.t[0]
        k = np.clip((t / step).astype(int), 0, len(self.t) - 2)
        s = ((t - self.t[k]) / step)[:, np.newaxis]
        start, end = self.q[k], self.q[k + 1]
        # The chord from start to end, bent so that the slopes at both ends are v; s runs from 0 to 1.
        bend_at_start = step * self.v[k] - (end - start)
        bend_at_end = (end - start) - step * self.v[k + 1]
        q: FloatArray = (1 - s) * start + s * end + s * (1 - s) * ((1 - s) * bend_at_start + s * bend_at_end)
        return q


def reference_motion(scene: Scene, h: float, duration: float) -> ReferenceMotion:
    """Return the motion from RK4 at half of h (s) and less, until halving no longer changes it but by rounding.

    Feedback does not enter: the exact motion has c = 0. The error is the largest difference to the run at twice the
    step, its interpolation included. InputError for a scene that cannot start, NumericalError if the run fails.
    Duration in s.
    """
    coarse: ReferenceMotion | None = None
    for halving in range(1, HALVINGS + 2):
        run = simulate(compiled_mechanism(scene), lookup("RK4"), h / 2**halving, duration, (0.0, 0.0))
        if run.failure:
            raise NumericalError(f"the reference of {scene.name} fails {run.failure}")
        error = np.inf if coarse is None else float(np.abs(coarse.at(run.t) - run.q).max())
        fine = ReferenceMotion(run.t, run.q, run.v, error)
        if coarse is not None and error > coarse.error / ROUNDED:
            return min(coarse, fine, key=lambda motion: motion.error)
        coarse = fine
    assert coarse
    return coarse
