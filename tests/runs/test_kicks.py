"""What becomes of the error that a kick has made: told from made-up responses."""

import numpy as np
import pytest

from bezstab.mechanism.equations import compiled_mechanism
from bezstab.mechanism.scene_files import load_scene
from bezstab.methods.registry import lookup
from bezstab.runs.kicks import fates, thrown_apart
from bezstab.stability.arrays import FloatArray

KICK, RUN = 1e-8, 2000
STEPS: FloatArray = np.arange(RUN + 1.0)
STILL: FloatArray = np.zeros(RUN + 1)


def geometric(ratio: float) -> FloatArray:
    return np.asarray(ratio**STEPS, float)


def fate(error: FloatArray, drift: FloatArray) -> str:
    """Return what is said of a mechanism whose first coordinate is the error and whose second drifts."""
    moved = np.hypot(error, drift) / np.hypot(error[0], drift[0])
    sizes, errors, distances = (each[:, np.newaxis] for each in (KICK * error, error, moved))
    (diverges,), (undecided,) = fates(sizes, errors, distances, np.array([False]))
    assert not (diverges and undecided)
    return "none" if undecided else "diverges" if diverges else "converges"


APART, SLOWLY_APART = 0.1 * STEPS, 0.01 * STEPS
"""How the motions of two runs drift apart, for good."""


@pytest.mark.parametrize(
    ("error", "drift", "verdict"),
    [
        # it dies whatever the motions do afterwards: late differences are 1e5 times those after a hundred steps
        (geometric(0.9) + (1e-3 * APART) ** 2, APART, "converges"),
        (geometric(0.99), APART, "converges"),
        (geometric(1.005), SLOWLY_APART, "diverges"),  # tenfold
        (geometric(1.2), STILL, "diverges"),  # out of the linear range in 60 steps
        # of a double pole at 0.97, as symplectic Euler's near (0, 4): it rises elevenfold before it dies
        ((1 + STEPS) * geometric(0.97), STILL, "converges"),
        (geometric(0.9) + 1e-6 * geometric(1.01), STILL, "none"),  # of a growing mode that the kick hardly excites
        (np.maximum(geometric(0.999), 10 * STEPS), 1e4 * STEPS, "none"),  # a difference of motions, no error's growth
        (geometric(1.01), 1e3 * (geometric(1.01) - 1), "none"),  # the same, out of the linear range
        (geometric(0.9) + 1e6 * (STEPS == 50), STILL, "none"),  # out of the linear range, and back
        # what lives to the end is judged by its halves
        (geometric(0.9985), STILL, "converges"),
        (geometric(1.0005), STILL, "diverges"),
        (geometric(1.0005), STEPS, "none"),  # of the motion as likely
    ],
)
def test_an_error_that_dies_has_converged_and_one_that_grows_tenfold_diverged(
    error: FloatArray, drift: FloatArray, verdict: str
) -> None:
    assert fate(error, drift) == verdict


def test_a_mechanism_that_breaks_down_gives_no_verdict_unless_feedback_throws_it_apart() -> None:
    """An error of 2 m at once is the feedback's doing if without feedback nothing happens; 2 mm may be forced."""
    slow, fast = (compiled_mechanism(load_scene(scene)) for scene in ("slider_crank", "slider_crank_300rpm"))
    sizes = np.tile([2e-3, 2.0, np.nan], (100, 1))
    assert thrown_apart(slow, lookup("B4"), 1e-3, sizes).tolist() == [False, True, True]
    # in steps of a tenth of a revolution something happens without feedback, too
    assert not thrown_apart(fast, lookup("B4"), 0.02, sizes).any()
