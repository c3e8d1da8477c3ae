"""The motion that simulated runs are compared with, and how well it is known."""

from dataclasses import dataclass, field

import numpy as np

from bezstab.mechanism import Motion, Scene, compiled_mechanism, motion_over

HALVINGS = 4
"""Of the reference's step at most: each doubles its cost."""

ROUNDED = 4.0
"""RK4's error falls sixteenfold with each halving; where it falls less than this, rounding has taken over."""


@dataclass(frozen=True)
class ReferenceMotion:
    """A motion without feedback from a consistent start, and how far its coordinates may be off (SI)."""

    along: Motion = field(repr=False)
    error: float


def reference_motion(scene: Scene, h: float, duration: float) -> ReferenceMotion:
    """Return the motion from RK4 at half of h (s) and less, until halving no longer changes it but by rounding.

    Feedback does not enter: the exact motion has c = 0. The error is the largest difference to the run at twice the
    step, its interpolation included. InputError for a scene that cannot start, NumericalError if the run fails.
    Duration in s.
    """
    best: ReferenceMotion | None = None
    for halving in range(1, HALVINGS + 2):
        along = motion_over(compiled_mechanism(scene), duration, round(duration / h * 2**halving))
        error = np.inf if best is None else float(np.abs(best.along.at(along.t)[0] - along.q).max())
        fine = ReferenceMotion(along, error)
        if best is not None and error > best.error / ROUNDED:
            return min(best, fine, key=lambda motion: motion.error)
        best = fine
    assert best
    return best
