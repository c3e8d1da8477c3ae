"""Whether predictions hold: poles and errors as they are predicted, against those that are measured in runs.

scene, methods, a step, a point or none   →   VerifyQuestion   →   measured poles, or errors at shares of the gains
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from bezstab.evidence import HalvedStep, Measurement, halved_steps, measure_poles, random_points
from bezstab.mechanism import Driver, Mechanism, Scene, compiled_mechanism, revolution_period
from bezstab.methods import Method
from bezstab.questions.motions import scene_at_speed
from bezstab.questions.points import Meant, meant_in_seconds
from bezstab.stability import choose
from bezstab.units import check_step

RANDOM_POINTS = 20


@dataclass(frozen=True, kw_only=True)
class VerifyQuestion:
    """Do runs of a scene, with steps of `h` (s), agree with what is predicted of their constraint errors?

    The scene moves `speed` times as fast as given there. The `point` is one (alpha_hat, beta_hat), or two arrays of
    one shape; without it `points` random ones are taken, RANDOM_POINTS unless told. With `floquet` the exact prediction
    for a moving mechanism is asked about as well. InputError for a step that is not positive.
    """

    scene: str | Scene
    methods: Sequence[Method]
    h: float | Fraction
    speed: Fraction = Fraction(1)
    point: Sequence[ArrayLike | Fraction] | None = None
    points: int | None = None
    floquet: bool = False

    def __post_init__(self) -> None:
        check_step(self.h)

    @property
    def meant_in_seconds(self) -> Meant | None:
        """Whether the point looks like alpha and beta in 1/s; None where there is not one exact point."""
        if self.point is None:
            return None
        exact = [each for each in self.point if isinstance(each, Fraction)]
        return meant_in_seconds(self.methods, (exact[0], exact[1]), self.h) if len(exact) == 2 else None

    @cached_property
    def mechanism(self) -> Mechanism:
        """The mechanism that runs; errors as `load_scene`."""
        return compiled_mechanism(scene_at_speed(self.scene, self.speed))

    @property
    def no_period(self) -> str:
        """Why the drivers of the mechanism do not begin anew, in words; nothing where they do."""
        if not any(isinstance(joint, Driver) for joint in self.mechanism.scene.joints):
            return "nothing drives it"
        return "its drivers have no common period" if revolution_period(self.mechanism) is None else ""

    def measurements(self, method: Method, bar: Callable[[Iterable[int]], Iterable[int]] = iter) -> list[Measurement]:
        """Return predicted and measured poles at the point, else at the random ones; `bar` shows the progress."""
        if self.point is None:
            alpha_hat, beta_hat = random_points(method, self.points or RANDOM_POINTS)
        else:
            alpha_hat, beta_hat = (np.asarray(each, float).ravel() for each in self.point)
        return measure_poles(self.mechanism, method, float(self.h), alpha_hat, beta_hat, bar, self.floquet)

    def forced_errors(self, method: Method) -> Iterator[HalvedStep]:
        """Yield predicted and measured errors at shares of the gains of the point, else of the goal robust."""
        if self.point is None:
            chosen = choose(method, "robust", margins=False)
            at = chosen.alpha_hat, chosen.beta_hat
        else:
            alpha_hat, beta_hat = (float(np.asarray(each, float)) for each in self.point)
            at = alpha_hat, beta_hat
        return halved_steps(self.mechanism, method, float(self.h), at, self.mechanism.scene.duration)
