"""Whether predictions hold: poles and errors as they are predicted, against those that are measured in runs.

scene, methods, a step, a point or none   →   VerifyQuestion   →   measured poles, or errors at shares of the gains
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from bezstab.engines import Point
from bezstab.evidence import HalvedStep, Measurement, halved_steps, measure_poles, random_points
from bezstab.methods import Method
from bezstab.questions.motions import SceneQuestion
from bezstab.stability import choose

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

    def forced_errors(self, method: Method) -> Iterator[HalvedStep]:
        """Yield predicted and measured errors at shares of the gains of the point, else of the goal robust."""
        if self.point:
            alpha_hat, beta_hat = map(float, self.point)
        else:
            chosen = choose(method, "robust", margins=False)
            alpha_hat, beta_hat = chosen.alpha_hat, chosen.beta_hat
        duration = self.mechanism.scene.duration
        return halved_steps(self.mechanism, method, float(self.h), (alpha_hat, beta_hat), duration)
