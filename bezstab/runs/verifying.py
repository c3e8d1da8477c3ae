"""Whether predictions hold: poles as they are predicted, against those that are measured in runs.

scene, methods, a step, a point or none   →   VerifyQuestion   →   measured poles
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bezstab.engines.conversions import Point
from bezstab.methods.schemes import Method
from bezstab.questions.motions import SceneQuestion
from bezstab.runs.measured_poles import Measurement, measure_poles, random_points

RANDOM_POINTS = 20


@dataclass(frozen=True, kw_only=True)
class VerifyQuestion(SceneQuestion):
    """Do runs of a scene, with steps of `h` (s), agree with what is predicted of their constraint errors?

    Without a `point` (alpha_hat, beta_hat) so many random `points` are taken, RANDOM_POINTS unless told. With `floquet`
    the exact prediction for a moving mechanism is asked about as well.
    """

    methods: Sequence[Method]
    h: Fraction
    point: Point | None = None
    points: int | None = None
    floquet: bool = False

    def measurements(self, method: Method) -> list[Measurement]:
        """Return predicted and measured poles at the point, else at the random ones."""
        if self.point is None:
            alpha_hat, beta_hat = random_points(method, self.points or RANDOM_POINTS)
        else:
            alpha_hat, beta_hat = (np.array([float(each)]) for each in self.point)
        return measure_poles(self.mechanism, method, float(self.h), alpha_hat, beta_hat, self.floquet)
